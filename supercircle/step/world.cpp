#include "supercircle/step/world.h"

#include "supercircle/contact/feature_id.h"
#include "supercircle/step/carry_along.h"
#include "supercircle/step/sleep.h"
#include "supercircle/support/invariants.h"
#include "supercircle/support/trig.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace supercircle::step {

const char* name(Stage stage) {
    static const char* const names[] = {"check",           "read_host", "drive",      "detect", "linearise",
                                        "evaluate",        "predict",   "assemble",   "solve",  "integrate",
                                        "check_crossings", "accept",    "write_host", "count"};
    return names[static_cast<int>(stage)];
}

const char* name(Reason reason) {
    static const char* const names[] = {
        "none",        "not_finite",     "solver_failed",      "unconverged",   "motion_too_large",
        "local_error", "runaway",        "candidates_too_few", "penetration",   "link_gap",
        "crossing",    "outside_region", "sleeper_pressed",    "status_change", "gap_energy",
        "count"};
    return names[static_cast<int>(reason)];
}

Counters& Counters::operator+=(const Counters& o) {
    steps += o.steps;
    rejected += o.rejected;
    for (std::size_t i = 0; i < rejectedFor.size(); ++i)
        rejectedFor[i] += o.rejectedFor[i];
    solves += o.solves;
    gaussSeidelIterations += o.gaussSeidelIterations;
    pivots += o.pivots;
    unconverged += o.unconverged;
    byAbsoluteFloor += o.byAbsoluteFloor;
    crossings += o.crossings;
    quarantined += o.quarantined;
    contactResidualMax = std::max(contactResidualMax, o.contactResidualMax);
    contactsMax = std::max(contactsMax, o.contactsMax);
    activeContactsMax = std::max(activeContactsMax, o.activeContactsMax);
    penetrationMax = std::max(penetrationMax, o.penetrationMax);
    return *this;
}

void HostAcceleration::learn(const Vec2& newLinear, double newAngular, double newFrame) {
    const auto agreed = [](double a, double b) { return a * b <= 0.0 ? 0.0 : std::abs(a) < std::abs(b) ? a : b; };
    expectedLinear = {agreed(linear.x(), newLinear.x()), agreed(linear.y(), newLinear.y())};
    expectedAngular = agreed(angular, newAngular);
    linear = newLinear;
    angular = newAngular;
    frame = std::min(lastFrame, newFrame);
    lastFrame = newFrame;
}

HostAcceleration HostAcceleration::during(double coming) const {
    HostAcceleration p = *this;
    if (coming > 2.0 * frame && frame > 0.0) {
        p.expectedLinear *= frame / coming;
        p.expectedAngular *= frame / coming;
    }
    return p;
}

Vec2 World::crossheadForce() const {
    Vec2 sum = Vec2::Zero();
    for (const Body& b : bodies)
        if (b.driven)
            sum += b.force;
    for (const Rod& r : rods)
        for (const Hold& h : r.holds)
            if (h.onCrosshead)
                sum -= h.reaction;
    return sum;
}

void refreshRod(Rod& rod) {
    SC_ASSERT(rod.q.size() == rod.model.dofs() && rod.v.size() == rod.model.dofs(), "state sizes are the rod's");
    rod.kin.evaluate(rod.model, rod.q);
    rod::evaluateGauss(rod.model, rod.kin, rod.gauss);
    rod.leastBending = rod::bendingEnergy(rod.model, rod.q);
    rod::velocityField(rod.model, rod.kin, rod.gauss, rod.v, rod.u);
    rod.speed = 0.0;
    for (const Vec2& u : rod.u)
        rod.speed = std::max(rod.speed, u.norm());
    SC_ASSERT(rod.u.size() == rod.gauss.mass.size(), "one velocity a Gauss point");
}

namespace {

double gravityPotential(const World& world, const Rod& rod) {
    return -rod.model.mass() * world.gravity.dot(rod::massCentre(rod.kin, rod.gauss));
}

/// By its effects, J.
double storedIn(const Rod& rod) {
    double sum = 0.0;
    for (const effects::EffectEnergy& e : rod.effects.energies)
        sum += e.stored;
    return sum;
}

void book(World& world, const Rod& rod, double sign) {
    // A rod that somebody spoilt takes what it owns out of the world, but must not take the energy balance along.
    const auto number = [](double energy) { return std::isfinite(energy) ? energy : 0.0; };
    const double kinetic = number(rod::kineticEnergy(rod.gauss, rod.u));
    const double bending = number(rod::bendingEnergy(rod.model, rod.q));
    const double gravity = number(gravityPotential(world, rod));
    world.energyBalance.kinetic += sign * kinetic;
    world.energyBalance.bending += sign * bending;
    world.energyBalance.gravity += sign * gravity;
    world.energyBalance.added += sign * (kinetic + bending + gravity);
    const double held = storedIn(rod);
    if (held != 0.0) {
        world.energyBalance.effects += sign * held;
        world.energyBalance.added += sign * held;
    }
}

/// Detection's ids leave 20 bits for a rod: when they are used up, keys of rods that are gone come again.
std::uint32_t freeKey(World& world) {
    constexpr std::uint32_t limit = 1U << 20U;
    if (world.nextKey < limit)
        return world.nextKey++;
    std::vector<std::uint32_t> used;
    for (const Rod& r : world.rods)
        used.push_back(r.key);
    std::sort(used.begin(), used.end());
    std::uint32_t key = 1;
    for (const std::uint32_t u : used)
        if (u == key)
            ++key;
    SC_ASSERT(key < limit, "fewer rods than keys");
    return key;
}

/// Drops what is remembered about contacts of rod `key`.
void forgetContacts(World& world, std::uint32_t key) {
    const auto of = [key](const ContactImpulse& c) { return contact::concernsRod(c.id, key); };
    std::erase_if(world.impulses, of);
    std::erase_if(world.sleepingImpulses, of);
    for (Rod& rod : world.rods)
        if (rod.key == key)
            rod.passing.clear();
    world.range.clear();
    world.candidates.clear();
}

} // namespace

namespace {

/// What the effects on a rod hold at its present configuration.
void refreshEffects(Rod& rod) {
    if (rod.effects.material.on())
        effects::storedEnergy(rod.model, rod.effects.material, rod.q, rod.effects.energies);
    if (rod.effects.drag.on())
        rod.effects.energies[static_cast<std::size_t>(effects::Key::PlanarDrag)].stored =
            effects::storedEnergy(rod.effects.drag);
}

} // namespace

void setEffects(World& world, std::size_t index, const effects::Model& model) {
    wake(world, index);
    Rod& rod = world.rods[index];
    const double before = storedIn(rod);
    for (std::size_t k = 0; k < effects::kKeys; ++k)
        world.effectsGone[k].dissipated += rod.effects.energies[k].dissipated;
    if (model.contact.adhesion != rod.effects.adhesion.model)
        world.range.clear(); // candidates reach as far as surfaces attract
    rod.effects = effects::replaceRodEffects(rod.model, model, rod.effects);
    refreshEffects(rod);
    // Only the difference: what does not change must not change the last digit of a sum.
    if (const double change = storedIn(rod) - before; change != 0.0) {
        world.energyBalance.effects += change;
        world.energyBalance.added += change;
    }
}

void setEffectSettings(World& world, std::size_t index, std::vector<effects::Setting> settings) {
    if (settings == world.rods[index].effects.settings)
        return;
    setEffects(world, index, effects::modelFor(settings, "all"));
    world.rods[index].effects.settings = std::move(settings);
}

void restEffects(World& world) {
    for (Rod& rod : world.rods) {
        book(world, rod, -1.0);
        effects::applyLongRest(rod.effects);
        refreshEffects(rod);
        book(world, rod, 1.0);
    }
}

bool comeToRest(World& world, effects::ViscousMoments viscous, const std::function<bool()>& settle) {
    std::vector<effects::MaterialModel> models;
    for (Rod& rod : world.rods) {
        effects::MaterialModel& model = rod.effects.material.model;
        // A rest that is continued from a saved state finds a changed model; settings are as they were.
        models.push_back(rod.effects.settings.empty() ? model
                                                      : effects::modelFor(rod.effects.settings, "all").material);
        model = effects::whileResting(models.back(), viscous);
    }
    const bool done = settle();
    for (std::size_t i = 0; i < models.size(); ++i)
        world.rods[i].effects.material.model = std::move(models[i]);
    if (viscous == effects::ViscousMoments::Gone) {
        restEffects(world);
        return done;
    }
    for (Rod& rod : world.rods) {
        book(world, rod, -1.0);
        rod.effects.material.age = 0.0;
        effects::applyLongRest(rod.effects.surface);
        refreshEffects(rod);
        book(world, rod, 1.0);
    }
    return done;
}

effects::EffectEnergies effectEnergies(const World& world) {
    effects::EffectEnergies sum = world.effectsGone;
    for (const Rod& rod : world.rods)
        for (std::size_t k = 0; k < effects::kKeys; ++k) {
            sum[k].stored += rod.effects.energies[k].stored;
            sum[k].dissipated += rod.effects.energies[k].dissipated;
        }
    return sum;
}

int rodIndex(const World& world, std::uint32_t key) {
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (world.rods[i].key == key)
            return static_cast<int>(i);
    return -1;
}

double lengthOf(const Rod& rod, double given) {
    return given > 0.0 ? given : rod.model.definition().thickness;
}

double lengthOf(const World& world, double given, const contact::Candidate& c) {
    const double a = lengthOf(world.rods[static_cast<std::size_t>(c.a.rod)], given);
    return c.b.rod < 0 ? a : std::min(a, lengthOf(world.rods[static_cast<std::size_t>(c.b.rod)], given));
}

double thinnest(const World& world) {
    double h = std::numeric_limits<double>::infinity();
    for (const Rod& r : world.rods)
        h = std::min(h, r.model.definition().thickness);
    return h;
}

double impulseScale(const World& world) {
    constexpr double kRadius = 0.0192, kThickness = 0.0005, kWidth = 0.010; // of the paper's shell, m
    constexpr double kStiffness = 2.2e9 * kWidth * kThickness * kThickness * kThickness / 12.0 / kRadius; // N m
    constexpr double kWeight = 1270.0 * kWidth * kThickness * kRadius * 9.81 * kRadius;                   // N m
    const double gravity = world.gravity.norm();
    double least = std::numeric_limits<double>::infinity();
    for (const Rod& r : world.rods) {
        const rod::RodDefinition& d = r.model.definition();
        const double radius = r.model.meanRadius();
        least = std::min(least, d.bendingModulus / radius / kStiffness);
        if (gravity > 0.0)
            least = std::min(least, d.linearMass * radius * gravity * radius / kWeight);
    }
    return std::isfinite(least) ? least : 1.0;
}

Settings gameSettings() {
    Settings s;
    s.dtMax = 1.0 / 30.0;
    s.localError = 1.0;
    s.motionLimit = 5.0;
    s.relinearise = 0.01;
    s.maxIterations = 2;
    s.contact.tolerance = 1e-6;
    s.sweepAbove = 500;
    s.cappedSweeps = 40;
    s.acceptUnconverged = true;
    s.cull = true;
    s.dampingRatio = 0.05;
    s.freeError = 0.05;
    s.freeLeast = 1e-4;
    s.freeSteps = 8;
    s.secondOrderRods = 8;
    s.frameWork = 8333; // half a frame of 60 Hz
    s.giveUpEarly = true;
    s.crush = CrushPolicy::Stop;
    return s;
}

const Body* findBody(const std::vector<Body>& bodies, BodyId id) {
    const auto it =
        std::lower_bound(bodies.begin(), bodies.end(), id, [](const Body& b, BodyId want) { return b.id < want; });
    return it != bodies.end() && it->id == id ? &*it : nullptr;
}

int bodyIndex(const World& world, BodyId id) {
    const Body* body = findBody(world.bodies, id);
    return body != nullptr ? static_cast<int>(body - world.bodies.data()) : -1;
}

std::size_t addRod(World& world, const rod::RodDefinition& definition, const Eigen::VectorXd& q,
                   const Eigen::VectorXd& v, double mu) {
    SC_ASSERT(q.size() == v.size(), "one velocity for each coordinate");
    Rod rod{rod::RodModel(definition), q, v, q, {}, {}, mu, freeKey(world), 1, 0xffff, false, 0.0, {}, {}, {}, {}};
    refreshRod(rod);
    book(world, rod, 1.0);
    world.rods.push_back(std::move(rod));
    world.range.clear();
    return world.rods.size() - 1;
}

void removeRod(World& world, std::size_t index) {
    wake(world, index);
    SC_ASSERT(index < world.rods.size(), "a rod of the world");
    const std::uint32_t key = world.rods[index].key;
    book(world, world.rods[index], -1.0);
    for (std::size_t k = 0; k < effects::kKeys; ++k)
        world.effectsGone[k].dissipated += world.rods[index].effects.energies[k].dissipated;
    world.rods.erase(world.rods.begin() + static_cast<std::ptrdiff_t>(index));
    std::erase_if(world.links,
                  [key](const Link& l) { return l.rodA == key || (l.end == LinkEnd::Rod && l.rodB == key); });
    std::erase_if(world.overlaps, [key](const Overlap& o) { return o.rodA == key || o.rodB == key; });
    forgetContacts(world, key);
}

void changeRod(World& world, std::size_t index, const rod::RodDefinition& definition) {
    wake(world, index);
    Rod& rod = world.rods[index];
    book(world, rod, -1.0);
    rod.model = rod::RodModel(definition);
    SC_ASSERT(rod.q.size() == rod.model.dofs(), "the number of elements stays");
    const std::vector<Vec2> u = rod.u;
    refreshRod(rod);
    rod.u = u;                       // the motion stays what it was, to the last digit
    if (rod.effects.material.on()) { // the same laws, shares of the new modulus
        effects::Material& m = rod.effects.material;
        for (std::size_t k = 0; k < m.cumulativeSections.size(); ++k)
            m.cumulativeSections[k] = effects::sections(rod.model, m.model.profiles, k);
    }
    refreshEffects(rod);
    book(world, rod, 1.0);
    world.range.clear();
}

void placeRod(World& world, std::size_t index, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    wake(world, index);
    Rod& rod = world.rods[index];
    book(world, rod, -1.0);
    SC_ASSERT(q.size() == rod.model.dofs() && v.size() == q.size(), "state sizes are the rod's");
    const bool moved = rod.q != q;
    rod.q = rod.lastAccepted = q;
    rod.v = v;
    refreshRod(rod);
    refreshEffects(rod);
    book(world, rod, 1.0);
    if (moved)
        forgetContacts(world, rod.key);
    world.range.clear();
}

void moveRod(World& world, std::size_t index, const Vec2& middle, double angle) {
    wake(world, index);
    Rod& rod = world.rods[index];
    book(world, rod, -1.0);
    const rod::RodModel& m = rod.model;
    const double turn = angle - rod.q[m.dofTheta()], c = math::cos(turn), s = math::sin(turn);
    const auto turned = [&](const Vec2& x) { return Vec2(c * x.x() - s * x.y(), s * x.x() + c * x.y()); };
    rod.q[m.dofX()] = middle.x();
    rod.q[m.dofY()] = middle.y();
    rod.q[m.dofTheta()] = angle;
    const Vec2 velocity = turned({rod.v[m.dofX()], rod.v[m.dofY()]});
    rod.v[m.dofX()] = velocity.x();
    rod.v[m.dofY()] = velocity.y();
    rod.lastAccepted = rod.q;
    std::vector<Vec2> u = rod.u;
    std::transform(u.begin(), u.end(), u.begin(), turned);
    refreshRod(rod);
    rod.u = u;               // carried momentum is more than J v knows
    rod.quarantined = false; // its last good shape, at rest, in another place: it may try again
    book(world, rod, 1.0);
    forgetContacts(world, rod.key);
}

void carryRod(World& world, std::size_t index, const BodyState& from, const BodyState& to) {
    Rod& rod = world.rods[index];
    const rod::RodModel& m = rod.model;
    const double turn = to.angle - from.angle, c = math::cos(turn), s = math::sin(turn);
    const auto turned = [&](const Vec2& x) { return Vec2(c * x.x() - s * x.y(), s * x.x() + c * x.y()); };
    const bool quarantined = rod.quarantined;
    const Vec2 arm = turned(Vec2(rod.q[m.dofX()], rod.q[m.dofY()]) - from.centre);
    moveRod(world, index, to.centre + arm, rod.q[m.dofTheta()] + turn);
    rod.quarantined = quarantined;
    book(world, rod, -1.0);
    // Its velocity relative to the body has turned. That of the body has not, or is another one.
    const double spin = to.spin - from.spin;
    const Vec2 shift = to.velocity - turned(from.velocity) + spin * rod::perp(arm);
    Eigen::VectorXd change = Eigen::VectorXd::Zero(m.dofs());
    change[m.dofX()] = shift.x();
    change[m.dofY()] = shift.y();
    change[m.dofTheta()] = spin;
    std::vector<Vec2> du;
    rod::velocityField(m, rod.kin, rod.gauss, change, du);
    rod.v += change;
    rod.speed = 0.0;
    for (std::size_t g = 0; g < du.size(); ++g) {
        rod.u[g] += du[g];
        rod.speed = std::max(rod.speed, rod.u[g].norm());
    }
    book(world, rod, 1.0);
}

void applyImpulse(World& world, std::size_t index, double s, const Vec2& impulse, double angularImpulse) {
    wake(world, index);
    Rod& rod = world.rods[index];
    SC_ASSERT(s >= 0.0 && s <= rod.model.definition().length, "a point of the rod");
    const rod::MaterialPoint at = rod::locate(rod.model, s);
    const Eigen::Index n = rod.model.dofs();
    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, n);
    Eigen::RowVectorXd turn(n);
    rod.kin.pointRows(rod.model, at, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), rows);
    rod.kin.angleRow(rod.model, at, turn);
    Eigen::MatrixXd mass;
    rod::massMatrix(rod.model, rod.kin, rod.gauss, mass);
    const Eigen::VectorXd change = mass.llt().solve(rows.transpose() * impulse + angularImpulse * turn.transpose());
    std::vector<Vec2> du;
    rod::velocityField(rod.model, rod.kin, rod.gauss, change, du);
    const double before = rod::kineticEnergy(rod.gauss, rod.u);
    for (std::size_t g = 0; g < du.size(); ++g) {
        rod.u[g] += du[g];
        rod.speed = std::max(rod.speed, rod.u[g].norm());
    }
    rod.v += change;
    const double gained = rod::kineticEnergy(rod.gauss, rod.u) - before;
    world.energyBalance.kinetic += gained;
    world.energyBalance.work += gained;
    world.range.clear();
}

void toCurve(const Rod& rod, const rod::Kinematics& kin, contact::RodCurve& curve) {
    curve.arcs = kin.arcs();
    const int N = rod.model.elements();
    SC_ASSERT(curve.arcs.size() == static_cast<std::size_t>(N), "one arc an element");
    curve.nodeS.resize(static_cast<std::size_t>(N) + 1);
    for (int i = 0; i <= N; ++i)
        curve.nodeS[static_cast<std::size_t>(i)] = rod.model.nodeS(i);
    curve.halfThickness = 0.5 * rod.model.definition().thickness;
    curve.midS = rod.model.midS();
    curve.closed = rod.model.definition().closed;
    curve.key = rod.key;
    curve.category = rod.quarantined ? 0u : rod.category;
    curve.mask = rod.quarantined ? 0u : rod.mask;
    curve.group = rod.quarantined ? 0 : rod.group;
    curve.resting = rod.asleep();
}

contact::Outline placed(const BodyOutline& piece, const Vec2& centre, double angle) {
    contact::Outline out;
    place(piece, centre, angle, out);
    return out;
}

void place(const BodyOutline& piece, const Vec2& centre, double angle, contact::Outline& out) {
    out = piece.local;
    const double c = math::cos(angle), s = math::sin(angle);
    const auto put = [&](Vec2& p) { p = centre + Vec2(c * p.x() - s * p.y(), s * p.x() + c * p.y()); };
    for (Vec2& p : out.points)
        put(p);
    put(out.neighbourStart);
    put(out.neighbourEnd);
    const auto turn = [&](Vec2& d) { d = Vec2(c * d.x() - s * d.y(), s * d.x() + c * d.y()); };
    for (contact::VertexSeam& v : out.seams.vertices) {
        turn(v.c1);
        turn(v.c2);
    }
}

} // namespace supercircle::step
