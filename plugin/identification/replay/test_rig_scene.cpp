// The set-up of a scene with shells: its bodies are at rest or moved by the machine, so that no host engine is needed
// and all of it is in double precision.

#include "plugin/api/from_definition.h"
#include "plugin/identification/replay/test_rig.h"
#include "plugin/scene/loader/scene.h"
#include "supercircle/step/damping.h"
#include "supercircle/step/rigid_definition.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supercircle::replay {

namespace {

using contact::Outline;
using contact::OutlineKind;
using rod::Vec2;
using step::FixtureDefinition;
using step::ShapeKind;

/// The pieces of a fixture, in the frame of its body. Chains are solid on the right of v_i -> v_i+1, one-sided outlines
/// of the core on the right of points[0] -> points[1]: rods stay on the left of these, bodies of Box2D on the right of
/// its edges, so that one-sided edges change direction (bridge/box2d/outlines.cpp).
std::vector<Outline> piecesOf(const FixtureDefinition& f) {
    std::vector<Outline> all(1);
    if (f.shape == ShapeKind::Circle) {
        all.front().kind = OutlineKind::Circle;
        all.front().points = {f.centre};
        all.front().radius = f.radius;
    } else if (f.shape == ShapeKind::Polygon) {
        all.front().kind = OutlineKind::Polygon;
        for (const Vec2& v : f.vertices)
            all.front().points.push_back(v);
    } else if (f.twoSided) {
        all.front().kind = OutlineKind::Segment;
        all.front().points = {f.vertices[0], f.vertices[1]};
    } else {
        all.clear();
        const bool loop = f.shape == ShapeKind::Loop;
        const std::size_t n = f.vertices.size(), edges = loop ? n : n - 1;
        for (std::size_t i = 0; i < edges; ++i) {
            Outline o;
            o.kind = OutlineKind::OneSided;
            o.points = {f.vertices[(i + 1) % n], f.vertices[i]};
            o.joinedStart = loop || i + 1 < edges;
            o.joinedEnd = loop || i > 0;
            if (o.joinedStart)
                o.neighbourStart = f.vertices[(i + 2) % n];
            if (o.joinedEnd)
                o.neighbourEnd = f.vertices[(i + n - 1) % n];
            all.push_back(std::move(o));
        }
    }
    for (Outline& o : all) {
        o.category = f.filterCategoryBits;
        o.mask = f.filterMaskBits;
        o.group = f.filterGroupIndex;
    }
    return all;
}

/// The shell with as many elements as the resolution asks for. The scene's number is that of the fine resolution. All
/// are odd or all are even: the middle of a shell is a node or it is not, and errors of both kinds do not compare.
/// @param holds places where two arcs should meet
ShellDef atResolution(const ShellDef& d, const Resolution& resolution, const std::vector<double>& holds) {
    const auto even = [](const std::vector<double>& values) {
        return std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); });
    };
    const double share = static_cast<double>(resolution.elements) / Resolution::fine().elements;
    ShellDef out = d;
    if (share == 1.0 || !even(d.natural_curvature) || !even(d.curvature) || d.tip_refinement != 1.0)
        return out;
    out.elements = std::max(3, static_cast<int>(std::lround(share * d.elements)));
    out.elements += (out.elements + d.elements) % 2;
    for (const double s : holds)
        if (s > 0.0 && s < 1.0)
            out.elements = rod::elementsMeetingAt(s, out.elements);
    const auto count = static_cast<std::size_t>(out.elements);
    for (std::vector<double>* values : {&out.natural_curvature, &out.curvature})
        if (!values->empty())
            values->assign(count, values->front());
    return out;
}

/// Whether one specimen lies between two plates: all its normal forces equal that of the machine.
bool squeezes(const scene::Scene& s) {
    const auto plate = [](const step::BodyDefinition& b) {
        return b.fixtures.size() == 1 && b.fixtures.front().shape == ShapeKind::Polygon;
    };
    return s.shells.size() == 1 && s.holds.empty() && s.rigid.bodies.size() == 2 && plate(s.rigid.bodies[0]) &&
           plate(s.rigid.bodies[1]);
}

} // namespace

TestRig::TestRig(const experiment::Experiment& e, const scene::Scene& scene, const Parameters& p,
                 const Resolution& resolution)
    : units_(experiment::unitsOfSpecimens(e)), resolution_(resolution.in(units_)), stepper_(step::Settings{}) {
    if (failure_ = checkEffects(p, e); !failure_.empty())
        return;
    common_ = effects::modelFor(p.effects, "all");
    if (scene.protocol)
        direction_ = {scene.protocol->direction.x, scene.protocol->direction.y};
    Parameters own = p;
    own.specimens.clear();
    for (const ShellDef& d : scene.shells)
        own.specimens.push_back({bending_modulus(d), 0.0, d.thickness, d.density * d.width * d.thickness});
    world_.gravity = Vec2(p.gravity.x, p.gravity.y) + common_.gravity;
    ring_ = std::any_of(scene.shells.begin(), scene.shells.end(), [](const ShellDef& d) { return d.closed; });
    pressesOnly_ = squeezes(scene);
    addBodies(scene);
    addShells(scene, p);
    if (!failure_.empty())
        return;
    addHolds(scene);
    if (!failure_.empty())
        return;
    chooseSettings(own);
    setLoads(scene.loads, scene.starts_at_rest);
    // A machine moves slowly; what nothing drives vibrates, unless the scene says that only rest counts.
    inMotion_ = !scene.numerics.quasi_static.value_or(scene.protocol.has_value() || e.scene->driven);
    if (inMotion_ && !scene.starts_at_rest) {
        setInMotion();
        return;
    }
    const bool moves = std::exchange(inMotion_, false);
    // What nothing drives feels its loads from time 0 on, unless it has come to rest before. A drive begins at rest.
    const bool sudden = !moves && !scene.protocol && !e.scene->driven && !scene.starts_at_rest;
    settle(sudden ? effects::ViscousMoments::Held : effects::ViscousMoments::Gone);
    const bool released = scene.starts_at_rest && std::any_of(scene.loads.begin(), scene.loads.end(),
                                                              [](const scene::PointLoad& l) { return l.released; });
    if (!moves && !released)
        return;
    setLoads(scene.loads, false);
    if (!moves) { // the rest without them, found at once
        settle(effects::ViscousMoments::Held);
        return;
    }
    for (step::Rod& rod : world_.rods) {
        rod.v.setZero();
        step::refreshRod(rod);
    }
    setInMotion();
}

void TestRig::setLoads(const std::vector<scene::PointLoad>& loads, bool before) {
    for (std::size_t i = 0; i < world_.rods.size(); ++i) {
        step::Rod& rod = world_.rods[i];
        rod.forces.clear();
        for (const scene::PointLoad& load : loads) {
            if (load.shell != names_[i] || (load.released && !before))
                continue;
            step::AppliedForce force;
            force.s = load.arc_fraction * rod.model.definition().length;
            force.force = {load.force.x, load.force.y};
            force.torque = load.moment;
            rod.forces.push_back(force);
        }
    }
}

/// Forty steps in the period of the first mode, whose interpolation errs by 2e-6 of the amplitude; twice as many err by
/// 1e-7, half as many by 3e-5. The core's own error of free motion is 6e-4 of the amplitude in five periods, a third of
/// that of 48 arcs. A fifth of its tolerance costs 3.7 times as much and does not come closer to the closed form.
void TestRig::setInMotion() {
    constexpr double kSteps = 40.0;
    inMotion_ = true;
    step::Settings& s = stepper_.settings();
    s.secondOrder = true;
    double fastest = 0.0; // rad/s
    for (const step::Rod& rod : world_.rods)
        fastest = std::max(fastest, step::firstFrequency(rod));
    const double share = resolution_.freeStep / (Resolution::fine().freeStep * units_.time);
    motionStep_ = share * 2.0 * M_PI / (kSteps * fastest);
    s.freeError *= share;
    world_.dtNext = motionStep_;
    start_ = world_.time;
}

void TestRig::addBodies(const scene::Scene& scene) {
    const std::string machine = scene.protocol ? scene.protocol->body : "";
    for (const step::BodyDefinition& b : scene.rigid.bodies) {
        step::Body body;
        body.id = world_.bodies.size() + 1;
        body.driven = body.state.moving = !machine.empty() && b.name == machine;
        body.state.centre = b.position;
        body.state.angle = b.angle;
        if (body.driven) {
            body.state.centre += common_.apparatus.offset * Vec2(-direction_.y(), direction_.x());
            body.state.angle += common_.apparatus.tilt;
        }
        for (std::size_t f = 0; f < b.fixtures.size(); ++f) {
            if (b.fixtures[f].sensor || !b.active)
                continue;
            for (Outline& piece : piecesOf(b.fixtures[f])) {
                step::BodyOutline outline;
                outline.body = body.id;
                outline.friction = b.fixtures[f].friction;
                outline.fixture = static_cast<std::uint32_t>(f);
                outline.local = std::move(piece);
                outline.local.key = static_cast<std::uint32_t>(world_.outlines.size());
                world_.outlines.push_back(std::move(outline));
            }
        }
        world_.bodies.push_back(body);
    }
}

void TestRig::addShells(const scene::Scene& scene, const Parameters& p) {
    for (const ShellDef& described : scene.shells) {
        std::vector<double> holds;
        for (const HoldDef& h : scene.holds)
            if (h.shell == described.name)
                holds.push_back(h.arc_fraction);
        const auto made = fromDefinition(atResolution(described, resolution_, holds));
        if (!made) {
            failure_ = "shell \"" + described.name + "\": " + made.error();
            return;
        }
        effects::Model extra = effects::modelFor(p.effects, described.name);
        extra.contact.compliance.normal += p.touchCompliance;
        const std::size_t index = step::addRod(world_, made->definition, made->q, made->v, described.mu);
        step::Rod& rod = world_.rods[index];
        rod.category = described.category;
        rod.mask = described.mask;
        rod.group = described.group;
        rod.width = described.width;
        rod.dampingRatio = described.damping_ratio;
        step::setEffects(world_, index, extra);
        names_.push_back(described.name);
    }
}

void TestRig::addHolds(const scene::Scene& scene) {
    for (const HoldDef& h : scene.holds) {
        std::size_t index = 0;
        while (index < scene.shells.size() && scene.shells[index].name != h.shell)
            ++index;
        if (index == scene.shells.size()) {
            failure_ = "there is no shell \"" + h.shell + "\", which is held";
            return;
        }
        step::Rod& rod = world_.rods[index];
        step::Hold hold;
        hold.s = h.arc_fraction * rod.model.definition().length;
        hold.clamped = h.kind == HoldKind::Clamp;
        hold.turnStiffness = hold.clamped ? turnStiffness(common_.apparatus) : 0.0;
        hold.onCrosshead = h.base == HoldBase::Moving;
        const rod::MaterialPoint at = rod::locate(rod.model, hold.s);
        hold.target.point = rod.kin.point(at);
        hold.target.angle = rod.kin.angle(at);
        hold.key = world_.nextPart++;
        if (hold.onCrosshead && (common_.apparatus.offset != 0.0 || common_.apparatus.tilt != 0.0)) {
            misalign(index, hold);
            hold.target.point = rod.kin.point(at);
            hold.target.angle = rod.kin.angle(at);
        }
        rod.holds.push_back(hold);
        if (rod.holds.size() > 1 && (common_.apparatus.offset != 0.0 || common_.apparatus.tilt != 0.0))
            failure_ = "misalignment of the shell \"" + h.shell + "\", which is held twice, is not simulated";
    }
}

void TestRig::misalign(std::size_t index, const step::Hold& hold) {
    step::Rod& rod = world_.rods[index];
    Eigen::VectorXd q = rod.q;
    const double c = math::cos(common_.apparatus.tilt), s = math::sin(common_.apparatus.tilt);
    const Vec2 middle(q[rod.model.dofX()], q[rod.model.dofY()]), arm = middle - hold.target.point;
    const Vec2 turned = hold.target.point + Vec2(c * arm.x() - s * arm.y(), s * arm.x() + c * arm.y()) +
                        common_.apparatus.offset * Vec2(-direction_.y(), direction_.x());
    q[rod.model.dofX()] = turned.x();
    q[rod.model.dofY()] = turned.y();
    q[rod.model.dofTheta()] += common_.apparatus.tilt;
    step::placeRod(world_, index, q, Eigen::VectorXd::Zero(rod.model.dofs()));
}

} // namespace supercircle::replay
