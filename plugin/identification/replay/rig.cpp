// What the load cell reads.
//
// A step balances the bending forces at its end with the lever arms of its middle (supercircle/step/stepper.h), so the
// force on the head is first order in the step: with 0.1 mm of travel a step it is 0.3 to 2 % too high on the way in
// and too low on the way back, worst behind the buckling of a strip, and it jumps where the step size changes. The
// configuration itself is far better: markers differ by micrometres. Halving the steps costs twice the time for half
// the error. The energy books know the cure: the work of the head in a step is the change of stored energy, plus what
// was dissipated, plus two accounts that are artefacts of the step, `numerical` and `pushOut`. Taking these two off
// (of the work: off the force at the step's end, which is half a step ahead of the mean, they left a fifth of it)
// leaves the mean force over the step, which is second order when placed in its middle: with steps of 55 to 78 um the
// error fell from 0.3 - 2 % to 0.01 - 0.05 % in the strip and the coiled shell, where nothing slides. Where something
// slides the normal forces and with them the friction are as much too large, and about half is cured by this. Between
// parallel plates, and where a strip stands on the floor, the normal forces are the head's force: then both are off by
// one factor, and with friction's share D of the step's work W the force is W (1 - lost / (W - D)) / way. That cures
// the rest: against steps of a tenth, an arch whose feet slide is off by .002 to .005 % of the peak (68 % of the
// readings; .007 to .02 % for 95 %) where it was by .02 to .05 (.05 to .13) - and by as much differently where step
// lengths halve and double in turn, which a change of a number by 1e-5 could start or end: 40 squares in 6 runs of 2000
// readings, in which every fit of a weak effect stuck. On a cylinder it does not help: there normal forces stay large
// where the head's passes through zero, and the factor is not one (.28 % of the peak, for .08).
//
// In snaps and impacts kinetic energy goes into the same account; there (kinetic energy changing by more than a tenth
// of the loss) the force is taken as the step has it.
//
// How far contacts are off and the rod from its equilibrium at a step's end depends on how long the step was. What
// energy is in that (a buckled strip: 64 nm under 1.4 N and half as much again in the rod) stays from step to step
// while they are of one length; in the first step of another length it is set free or taken up. There means were off
// by 1.2 %, and where lengths halve and double in turn, by that every other step: readings that fell there were chance,
// four times their noise, and no fit found the best of the strips. Such a mean is not used where the next ones come
// soon. Most of it is gone since the core measures in thicknesses of the specimen as it is and not of the rod that
// stands for it beside obstacles, a thousandth as thick (see `arm`): it predicts the middle of a step no farther than a
// quarter of that, so that steps were linearised where they began, a sticking tip crept 1.7 um in each cycle of 3 mm
// and every mean was off by .001 to .01 % of the peak (now .0002 where nothing slides, .0008 for the arch). Two other
// cures: means over as much way as four long steps have smear the kink of a specimen that begins to slide (14 mN of
// 530), and booking normal force times gap as stored takes two thirds of it.

#include "plugin/identification/replay/rig.h"

#include "plugin/identification/replay/brace.h"
#include "supercircle/rod/equilibrium.h"

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

constexpr double kThinnest = 1e-3; ///< share of the thickness that stands for none
constexpr double kRest = 2.0;      ///< s, in which a standing specimen comes to rest before the run starts
constexpr double kParting = 1e-3;  ///< m/s, at which what overlaps where it was put is parted meanwhile

Vec2 vec(const Point& p) {
    return {p.x, p.y};
}

/// The natural shape with the section at s where and how the clamp holds it.
Eigen::VectorXd shapeAt(const rod::RodModel& model, double s, const Vec2& point, double angle) {
    rod::Kinematics kin;
    Eigen::VectorXd q = rod::naturalShape(model);
    kin.evaluate(model, q);
    const rod::Place at = rod::locate(model, s);
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

Rig::Rig(const Experiment& e, const Parameters& p, const Resolution& resolution, bool turned)
    : resolution_(resolution), stepper_(step::Settings{}), turned_(turned) {
    if (p.specimens.size() != e.specimens.size()) {
        failure_ = "parameters are for another number of specimens";
        return;
    }
    // Between specimens a contact needs both surfaces; against obstacles the thickness is shared out (contactArm).
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
        place(e.strings.front().carriedBy, *nock_, untilted, p);
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
    settle();
}

/// The core measures its tolerances in thicknesses of the thinnest rod; here they belong to the specimen as it is.
void Rig::chooseSettings(const Parameters& p) {
    double h = std::numeric_limits<double>::infinity();
    for (const SpecimenParameters& s : p.specimens)
        h = std::min(h, s.thickness);
    step::Settings& s = stepper_.settings();
    s.length = h;
    s.localError = resolution_.positionTolerance / h;
    s.recovery = kParting / h;
}

void Rig::addObstacle(const Obstacle& o, const Parameters& p, double skin, double extent) {
    const bool moves = o.carriedBy == Carrier::MachineHead;
    step::Body body;
    body.id = world_.bodies.size() + 1;
    body.driven = moves;
    body.state.moving = moves;
    body.state.centre = vec(o.point);
    place(o.carriedBy, body.state.centre, body.state.angle, p);
    step::BodyOutline outline;
    outline.body = body.id;
    outline.friction = p.friction;
    outline.local.key = static_cast<std::uint32_t>(world_.outlines.size());
    if (o.kind == ObstacleKind::Cylinder) {
        outline.local.kind = contact::OutlineKind::Circle;
        outline.local.points = {Vec2::Zero()};
        outline.local.radius = o.radius + skin;
    } else { // a block behind the plane, wide enough that its ends are never reached
        outline.local.kind = contact::OutlineKind::Polygon;
        const Vec2 n = vec(o.normal), t(n.y(), -n.x());
        outline.local.radius = skin;
        outline.local.points = {-extent * t - extent * n, extent * t - extent * n, extent * t, -extent * t};
    }
    world_.bodies.push_back(body);
    world_.outlines.push_back(std::move(outline));
}

void Rig::addStrings(const Experiment& e, double half) {
    step::Body nock; // has no outline: nothing touches it
    nock.id = world_.bodies.size() + 1;
    nock.driven = nock.state.moving = e.strings.front().carriedBy == Carrier::MachineHead;
    nock.state.centre = *nock_;
    world_.bodies.push_back(nock);
    for (const experiment::String& s : e.strings) {
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

/// The head may be higher than stated, off axis and tilted; what it carries comes along.
void Rig::place(const Carrier& carrier, Vec2& point, double& angle, const Parameters& p) const {
    if (carrier != Carrier::MachineHead)
        return;
    point += Vec2(common_.apparatus.offset, p.gapShift);
    angle += common_.apparatus.tilt;
}

void Rig::addSpecimen(const Specimen& s, const SpecimenParameters& own, const Parameters& p, double arm) {
    rod::RodDefinition d;
    d.length = s.length;
    d.thickness = arm * own.thickness;
    d.linearMass = own.linearMass;
    d.bendingModulus = own.bendingModulus;
    // A ring between plates has four quarters, each bent like a rod of its own.
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
            profile = effects::turned(profile);
    rod::RodDefinition formed = d; // as it was made: defects of the natural shape included
    const effects::Section section =
        effects::sections(rod::RodModel(d), extra.material.profiles, extra.material.profiles.size());
    for (std::size_t i = 0; i < formed.naturalCurvature.size(); ++i)
        formed.naturalCurvature[i] += section.curvature[i];
    if (ring_) // closes whatever it would like to be; it finds its shape while it settles
        formed.naturalCurvature.assign(formed.naturalCurvature.size(), 2.0 * M_PI / s.length);
    const rod::RodModel model(formed);
    const bool onHead = s.clamp.carriedBy == Carrier::MachineHead;
    const bool clamped = s.clamp.where != ClampPlace::None;
    Vec2 point = vec(s.clamp.initialPoint);
    double angle = s.clamp.initialTangentAngle;
    place(s.clamp.carriedBy, point, angle, p);
    Eigen::VectorXd q;
    if (clamped) {
        rod::EquilibriumProblem hanging;
        if (!extra.drag.on()) // walls that hold it hold it where it was put, in its natural shape: it sinks in settle()
            hanging.gravity = world_.gravity;
        hanging.holds = {rod::clamp(s.clamp.arcPosition, point, angle)};
        const rod::Equilibrium rest =
            rod::solveEquilibrium(model, hanging, shapeAt(model, s.clamp.arcPosition, point, angle));
        if (!rest.converged()) {
            failure_ = "specimen " + s.id + " finds no equilibrium at the start: " + rest.failure;
            return;
        }
        q = rest.q;
        if (nock_) {
            const Braced braced = brace(rod::RodModel(d), world_.gravity, s.clamp.arcPosition, point, angle, *nock_);
            if (failure_ = braced.failure; !failure_.empty())
                return;
            q = braced.q;
            halfString_ = braced.half;
        }
    } else { // "apex at x = 0, apex tangent horizontal", tips on the floor
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
    hold.onMachine = onHead;
    hold.target.point = point;
    hold.target.angle = angle;
    world_.rods[index].holds.push_back(hold);
}

/// Standing specimens sag and come to rest (backward Euler with long steps sees to it); clamped ones rest already.
void Rig::settle() {
    world_.dtNext = 1e-3;
    if (!move(0.0, kRest, {}))
        return;
    step::restEffects(world_);
    start_ = world_.time;
}

double Rig::Patience::longest(double time, double most) {
    constexpr int kSoon = 3, kFirst = 16, kLast = 256; // steps
    const double dt = time - time_;
    ++steps_;
    if (dt > 1.5 * last_ && last_ > 0.0) {
        grew_ = steps_;
        before_ = last_;
    } else if (grew_ > 0 && dt < 0.75 * last_ && steps_ - grew_ <= kSoon) {
        pause_ = std::clamp(2 * pause_, kFirst, kLast);
        until_ = steps_ + pause_;
        cap_ = 1.1 * before_;
        grew_ = 0;
    } else if (grew_ > 0 && steps_ - grew_ > kSoon) {
        pause_ /= 2;
        grew_ = 0;
    }
    time_ = time;
    last_ = dt;
    return steps_ < until_ ? std::min(most, cap_) : most;
}

bool Rig::move(double displacement, double duration, const std::function<bool()>& observe) {
    const double speed = displacement / duration;
    step::Settings& settings = stepper_.settings();
    settings.dtMax =
        speed == 0.0 ? resolution_.dtMax : std::min(resolution_.dtMax, resolution_.travelMax / std::abs(speed));
    world_.machineVelocity = {0.0, -speed};
    books_ = world_.ledger;
    lastDisplacement_ = this->displacement();
    const double longest = settings.dtMax;
    patience_.begin(world_.time);
    const step::FrameResult out = stepper_.advance(world_, duration, nullptr, [&](const step::World&) {
        if (pressesOnly_)
            settings.dtMax = patience_.longest(world_.time, longest);
        readMeanForce();
        return observe && observe();
    });
    if (!out.failure.empty())
        failure_ = out.failure + " (at t = " + std::to_string(time()) + " s)";
    return out.failure.empty() && !out.stopped;
}

/// By how much more than its loss a step's work is too large, because its friction is of too large a force.
/// @param stored work less friction, J @param work of the head, J
double Rig::frictionToo(double lost, double stored, double work) const {
    constexpr double kSmall = 0.2, kLarge = 0.4; // of what is stored: more is no error of a slow step
    if (!pressesOnly_ || stored * work <= 0.0)
        return 1.0;
    const double share = std::clamp((kLarge - std::abs(lost / stored)) / (kLarge - kSmall), 0.0, 1.0);
    return 1.0 + share * (work / stored - 1.0);
}

void Rig::readMeanForce() {
    const step::Ledger& now = world_.ledger;
    const double way = displacement() - lastDisplacement_;
    const double work = now.work - books_.work;
    const double lost = (now.numerical - books_.numerical) + (now.pushOut - books_.pushOut);
    const double kinetic = now.kinetic - books_.kinetic;
    constexpr double kMost = 0.05; // share of the force scale; more is no error of a slow step
    const double most = kMost * std::abs(way) * std::max(std::abs(force()), forceScale_);
    constexpr double kQuiet = 0.1;  // share of the loss that a change of kinetic energy may be worth, ...
    constexpr double kStill = 2e-4; // ... or of the work, where friction is put right: short steps lose next to nothing
    const double quiet = std::max(kQuiet * lost, pressesOnly_ ? kStill * std::abs(work) : 0.0);
    constexpr double kAlike = 0.05;
    mean_.steady = std::abs(way - mean_.way) <= kAlike * std::abs(way);
    mean_.way = way;
    mean_.known = way != 0.0 && lost > 0.0 && lost < most && std::abs(kinetic) < quiet;
    if (mean_.known) {
        // By the work: the force at the step's end is as far from its mean as half a step of the head makes it, a
        // hysteresis of a fifth of what is taken out here.
        mean_.force = (work - lost * frictionToo(lost, work - (now.friction - books_.friction), work)) / way;
        forceScale_ = std::max(forceScale_, std::abs(mean_.force));
    }
    books_ = now;
    lastDisplacement_ = displacement();
}

double Rig::bend() const {
    double most = 0.0;
    for (const step::Rod& rod : world_.rods)
        for (int e = 0; e < rod.model.elements(); ++e)
            most = std::max(most, std::abs(rod.q[rod.model.dofOfElement(e)] -
                                           rod.model.definition().naturalCurvature[static_cast<std::size_t>(e)]));
    return most;
}

rod::Vec2 Rig::point(std::size_t specimen, double arcFraction) const {
    const step::Rod& rod = world_.rods[specimen];
    const double along = turned_ ? 1.0 - arcFraction : arcFraction;
    return rod.kin.point(rod::locate(rod.model, along * rod.model.definition().length));
}

} // namespace supercircle::replay
