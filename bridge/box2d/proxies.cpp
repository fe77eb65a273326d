// Edges are edited in place and synchronised by SetTransform. Creating fixtures anew costs many times more and would
// end and begin every contact in each frame. The number of edges of an outline only grows; spare edges have zero
// length.

#include "bridge/box2d/include/supercircle/box2d_proxies.hpp"

#include "bridge/box2d/units.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <cmath>

namespace supercircle::bridge {

namespace {

constexpr double kFarthest = 1e7; ///< Box2D units, as in the port: floats are too coarse beyond it

bool fits(const std::vector<Point>& points, double scale) {
    return std::all_of(points.begin(), points.end(), [&](const Point& p) {
        return std::abs(p.x * scale) < kFarthest && std::abs(p.y * scale) < kFarthest; // false for NaN too
    });
}

void addEdges(b2Body& body, std::size_t count, std::uint16_t category, std::uint16_t mask) {
    b2EdgeShape edge;
    edge.SetTwoSided({0.0F, 0.0F}, {0.0F, 0.0F});
    b2FixtureDef def;
    def.shape = &edge;
    def.isSensor = true;
    def.filter.categoryBits = category;
    def.filter.maskBits = mask;
    for (std::size_t i = 0; i < count; ++i)
        body.CreateFixture(&def);
}

/// Places the body's edges along the closed line.
void layEdges(b2Body& body, const std::vector<Point>& points, double scale) {
    std::size_t i = 0;
    for (b2Fixture* f = body.GetFixtureList(); f != nullptr; f = f->GetNext(), ++i) {
        const std::size_t a = std::min(i, points.size()) % points.size();
        const std::size_t b = std::min(i + 1, points.size()) % points.size();
        static_cast<b2EdgeShape*>(f->GetShape())->SetTwoSided(toHost(points[a], scale), toHost(points[b], scale));
    }
    body.SetTransform({0.0F, 0.0F}, 0.0F); // updates the broad phase
}

std::size_t fixtures(const b2Body& body) {
    std::size_t n = 0;
    for (const b2Fixture* f = body.GetFixtureList(); f != nullptr; f = f->GetNext())
        ++n;
    return n;
}

} // namespace

ShellProxies::ShellProxies(b2World& world, double units_per_metre)
    : world_(&world), scale_(std::isfinite(units_per_metre) && units_per_metre > 0.0 ? units_per_metre : 1.0) {}

ShellProxies::~ShellProxies() {
    release();
}

DrawOptions ShellProxies::options() {
    DrawOptions o;
    o.centre_lines = o.contacts = o.forces = o.holds = o.strain = false;
    o.outlines = true;
    return o;
}

void ShellProxies::begin() {
    outlines_.clear();
}

bool ShellProxies::end() {
    if (world_->IsLocked())
        return false;
    while (bodies_.size() > outlines_.size()) {
        world_->DestroyBody(bodies_.back());
        bodies_.pop_back();
    }
    for (std::size_t k = 0; k < outlines_.size(); ++k) {
        if (k == bodies_.size()) {
            b2BodyDef def;
            def.type = b2_kinematicBody;
            def.allowSleep = false; // a sleeping pair would not update its contact
            bodies_.push_back(world_->CreateBody(&def));
        }
        if (outlines_[k].size() < 2 || !fits(outlines_[k], scale_))
            continue; // keeps its last position
        if (const std::size_t have = fixtures(*bodies_[k]); have < outlines_[k].size())
            addEdges(*bodies_[k], outlines_[k].size() - have, category, mask);
        layEdges(*bodies_[k], outlines_[k], scale_);
    }
    return true;
}

std::size_t ShellProxies::outline_of(const b2Fixture& fixture) const {
    const auto found = std::find(bodies_.begin(), bodies_.end(), fixture.GetBody());
    return found == bodies_.end() ? kNone : static_cast<std::size_t>(found - bodies_.begin());
}

void ShellProxies::release() {
    if (bodies_.empty() || world_->IsLocked()) // with no bodies the world may be gone
        return;
    for (b2Body* b : bodies_)
        world_->DestroyBody(b);
    bodies_.clear();
}

void ShellProxies::polyline(std::span<const Point>, const Colour&) {}

void ShellProxies::outline(std::span<const Point> points, const Colour&) {
    outlines_.emplace_back(points.begin(), points.end());
}

void ShellProxies::mark(const Point&, const Colour&) {}

} // namespace supercircle::bridge
