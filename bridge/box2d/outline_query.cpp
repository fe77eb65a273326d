#include "bridge/box2d/outline_query.h"

#include "bridge/box2d/outlines.h"

#include <algorithm>
#include <cmath>

namespace supercircle::bridge {

namespace {

void appendSolids(b2Body& body, std::vector<Piece>& pieces) {
    for (const b2Fixture* f = body.GetFixtureList(); f != nullptr; f = f->GetNext())
        for (int32 child = 0; isSolid(*f) && child < f->GetShape()->GetChildCount(); ++child)
            pieces.push_back({&body, f, child});
}

b2AABB boxOf(const Piece& p) {
    b2AABB box;
    p.fixture->GetShape()->ComputeAABB(&box, p.body->GetTransform(), p.child);
    return box;
}

/// Box2D's tree loses pieces below a box that is not finite.
bool treeIsSound(const b2World& world) {
    for (const b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
        if (!b->GetPosition().IsValid() || !std::isfinite(b->GetAngle()))
            return false;
    return true;
}

bool meetsOne(const b2AABB& piece, std::span<const b2AABB> boxes) {
    return std::any_of(boxes.begin(), boxes.end(), [&](const b2AABB& box) { return b2TestOverlap(piece, box); });
}

} // namespace

b2AABB sweptBox(const Piece& p, const Motion& motion) {
    b2AABB box = boxOf(p);
    const float swing =
        std::abs(motion.turn) * (b2Abs(box.GetCenter() - p.body->GetWorldCenter()) + box.GetExtents()).Length();
    box.lowerBound += b2Min(motion.way, b2Vec2_zero) - b2Vec2(swing, swing);
    box.upperBound += b2Max(motion.way, b2Vec2_zero) + b2Vec2(swing, swing);
    return box;
}

Motion foreseenMotion(const b2Body& body, float ahead, const b2Vec2& gravity) {
    Motion m;
    if (!body.IsAwake())
        return m;
    const b2Vec2 fall = body.GetType() == b2_dynamicBody ? body.GetGravityScale() * gravity : b2Vec2_zero;
    m.way = ahead * (body.GetLinearVelocity() + ahead * fall);
    if (const float length = m.way.Length(); length > b2_maxTranslation)
        m.way *= b2_maxTranslation / length;
    m.turn = std::clamp(ahead * body.GetAngularVelocity(), -b2_maxRotation, b2_maxRotation);
    return m;
}

std::uint32_t Piece::key() const {
    std::uint32_t older = 0;
    for (const b2Fixture* f = fixture->GetNext(); f != nullptr; f = f->GetNext()) // newest first
        older += static_cast<std::uint32_t>(f->GetShape()->GetChildCount());
    return older + static_cast<std::uint32_t>(child);
}

bool OutlineQuery::QueryCallback(int32 proxyId) {
    auto* proxy = static_cast<b2FixtureProxy*>(broadPhase_->GetUserData(proxyId));
    const Piece piece{proxy->fixture->GetBody(), proxy->fixture, proxy->childIndex};
    if (isSolid(*piece.fixture) && b2TestOverlap(boxOf(piece), box_)) // the tree's own boxes are fattened
        found_.push_back(piece);
    return true;
}

const std::vector<Piece>& OutlineQuery::now(b2World& world, const b2AABB& box) {
    found_.clear();
    broadPhase_ = &world.GetContactManager().m_broadPhase;
    box_ = box;
    if (treeIsSound(world)) {
        broadPhase_->Query(this, box);
        return found_;
    }
    all(world);
    std::erase_if(found_, [&](const Piece& p) { return !b2TestOverlap(boxOf(p), box); });
    return found_;
}

const std::vector<Piece>& OutlineQuery::ahead(b2World& world, std::span<const b2AABB> boxes, double ahead) {
    b2AABB all = boxes.front();
    for (const b2AABB& box : boxes)
        all.Combine(box);
    now(world, all);
    std::erase_if(found_, [&](const Piece& p) { // those that may move follow, whole
        return p.body->GetType() != b2_staticBody || (boxes.size() > 1 && !meetsOne(boxOf(p), boxes));
    });
    for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext()) {
        if (b->GetType() == b2_staticBody || !b->IsEnabled())
            continue;
        const std::size_t first = found_.size();
        appendSolids(*b, found_);
        const Motion motion = foreseenMotion(*b, static_cast<float>(ahead), world.GetGravity());
        if (std::none_of(found_.begin() + static_cast<std::ptrdiff_t>(first), found_.end(),
                         [&](const Piece& p) { return meetsOne(sweptBox(p, motion), boxes); }))
            found_.resize(first);
    }
    return found_;
}

const std::vector<Piece>& OutlineQuery::onWay(b2Body& body, const Motion& motion, std::span<const b2AABB> boxes) {
    found_.clear();
    appendSolids(body, found_);
    const Motion back{-motion.way, motion.turn};
    if (std::none_of(found_.begin(), found_.end(), [&](const Piece& p) { return meetsOne(sweptBox(p, back), boxes); }))
        found_.clear();
    return found_;
}

const std::vector<Piece>& OutlineQuery::all(b2World& world) {
    found_.clear();
    for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
        if (b->IsEnabled())
            appendSolids(*b, found_);
    return found_;
}

} // namespace supercircle::bridge
