#include "plugin/cli/bench_peer.h"

#include "bridge/lab_world.h"
#include "plugin/cli/verbs.h"
#include "plugin/player/dropper.h"
#include "plugin/record/files.h"
#include "supercircle/step/stepper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>

namespace supercircle::cli {

namespace {

constexpr double kFrame = 1.0 / 60.0; ///< s
constexpr double kRadius = 1.0;       ///< m
constexpr double kMass = 2.0;         ///< kg
constexpr double kMu = 0.35;          ///< in the pile
constexpr double kSpeed = 0.25;       ///< m/s, of the machine
constexpr double kWidth = 10.4;       ///< m, of the box: the paper's 200 mm for R = 19.2 mm
constexpr double kWeigh = 1e7;        ///< kg, of the peer's cylinder: free, and so heavy that its speed tells the force

double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

ShellDef onCylinder(const PeerCylinder& which, int elements, double gap) {
    ShellDef d = scaledShell(kRadius, kMass, which.phi_bar);
    const double phi = M_PI * d.phi_bar, reach = kRadius + gap;
    const double centre =
        -kRadius * std::cos(phi) + std::sqrt(reach * reach - std::pow(kRadius * std::sin(phi), 2)); // tips touch
    d.position = {0.0, centre + kRadius};
    d.angle = M_PI;
    d.mu = which.mu;
    d.elements = elements;
    return d;
}

/// How far the machine pushes: 98 % of the way until the shell is seated.
double travelOf(const ShellDef& d) {
    return 0.98 * (d.position.y - kRadius);
}

step::RigidWorldDefinition cylinderWorld(double mu, double mass) {
    step::RigidWorldDefinition w;
    w.gravity.setZero();
    step::BodyDefinition body;
    body.type = mass > 0.0 ? step::BodyType::Dynamic : step::BodyType::Static;
    body.allowSleep = false;
    step::FixtureDefinition disc;
    disc.shape = step::ShapeKind::Circle;
    disc.radius = kRadius - 0.5 * scaledShell(kRadius, kMass).thickness;
    disc.friction = mu;
    body.fixtures.push_back(disc);
    if (mass > 0.0)
        body.massData = step::MassData{mass, Vec2::Zero(), 0.5 * mass * disc.radius * disc.radius};
    w.bodies.push_back(body);
    return w;
}

step::RigidWorldDefinition boxWorld() {
    step::RigidWorldDefinition w;
    step::BodyDefinition body;
    const double side = 0.5 * kWidth, out = side + 3.0, high = 80.0;
    for (const auto& [x0, x1, y0, y1] :
         {std::array{-out, out, -3.0, 0.0}, std::array{-out, -side, -3.0, high}, std::array{side, out, -3.0, high}}) {
        step::FixtureDefinition wall;
        wall.vertices = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
        wall.friction = kMu;
        body.fixtures.push_back(wall);
    }
    w.bodies.push_back(body);
    return w;
}

scene::Drop dropOf(int shells) {
    scene::Drop drop;
    drop.shell = scaledShell(kRadius, kMass);
    drop.shell.mu = kMu;
    drop.count = drop.together = shells;
    drop.x_min = -0.5 * kWidth + kRadius + drop.shell.thickness;
    drop.x_max = -drop.x_min;
    drop.clearance = 0.5 * kRadius;
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

std::vector<contact::Curve> curvesOf(const step::World& world) {
    std::vector<contact::Curve> out(world.rods.size());
    for (std::size_t i = 0; i < out.size(); ++i)
        step::toCurve(world.rods[i], world.rods[i].kin, out[i]);
    return out;
}

/// Largest force that lasted: of the running medians of five frames' mean forces. One frame's spike, when a shell slaps
/// on the cylinder after a snap or a joint trembles, is no reading of a testing machine.
class Peak {
public:
    explicit Peak(double unit) : unit_(unit) {}
    void add(double force) {
        last_[count_++ % last_.size()] = force / unit_;
        auto sorted = last_;
        std::sort(sorted.begin(), sorted.end());
        if (count_ >= last_.size())
            highest_ = std::max(highest_, sorted[sorted.size() / 2]);
    }
    [[nodiscard]] double highest() const { return highest_; }

private:
    double unit_;
    std::array<double, 5> last_{};
    std::size_t count_ = 0;
    double highest_ = 0.0;
};

/// Sum of the arcs' lengths against the rod's length: how far a node is from where the arc before it ends.
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

/// Plays frames until `seconds` are through; `frame` makes one and says how long it was, s, or 0 when it failed.
template <class Frame>
void playFrames(PeerRun& run, double seconds, Frame&& frame) {
    const double start = cpuSeconds();
    double time = 0.0;
    while (time < seconds - 1e-9 && !interrupted) {
        const double begin = cpuSeconds(), advanced = frame(std::min(kFrame, seconds - time));
        run.frames.push_back(1e3 * (cpuSeconds() - begin));
        if (advanced <= 0.0)
            break;
        time += advanced;
    }
    run.cpu = (cpuSeconds() - start) / std::max(time, kFrame);
}

/// One frame; `impulse` gets what the machine felt, N s.
double ourFrame(Shells& shells, step::HostWorld& host, double dt, double* impulse = nullptr) {
    const FrameReport report = shells.pre_step(dt, [&] {
        if (impulse != nullptr)
            *impulse += shells.machine_force().y * shells.stepper().lastDt();
        return false;
    });
    if (report.advanced > 0.0)
        host.step(report.advanced);
    shells.post_step();
    return report.failure.empty() ? report.advanced : 0.0;
}

const char* nameOf(Quality q) {
    return q == Quality::Game ? "game" : "laboratory";
}

std::string ourName(const char* scene, int arcs, Quality q) {
    return std::string("peer/") + scene + "/ours" + std::to_string(arcs) + "/" + nameOf(q);
}

std::string peerName(const char* scene, const PeerSettings& s, int boxes) {
    return std::string("peer/") + scene + "/welded" + std::to_string(boxes) + (s.soft ? "/" : "_rigid/") +
           std::to_string(s.substeps);
}

} // namespace

PeerRun ourCylinder(const PeerCylinder& which, Quality quality, int elements) {
    PeerRun run;
    run.name = ourName(which.name, elements, quality);
    std::string error;
    std::shared_ptr<step::HostWorld> host = bridge::makeWorld(cylinderWorld(which.mu, 0.0), error);
    Shells shells(host);
    shells.set_quality(quality);
    if (quality == Quality::Laboratory) // as the laboratory paces its machine
        shells.stepper().settings().dtMax = kRadius / 500.0 / kSpeed;
    const ShellDef d = onCylinder(which, elements, 1e-6);
    const auto shell = shells.create(d);
    shells.hold(*shell, 0.5, HoldKind::Clamp, true);
    shells.set_machine_velocity({0.0, -kSpeed});
    Peak peak(which.theory * bendingModulus(d) / (kRadius * kRadius));
    playFrames(run, travelOf(d) / kSpeed, [&](double dt) {
        double impulse = 0.0;
        const double advanced = ourFrame(shells, *host, dt, &impulse);
        peak.add(impulse / std::max(advanced, 1e-9));
        run.stretch = std::max(run.stretch, stretchOf(shells.world()));
        return advanced;
    });
    run.peak = peak.highest();
    run.curves = curvesOf(shells.world());
    run.crossings = crossedPairs(run.curves, solids(*host, 1));
    return run;
}

PeerRun peerCylinder(const PeerCylinder& which, const PeerSettings& settings, int boxes) {
    PeerRun run;
    run.name = peerName(which.name, settings, boxes);
    const ShellDef d = onCylinder(which, boxes, 0.01 * kRadius); // corners of boxes stand out: start a little higher
    Shells posed(nullptr);
    WeldedShells welded(cylinderWorld(which.mu, kWeigh), settings);
    welded.add(d, *posed.pose(*posed.create(d)), true);
    std::unique_ptr<step::HostWorld> host;
    if (const std::string error = welded.build(host); !error.empty()) {
        run.label = error;
        return run;
    }
    Peak peak(which.theory * bendingModulus(d) / (kRadius * kRadius));
    double before = 0.0;
    playFrames(run, travelOf(d) / kSpeed, [&](double dt) {
        const double part = dt / settings.substeps;
        step::BodyState s;
        for (int i = 0; i < settings.substeps; ++i) {
            host->state(welded.heldBody(), s);
            host->drive(welded.heldBody(), s.centre, s.angle, {0.0, -kSpeed}, 0.0);
            host->step(part);
        }
        host->state(1, s);
        peak.add((before - s.velocity.y()) * kWeigh / dt);
        before = s.velocity.y();
        run.stretch = std::max(run.stretch, welded.stretch(*host));
        return dt;
    });
    run.peak = peak.highest();
    run.curves = welded.curves(*host);
    run.crossings = crossedPairs(run.curves, solids(*host, 1));
    return run;
}

PeerRun ourPile(Quality quality, int count, double seconds) {
    PeerRun run;
    run.name = ourName("pile", 15, quality);
    std::string error;
    std::shared_ptr<step::HostWorld> host = bridge::makeWorld(boxWorld(), error);
    Shells shells(host);
    shells.set_quality(quality);
    shells.stepper().settings().witness = true;
    player::Random random(1);
    std::vector<ShellHandle> made;
    player::dropBatch(shells, dropOf(count), count, random, made);
    playFrames(run, seconds, [&](double dt) {
        const double advanced = ourFrame(shells, *host, dt);
        run.stretch = std::max(run.stretch, stretchOf(shells.world()));
        return advanced;
    });
    run.curves = curvesOf(shells.world());
    run.crossings = crossedPairs(run.curves, solids(*host, 1));
    return run;
}

PeerRun peerPile(const PeerSettings& settings, int count, double seconds) {
    PeerRun run;
    run.name = peerName("pile", settings, 15);
    const scene::Drop drop = dropOf(count);
    Shells posed(nullptr);
    player::Random random(1);
    std::vector<ShellHandle> made;
    player::dropBatch(posed, drop, count, random, made);
    WeldedShells welded(boxWorld(), settings);
    for (const ShellHandle shell : made)
        welded.add(drop.shell, *posed.pose(shell), false);
    std::unique_ptr<step::HostWorld> host;
    if (const std::string error = welded.build(host); !error.empty()) {
        run.label = error;
        return run;
    }
    playFrames(run, seconds, [&](double dt) {
        for (int i = 0; i < settings.substeps; ++i)
            host->step(dt / settings.substeps);
        run.stretch = std::max(run.stretch, welded.stretch(*host));
        return dt;
    });
    run.curves = welded.curves(*host);
    run.crossings = crossedPairs(run.curves, solids(*host, 1));
    return run;
}

namespace {

constexpr int kPileShells = 30;
constexpr double kPileSeconds = 5.0;
constexpr int kSubsteps[] = {1, 16, 64, 256};

struct Job {
    std::string name;
    std::function<PeerRun()> run;
};

std::vector<Job> jobs() {
    std::vector<Job> all;
    const auto add = [&all](std::string name, std::function<PeerRun()> run) {
        all.push_back({std::move(name), std::move(run)});
    };
    for (const PeerCylinder& c : kCylinders)
        for (const int arcs : {15, 31}) {
            for (const Quality q : {Quality::Game, Quality::Laboratory})
                add(ourName(c.name, arcs, q), [c, q, arcs] { return ourCylinder(c, q, arcs); });
            for (const int n : kSubsteps) {
                PeerSettings s;
                s.substeps = n;
                add(peerName(c.name, s, arcs), [c, s, arcs] { return peerCylinder(c, s, arcs); });
            }
        }
    for (const Quality q : {Quality::Game, Quality::Laboratory})
        add(ourName("pile", 15, q), [q] { return ourPile(q, kPileShells, kPileSeconds); });
    for (const bool soft : {true, false})
        for (const int n : kSubsteps) {
            PeerSettings s;
            s.substeps = n;
            s.soft = soft;
            if (soft || n <= 16)
                add(peerName("pile", s, 15), [s] { return peerPile(s, kPileShells, kPileSeconds); });
        }
    return all;
}

/// One row of the README's table.
void printTable(const std::vector<PeerRun>& runs) {
    std::printf("\n| | stretch | crossed pairs | peak / theory | CPU s per s |\n|---|---:|---:|---:|---:|\n");
    for (const PeerRun& r : runs) {
        char peak[32] = "-";
        if (r.peak > 0.0)
            std::snprintf(peak, sizeof peak, "%.3f", r.peak);
        std::printf("| %s | %.1e | %d | %s | %.3f |\n", r.name.c_str() + 5, r.stretch, r.crossings, peak, r.cpu);
    }
}

std::string writePicture(const std::vector<PeerRun>& runs, const std::string& json) {
    const auto find = [&runs](const char* name) {
        return std::find_if(runs.begin(), runs.end(), [name](const PeerRun& r) { return r.name == name; });
    };
    const auto ours = find("peer/pile/ours15/game"), peer = find("peer/pile/welded15/1"),
               tuned = find("peer/pile/welded15/64");
    if (ours == runs.end() || peer == runs.end() || tuned == runs.end())
        return {};
    std::string error;
    const std::string png = peerPicture(*ours, *peer, *tuned, error);
    if (!error.empty())
        return error;
    const std::filesystem::path folder = json.empty() ? "out" : std::filesystem::path(json).parent_path();
    std::printf("picture: %s\n", (folder / "peer.png").c_str());
    return record::writeAtomically(folder.string(), {{"peer.png", png}});
}

} // namespace

void addPeerBenchmarks(std::vector<Benchmark>& all) {
    Benchmark b;
    b.prefix = "peer";
    for (const Job& job : jobs())
        b.names.push_back(job.name);
    const auto runs = std::make_shared<std::vector<PeerRun>>();
    b.measure = [runs](const auto& wanted, const auto& done) {
        for (const Job& job : jobs()) {
            if (!wanted(job.name))
                continue;
            PeerRun run = job.run();
            if (!run.label.empty())
                return job.name + ": " + run.label;
            Measurement m = summarise(run.name, run.frames);
            m.more = {{"cpu_s_per_s", run.cpu}, {"stretch", run.stretch}, {"crossed_pairs", run.crossings}};
            if (run.peak > 0.0)
                m.more.emplace_back("peak_over_theory", run.peak);
            runs->push_back(std::move(run));
            done(std::move(m));
        }
        return std::string();
    };
    b.finish = [runs](const std::vector<Measurement>&, const std::string& json) {
        if (runs->empty())
            return std::string();
        printTable(*runs);
        return writePicture(*runs, json);
    };
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
