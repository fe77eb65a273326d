#include "plugin/bench/bench_game_scenes.h"

#include "bridge/box2d/lab_world.h"
#include "plugin/cli/subcommands.h"
#include "plugin/scene/player/dropper.h"
#include "supercircle/contact/crossing.h"
#include "supercircle/step/stepper.h"
#include "supercircle/support/order_statistics.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <set>

namespace supercircle::cli {

double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}
double wallSeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

const char* nameOf(Quality q) {
    return q == Quality::Game ? "game" : "laboratory";
}

void SustainedPeak::add(double force) {
    last_[count_++ % last_.size()] = force / unit_;
    if (count_ >= last_.size())
        highest_ = std::max(highest_, upperMedian(last_));
}

ShellDef onCylinder(const CylinderCase& which, int elements, double gap) {
    ShellDef d = scaled_shell(kGameRadius, kGameMass, which.phi_bar);
    const double phi = M_PI * d.phi_bar, reach = kGameRadius + gap;
    const double centre = -kGameRadius * std::cos(phi) +
                          std::sqrt(reach * reach - std::pow(kGameRadius * std::sin(phi), 2)); // tips touch
    d.position = {0.0, centre + kGameRadius};
    d.angle = M_PI;
    d.mu = which.mu;
    d.elements = elements;
    return d;
}

/// Crosshead travel: 98 % of that to the seated position.
double travelOf(const ShellDef& d) {
    return 0.98 * (d.position.y - kGameRadius);
}

step::RigidWorldDefinition cylinderWorld(double mu, double mass) {
    step::RigidWorldDefinition w;
    w.gravity.setZero();
    step::BodyDefinition body;
    body.type = mass > 0.0 ? step::BodyType::Dynamic : step::BodyType::Static;
    body.allowSleep = false;
    step::FixtureDefinition disc;
    disc.shape = step::ShapeKind::Circle;
    disc.radius = kGameRadius - 0.5 * scaled_shell(kGameRadius, kGameMass).thickness;
    disc.friction = mu;
    body.fixtures.push_back(disc);
    if (mass > 0.0)
        body.massData = step::MassData{mass, Vec2::Zero(), 0.5 * mass * disc.radius * disc.radius};
    w.bodies.push_back(body);
    return w;
}

step::RigidWorldDefinition boxWorld(const PileCase& pile) {
    step::RigidWorldDefinition w;
    step::BodyDefinition body;
    const double side = 0.5 * pile.width, out = side + 3.0, high = 80.0;
    for (const auto& [x0, x1, y0, y1] :
         {std::array{-out, out, -3.0, 0.0}, std::array{-out, -side, -3.0, high}, std::array{side, out, -3.0, high}}) {
        step::FixtureDefinition wall;
        wall.vertices = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
        wall.friction = pile.mu;
        body.fixtures.push_back(wall);
    }
    w.bodies.push_back(body);
    return w;
}

scene::Drop dropOf(const PileCase& pile) {
    scene::Drop drop;
    drop.shell = scaled_shell(kGameRadius, kGameMass);
    drop.shell.mu = pile.mu;
    drop.shell.elements = pile.elements;
    drop.count = pile.shells;
    drop.batch_size = pile.batchSize;
    drop.x_min = -0.5 * pile.width + kGameRadius + drop.shell.thickness;
    drop.x_max = -drop.x_min;
    drop.clearance = 0.5 * kGameRadius;
    return drop;
}

std::vector<contact::Outline> solids(const step::HostWorld& host, std::size_t bodies) {
    std::vector<step::BodyOutline> all;
    host.everything(all);
    std::vector<contact::Outline> out;
    for (const step::BodyOutline& o : all) {
        step::BodyState s;
        if (o.body <= bodies && host.state(o.body, s)) {
            out.push_back(step::placed(o, s.centre, s.angle));
            out.back().key = static_cast<std::uint32_t>(out.size());
        }
    }
    return out;
}

int crossedPairs(const std::vector<contact::RodCurve>& curves, const std::vector<contact::Outline>& outlines) {
    std::vector<contact::Crossing> found;
    contact::findCrossings(curves, outlines, found);
    std::set<std::pair<int, int>> pairs;
    for (const contact::Crossing& c : found)
        pairs.insert({std::min(c.rodA, c.rodB < 0 ? c.rodA : c.rodB), c.rodB < 0 ? -1 : std::max(c.rodA, c.rodB)});
    return static_cast<int>(pairs.size());
}

void runFrames(GameRun& run, double seconds, const std::function<double(double)>& frame) {
    const double start = cpuSeconds();
    double time = 0.0;
    while (time < seconds - 1e-9 && !interrupted) {
        const double begin = wallSeconds(), advanced = frame(std::min(kGameFrame, seconds - time));
        run.frames.push_back(1e3 * (wallSeconds() - begin));
        if (advanced <= 0.0)
            break;
        time += advanced;
    }
    run.cpu = (cpuSeconds() - start) / std::max(time, kGameFrame);
}

namespace {

std::vector<contact::RodCurve> curvesOf(const step::World& world) {
    std::vector<contact::RodCurve> out(world.rods.size());
    for (std::size_t i = 0; i < out.size(); ++i)
        step::toCurve(world.rods[i], world.rods[i].kin, out[i]);
    return out;
}

/// Relative stretch: distances of the nodes from the ends of the arcs before them, and errors of arc length.
double stretchOf(const step::World& world) {
    double worst = 0.0;
    for (const step::Rod& rod : world.rods) {
        double apart = 0.0;
        for (int i = 0; i < rod.model.elements(); ++i) {
            const rod::Arc& arc = rod.kin.arcs()[static_cast<std::size_t>(i)];
            apart += (arc.pointAt(arc.length) - rod.kin.node(i + 1)).norm() +
                     std::abs(arc.length - rod.model.elementLength(i));
        }
        worst = std::max(worst, apart / rod.model.definition().length);
    }
    return worst;
}

/// One frame; `impulse` receives the impulse on the crosshead, N s.
double ourFrame(GameRun& run, Shells& shells, step::HostWorld& host, double dt, double* impulse = nullptr) {
    const FrameReport report = shells.pre_step(dt, [&] {
        if (impulse != nullptr)
            *impulse += shells.crosshead_force().y * shells.stepper().lastDt();
        return false;
    });
    if (report.advanced > 0.0)
        host.step(report.advanced);
    shells.post_step().or_fail();
    run.budgetExhausted += report.budget_exhausted;
    run.failure = report.failure;
    run.stretch = std::max(run.stretch, stretchOf(shells.world()));
    return report.failure.empty() ? report.advanced : 0.0;
}

} // namespace

GameRun ourCylinder(const CylinderCase& which, Quality quality, int elements) {
    GameRun run;
    std::string error;
    std::shared_ptr<step::HostWorld> host = bridge::makeWorld(cylinderWorld(which.mu, 0.0), error);
    Shells shells(host);
    shells.set_quality(quality).or_fail();
    if (quality == Quality::Laboratory) // the step limit of a session
        shells.stepper().settings().dtMax = kGameRadius / 500.0 / kMachineSpeed;
    const ShellDef d = onCylinder(which, elements, 1e-6);
    const auto shell = shells.create(d);
    shells.create_hold(*shell, 0.5, HoldKind::Clamp, HoldBase::Moving).or_fail();
    shells.set_crosshead_velocity({0.0, -kMachineSpeed}).or_fail();
    SustainedPeak peak(which.theory * bending_modulus(d) / (kGameRadius * kGameRadius));
    runFrames(run, travelOf(d) / kMachineSpeed, [&](double dt) {
        double impulse = 0.0;
        const double advanced = ourFrame(run, shells, *host, dt, &impulse);
        run.force.push_back(impulse / std::max(advanced, 1e-9));
        peak.add(run.force.back());
        return advanced;
    });
    run.peak = peak.highest();
    run.curves = curvesOf(shells.world());
    run.crossings = crossedPairs(run.curves, solids(*host, 1));
    return run;
}

GameRun ourPile(const PileCase& pile, Quality quality) {
    GameRun run;
    std::string error;
    std::shared_ptr<step::HostWorld> host = bridge::makeWorld(boxWorld(pile), error);
    Shells shells(host);
    shells.set_quality(quality).or_fail();
    shells.stepper().settings().crossingCheck = true;
    shells.stepper().settings().threads = pile.threads;
    player::Random random(pile.seed);
    std::vector<ShellHandle> made;
    const scene::Drop drop = dropOf(pile);
    double next = 0.0;
    runFrames(run, pile.seconds, [&](double dt) {
        if (static_cast<int>(made.size()) < pile.shells && shells.time() >= next - 1e-9) {
            const int count = std::min(pile.batchSize, pile.shells - static_cast<int>(made.size()));
            run.failure = player::dropBatch(shells, drop, count, random, made).error();
            next = shells.time() + pile.every;
        }
        return run.failure.empty() ? ourFrame(run, shells, *host, dt) : 0.0;
    });
    run.curves = curvesOf(shells.world());
    run.crossings = crossedPairs(run.curves, solids(*host, 1)) + static_cast<int>(shells.world().counters.crossings);
    run.height = player::pileTop(shells.world());
    run.stored = shells.energy_balance().bending + shells.energy_balance().gravity;
    return run;
}

} // namespace supercircle::cli
