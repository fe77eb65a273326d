// Mean force of a step. The end force of a step is first order in its size: 0.1 mm of travel gives errors of 0.3 to 2
// %. The energy balance gives a second-order mean: work of the crosshead minus numerical dissipation and position
// correction, divided by the travel, placed in the middle of the step.
// If all normal forces equal the crosshead's force (plates, a strip on a floor), friction has the same error. With the
// friction share D of the work W the force is then W (1 - lost / (W - D)) / travel.
// In snaps and impacts, where kinetic energy changes by more than a tenth of the loss, the end force is used. The first
// mean after a change of the step size is uncertain, because stored gap energy changes, and is dropped where others
// follow soon (decision 0151).

#include "plugin/identification/replay/test_rig.h"

#include "plugin/identification/replay/strung_bow.h"
#include "supercircle/rod/equilibrium.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::replay {

namespace {

using experiment::Carrier;
using experiment::ClampPlace;
using experiment::Experiment;
using experiment::Obstacle;
using experiment::ObstacleKind;
using experiment::Specimen;
using rod::Vec2;

constexpr double kThinnest = 1e-3; ///< share of the thickness used for zero

// Of the reference specimen (experiment::NaturalUnits).
constexpr double kRest = 2.0;       ///< s, settling time of a standing specimen
constexpr double kFirstStep = 1e-3; ///< s
constexpr double kParting = 1e-3;   ///< m/s, separation speed of initial overlaps

Vec2 vec(const Point& p) {
    return {p.x, p.y};
}

/// The natural shape with the section at s as the clamp holds it.
Eigen::VectorXd shapeAt(const rod::RodModel& model, double s, const Vec2& point, double angle) {
    rod::Kinematics kin;
    Eigen::VectorXd q = rod::naturalShape(model);
    kin.evaluate(model, q);
    const rod::MaterialPoint at = rod::locate(model, s);
    q = rod::naturalShape(model, Vec2::Zero(), angle - kin.angle(at));
    kin.evaluate(model, q);
    const Vec2 shift = point - kin.point(at);
    q[model.dofX()] += shift.x();
    q[model.dofY()] += shift.y();
    return q;
}

/// Lowest point of the centre line, m.
double lowest(const rod::RodModel& model, const Eigen::VectorXd& q) {
    rod::Kinematics kin;
    kin.evaluate(model, q);
    double y = std::numeric_limits<double>::infinity();
    for (const rod::Arc& a : kin.arcs())
        for (int i = 0; i <= 16; ++i)
            y = std::min(y, a.pointAt(a.length * i / 16.0).y());
    return y;
}

} // namespace

TestRig::TestRig(const Experiment& e, const Parameters& p, const Resolution& resolution, bool specimenReversed)
    : units_(experiment::unitsOfSpecimens(e)), resolution_(resolution.in(units_)), stepper_(step::Settings{}),
      turned_(specimenReversed) {
    if (p.specimens.size() != e.specimens.size()) {
        failure_ = "the parameters are for another number of specimens";
        return;
    }
    // Specimens touch with both surfaces; against obstacles the thickness is divided (contactArm).
    const double arm = e.obstacles.empty() ? 1.0 : std::clamp(p.contactArm, kThinnest, 1.0);
    if (failure_ = checkEffects(p, e); !failure_.empty())
        return;
    common_ = effects::modelFor(p.effects, "all");
    world_.gravity = vec(p.gravity) + common_.gravity;
    double extent = 0.0, skin = 0.0;
    for (std::size_t i = 0; i < e.specimens.size(); ++i) {
        extent = std::max(extent, 4.0 * e.specimens[i].length);
        skin = std::max(skin, 0.5 * (1.0 - arm) * p.specimens[i].thickness);
    }
    ring_ = e.protocol == experiment::Protocol::RingBetweenPlates;
    pressesOnly_ = ring_ || e.protocol == experiment::Protocol::ArchBetweenPlates ||
                   e.protocol == experiment::Protocol::StripOnRigidFloor;
    if (!e.strings.empty()) {
        nock_ = vec(e.strings.front().point);
        double untilted = 0.0;
        applyCarrier(e.strings.front().carriedBy, *nock_, untilted, p);
    }
    for (const Obstacle& o : e.obstacles)
        addObstacle(o, p, skin, extent);
    for (std::size_t i = 0; i < e.specimens.size() && failure_.empty(); ++i)
        addSpecimen(e.specimens[i], p.specimens[i], p, arm);
    if (!failure_.empty())
        return;
    if (nock_)
        addStrings(e, halfString_);
    chooseSettings(p);
    settle(effects::ViscousMoments::Gone);
}

/// Ratio of impulses to those of the reference: the smaller of bending forces and weights, times the period.
double TestRig::impulseOf(const Parameters& p) const {
    constexpr double kWeight = 1270.0 * 0.010 * 0.0005 * 0.0192 * 9.81; // N, of a radius of the reference specimen
    double force = units_.force;
    const double gravity = math::hypot(p.gravity.x, p.gravity.y);
    for (const SpecimenParameters& s : p.specimens)
        if (gravity > 0.0)
            force = std::min(force, s.linearMass * 0.0192 * units_.length * gravity / kWeight);
    return force * units_.settling;
}

/// Core tolerances scale with the thinnest rod; here they must scale with the actual specimen.
void TestRig::chooseSettings(const Parameters& p) {
    double h = std::numeric_limits<double>::infinity();
    for (const SpecimenParameters& s : p.specimens)
        h = std::min(h, s.thickness);
    step::Settings& s = stepper_.settings();
    s.length = h;
    s.localError = resolution_.positionTolerance / h;
    s.recovery = kParting * (units_.length / units_.time) / h;
    s.dtMin *= units_.time;
    // The world's own scale of impulses takes periods as proportional to lengths.
    s.contact.absoluteImpulse *= impulseOf(p) / step::impulseScale(world_);
    s.secondOrder = false; // quasi-static: what vibrates is damped
}

void TestRig::addObstacle(const Obstacle& o, const Parameters& p, double skin, double extent) {
    const bool moves = o.carriedBy == Carrier::Crosshead;
    step::Body body;
    body.id = world_.bodies.size() + 1;
    body.driven = moves;
    body.state.moving = moves;
    body.state.centre = vec(o.point);
    applyCarrier(o.carriedBy, body.state.centre, body.state.angle, p);
    step::BodyOutline outline;
    outline.body = body.id;
    outline.friction = p.friction;
    outline.local.key = static_cast<std::uint32_t>(world_.outlines.size());
    if (o.kind == ObstacleKind::Cylinder) {
        outline.local.kind = contact::OutlineKind::Circle;
        outline.local.points = {Vec2::Zero()};
        outline.local.radius = o.radius + skin;
    } else { // a block behind the plane, with ends out of reach
        outline.local.kind = contact::OutlineKind::Polygon;
        const Vec2 n = vec(o.normal), t(n.y(), -n.x());
        outline.local.radius = skin;
        outline.local.points = {-extent * t - extent * n, extent * t - extent * n, extent * t, -extent * t};
    }
    world_.bodies.push_back(body);
    world_.outlines.push_back(std::move(outline));
}

void TestRig::addStrings(const Experiment& e, double half) {
    step::Body nock; // without outline or contact
    nock.id = world_.bodies.size() + 1;
    nock.driven = nock.state.moving = e.strings.front().carriedBy == Carrier::Crosshead;
    nock.state.centre = *nock_;
    world_.bodies.push_back(nock);
    for (const experiment::Bowstring& s : e.strings) {
        step::Link link;
        link.key = world_.nextPart++;
        link.kind = step::LinkKind::Tether;
        link.end = step::LinkEnd::Body;
        link.rodA = world_.rods.front().key;
        link.sA = s.arcFraction * e.specimens.front().length;
        link.body = nock.id;
        link.length = link.goal = half;
        world_.links.push_back(link);
    }
}

/// Offsets, misalignment and tilt of the crosshead and everything on it.
void TestRig::applyCarrier(const Carrier& carrier, Vec2& point, double& angle, const Parameters& p) const {
    if (carrier != Carrier::Crosshead)
        return;
    point += Vec2(common_.apparatus.offset, p.gapShift);
    angle += common_.apparatus.tilt;
}

void TestRig::addSpecimen(const Specimen& s, const SpecimenParameters& own, const Parameters& p, double arm) {
    rod::RodDefinition d;
    d.length = s.length;
    d.thickness = arm * own.thickness;
    d.linearMass = own.linearMass;
    d.bendingModulus = own.bendingModulus;
    // A ring between plates has four quarters, each bent like a rod.
    int elements = std::max(1, resolution_.elements) * (ring_ ? 2 : 1);
    if (s.clamp.where != ClampPlace::None)
        elements = rod::elementsMeetingAt(s.clamp.arcPosition / s.length, elements);
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), own.naturalCurvature);
    d.closed = ring_;
    if (failure_ = rod::validate(d); !failure_.empty()) {
        failure_ = "specimen " + s.id + ": " + failure_;
        return;
    }
    effects::Model extra = effects::modelFor(p.effects, s.id);
    extra.contact.compliance.normal += p.touchCompliance;
    if (turned_)
        for (effects::Profile& profile : extra.material.profiles)
            profile = effects::mirrored(profile);
    rod::RodDefinition formed = d; // natural shape with its defects
    const effects::Section section =
        effects::sections(rod::RodModel(d), extra.material.profiles, extra.material.profiles.size());
    for (std::size_t i = 0; i < formed.naturalCurvature.size(); ++i)
        formed.naturalCurvature[i] += section.curvature[i];
    if (ring_) // closed; its shape is found while settling
        formed.naturalCurvature.assign(formed.naturalCurvature.size(), 2.0 * M_PI / s.length);
    const rod::RodModel model(formed);
    const bool onHead = s.clamp.carriedBy == Carrier::Crosshead;
    const bool clamped = s.clamp.where != ClampPlace::None;
    Vec2 point = vec(s.clamp.initialPoint);
    double angle = s.clamp.initialTangentAngle;
    applyCarrier(s.clamp.carriedBy, point, angle, p);
    Eigen::VectorXd q;
    if (clamped) {
        rod::EquilibriumProblem hanging;
        if (!extra.drag.on()) // with surface drag it keeps its natural shape and sinks in settle()
            hanging.gravity = world_.gravity;
        hanging.supports = {rod::clamp(s.clamp.arcPosition, point, angle)};
        const rod::Equilibrium rest =
            rod::solveEquilibrium(model, hanging, shapeAt(model, s.clamp.arcPosition, point, angle));
        if (!rest.converged()) {
            failure_ = "specimen " + s.id + ": no equilibrium at the start was found: " + rest.failure;
            return;
        }
        q = rest.q;
        if (nock_) {
            const StrungBow strung =
                stringBow(rod::RodModel(d), world_.gravity, s.clamp.arcPosition, point, angle, *nock_);
            if (failure_ = strung.failure; !failure_.empty())
                return;
            q = strung.q;
            halfString_ = strung.half;
        }
    } else { // apex at x = 0 with horizontal tangent, tips on the floor
        q = rod::naturalShape(model, Vec2::Zero(), M_PI);
        double floor = 0.0;
        for (const step::Body& b : world_.bodies)
            if (!b.driven)
                floor = b.state.centre.y();
        q[model.dofY()] += floor + 0.5 * own.thickness - lowest(model, q);
    }
    const std::size_t index = step::addRod(world_, d, q, Eigen::VectorXd::Zero(model.dofs()), p.friction);
    step::setEffects(world_, index, extra);
    if (!clamped)
        return;
    step::Hold hold;
    hold.s = s.clamp.arcPosition;
    hold.onCrosshead = onHead;
    hold.target.point = point;
    hold.target.angle = angle;
    hold.turnStiffness = turnStiffness(common_.apparatus);
    world_.rods[index].holds.push_back(hold);
}

/// Lets standing specimens settle (backward Euler with long steps); clamped ones are in equilibrium.
void TestRig::settle(effects::ViscousMoments viscous) {
    if (!failure_.empty())
        return;
    world_.dtNext = kFirstStep * units_.settling;
    if (step::comeToRest(world_, viscous, [&] { return move(0.0, kRest * units_.settling, {}); }))
        start_ = world_.time;
}

double TestRig::nextStep() const {
    return std::min(world_.dtNext, stepper_.settings().dtMax);
}

double TestRig::StepSizeHold::longestStep(double time, double most) {
    constexpr int kShortRun = 3, kFirst = 16, kLast = 256; // steps
    const double dt = time - time_;
    ++steps_;
    if (dt > 1.5 * last_ && last_ > 0.0) {
        grewAt_ = steps_;
        before_ = last_;
    } else if (grewAt_ > 0 && dt < 0.75 * last_ && steps_ - grewAt_ <= kShortRun) {
        pause_ = std::clamp(2 * pause_, kFirst, kLast);
        until_ = steps_ + pause_;
        cap_ = 1.1 * before_;
        grewAt_ = 0;
    } else if (grewAt_ > 0 && steps_ - grewAt_ > kShortRun) {
        pause_ /= 2;
        grewAt_ = 0;
    }
    time_ = time;
    last_ = dt;
    return steps_ < until_ ? std::min(most, cap_) : most;
}

bool TestRig::move(double displacement, double duration, const std::function<bool()>& observe) {
    const double speed = displacement / duration;
    step::Settings& settings = stepper_.settings();
    settings.dtMax = inMotion_      ? motionStep_
                     : speed == 0.0 ? resolution_.dtMax
                                    : std::min(resolution_.dtMax, resolution_.travelMax / std::abs(speed));
    world_.crossheadVelocity = speed * direction_;
    balance_ = world_.energyBalance;
    lastDisplacement_ = this->displacement();
    const double longestStep = settings.dtMax;
    stepSizeHold_.begin(world_.time);
    const step::FrameResult out = stepper_.advance(world_, duration, nullptr, [&](const step::World&) {
        if (pressesOnly_)
            settings.dtMax = stepSizeHold_.longestStep(world_.time, longestStep);
        readMeanForce();
        return observe && observe();
    });
    if (!out.failure.empty())
        failure_ = out.failure + " (at t = " + std::to_string(time()) + " s)";
    return out.failure.empty() && !out.stopped;
}

/// Additional correction of the work for friction computed with a too large force.
/// @param stored work minus friction, J
/// @param work of the crosshead, J
double TestRig::frictionCorrection(double lost, double stored, double work) const {
    constexpr double kSmall = 0.2, kLarge = 0.4; // of the stored energy: more is no error of a slow step
    if (!pressesOnly_ || stored * work <= 0.0)
        return 1.0;
    const double share = std::clamp((kLarge - std::abs(lost / stored)) / (kLarge - kSmall), 0.0, 1.0);
    return 1.0 + share * (work / stored - 1.0);
}

void TestRig::readMeanForce() {
    const step::EnergyBalance& now = world_.energyBalance;
    const double travel = displacement() - lastDisplacement_;
    const double work = now.work - balance_.work;
    const double lost = (now.numerical - balance_.numerical) + (now.positionCorrection - balance_.positionCorrection);
    const double kinetic = now.kinetic - balance_.kinetic;
    constexpr double kMost = 0.05; // share of the force scale: more is no error of a slow step
    const double most = kMost * std::abs(travel) * std::max(std::abs(force()), forceScale_);
    constexpr double kQuiet = 0.1;  // largest change of kinetic energy, share of the loss
    constexpr double kStill = 2e-4; // or share of the work, where friction is corrected
    const double quiet = std::max(kQuiet * lost, pressesOnly_ ? kStill * std::abs(work) : 0.0);
    constexpr double kAlike = 0.05;
    mean_.steady = std::abs(travel - mean_.travel) <= kAlike * std::abs(travel);
    mean_.travel = travel;
    mean_.known = travel != 0.0 && lost > 0.0 && lost < most && std::abs(kinetic) < quiet;
    if (mean_.known) {
        // Correct the work, not the end force, which differs from the mean by half a step.
        mean_.force =
            (work - lost * frictionCorrection(lost, work - (now.friction - balance_.friction), work)) / travel;
        forceScale_ = std::max(forceScale_, std::abs(mean_.force));
    }
    balance_ = now;
    lastDisplacement_ = displacement();
}

double TestRig::bend() const {
    double most = 0.0;
    for (const step::Rod& rod : world_.rods)
        for (int e = 0; e < rod.model.elements(); ++e)
            most = std::max(most, std::abs(rod.q[rod.model.dofOfElement(e)] -
                                           rod.model.definition().naturalCurvature[static_cast<std::size_t>(e)]));
    return most;
}

rod::Vec2 TestRig::point(std::size_t specimen, double arcFraction) const {
    const step::Rod& rod = world_.rods[specimen];
    const double along = turned_ ? 1.0 - arcFraction : arcFraction;
    return rod.kin.point(rod::locate(rod.model, along * rod.model.definition().length));
}

rod::Vec2 TestRig::velocity(std::size_t specimen, double arcFraction) const {
    const step::Rod& rod = world_.rods[specimen];
    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, rod.model.dofs());
    rod.kin.pointRows(rod.model, rod::locate(rod.model, arcFraction * rod.model.definition().length), rod::Vec2::Zero(),
                      rod::Vec2::UnitX(), rod::Vec2::UnitY(), rows);
    return rows * rod.v;
}

double TestRig::spin(std::size_t specimen, double arcFraction) const {
    const step::Rod& rod = world_.rods[specimen];
    Eigen::RowVectorXd row(rod.model.dofs());
    rod.kin.angleRow(rod.model, rod::locate(rod.model, arcFraction * rod.model.definition().length), row);
    return row.dot(rod.v);
}

double TestRig::angle(std::size_t specimen, double arcFraction) const {
    const step::Rod& rod = world_.rods[specimen];
    return rod.kin.angle(rod::locate(rod.model, arcFraction * rod.model.definition().length));
}

} // namespace supercircle::replay
