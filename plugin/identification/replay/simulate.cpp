// Cost and accuracy (measured on six noise-free recordings of another simulator, one core).
//
// | resolution | arcs | CPU a run | force against 121 arcs and finer steps, rms outside of jumps, share of the peak |
// |---|---|---|---|
// | coarse | 15 | 0.01 - 0.06 s | sliding shells 0.25 %, arch 0.4 %, strips 0.5 - 0.8 %, coiled shell (Type II) 2.1 % |
// | full | 31 | 0.05 - 0.3 s | sliding shells 0.04 - 0.06 %, arch 0.08 %, strips 0.1 - 0.2 %, coiled shell 0.45 % |
// | full | 61 | 0.15 - 1.2 s | 0.02 - 0.03 %, 0.04 %, 0.05 - 0.06 %, 0.09 % |
//
// Steps are limited by travel, not by time: quasi-static runs at different speeds are cut alike, and dwells take dtMax.
// Readings are interpolated linearly between steps: with the longest travel a of a step the error is a^2 F'' / 8, below
// 1e-5 of the peak outside of jumps. Within a jump (snap, slip-off, first touch of a strip) a sample may fall anywhere
// between the two forces.
//
// Extra physics (supercircle/effects) enters at its place: material, load and contact effects in the world and
// misalignment in the set-up (rig.cpp), compliance and play between the commanded motion and the head (class Player),
// drift, gain and delay between the trace and the readings.

#include "plugin/identification/replay/simulate.h"

#include "plugin/identification/replay/free_scene.h"
#include "plugin/identification/replay/rig.h"
#include "plugin/identification/replay/trace.h"
#include "supercircle/effects/play.h"
#include "supercircle/effects/sensor.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

namespace supercircle::replay {

namespace {

using experiment::Experiment;
using experiment::Run;
using rod::Vec2;

double cpuClock() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Rows of a trace and weights for linear interpolation at given times; times past the end are left out.
struct Weights {
    std::vector<std::size_t> row; ///< interpolate between row and row + 1
    std::vector<double> share;

    Weights(const std::vector<double>& trace, const std::vector<double>& at) {
        std::size_t i = 0;
        for (const double t : at) {
            if (trace.size() < 2 || t > trace.back() + 1e-9)
                return;
            while (i + 2 < trace.size() && trace[i + 1] < t)
                ++i;
            row.push_back(i);
            share.push_back(std::clamp((t - trace[i]) / std::max(trace[i + 1] - trace[i], 1e-300), 0.0, 1.0));
        }
    }
    template <class Value>
    [[nodiscard]] double at(std::size_t k, Value&& value) const {
        return (1.0 - share[k]) * value(row[k]) + share[k] * value(row[k] + 1);
    }
};

std::vector<double> evenTimes(const Run& run, double rate) {
    std::vector<double> times;
    const double span = run.driveTime.back() - run.driveTime.front();
    for (std::size_t i = 0; rate > 0.0 && static_cast<double>(i) / rate < span - 1e-9; ++i)
        times.push_back(run.driveTime.front() + static_cast<double>(i) / rate);
    return times;
}

/// Plays the commanded motion. With something soft in series the commanded motion is head plus give, d = x + c F, and
/// while the drive moves it is d that keeps time: the clock is read off d. That is implicit (stiff specimens do no
/// harm), and where a snap lets d jump back the clock stands still. The head's speed is that of the drive less what the
/// spring takes up, as found a twentieth of the leg before, so that what depends on rates sees the right ones.
///
/// Where the drive brakes and while it rests d is given and x follows: a part of what is missing, 1 / (1 + c K), with
/// the stiffness K of the specimen. Moved by all of it, a specimen that sticks (c K > 1) threw the head to and fro,
/// farther each time: an arch that was held by a machine of 1000 N/m lost a quarter of its force at once and never
/// relaxed. While the head follows, K is not what force over way shows (the force falls as the head goes on, because
/// the specimen relaxes): it is raised where a move went too far, and pieces of a rest are as short as what is missing
/// after each is small.
class Player {
    static constexpr double kBraking = 5e-3; ///< s, in which the drive comes to rest
    static constexpr double kSettle = 2e-4;  ///< s, see press()

public:
    Player(Rig& rig, const Experiment& e, const Run& run, double give, const effects::ApparatusModel& apparatus,
           const Options& options)
        : rig_(rig), e_(e), run_(run), give_(give + apparatus.compliance), apparatus_(apparatus), options_(options),
          clock_(run.driveTime.front()) {}

    Trace play() {
        const effects::Motion drive =
            effects::behindPlay({run_.driveTime, run_.driveDisplacement}, apparatus_.backlash);
        if (drive.displacement.front() != 0.0) // the head comes from displacement 0 to where the run starts
            rig_.move(drive.displacement.front(), 1.0, {});
        trace_.forces.push_back({clock_, rig_.force()});
        addMarkers(clock_);
        lastDisplacement_ = pressedAt_ = rig_.displacement();
        pressing_ = rig_.force();
        double late = 0.0; // of the leg before: it came to rest that much behind its end, s
        for (std::size_t i = 0; i < e_.specimens.size();
             ++i) { // ten times the Euler load of a rod clamped at both ends
            const double turn = 2.0 * M_PI / e_.specimens[i].length;
            impact_ = std::max(impact_, 10.0 * turn * turn * e_.specimens[i].bendingModulus.value);
        }
        for (std::size_t i = 1; i < drive.time.size() && rig_.failure().empty() && !stopped_; ++i) {
            const double t0 = drive.time[i - 1], t1 = drive.time[i];
            const double from = drive.displacement[i - 1], to = drive.displacement[i];
            const bool rests = i + 1 < drive.time.size() && drive.displacement[i + 1] == to && to != from;
            const double brake = rests ? std::min({kBraking, t1 - t0, drive.time[i + 1] - t1}) : 0.0;
            leg(t0 + late, t1 - 0.5 * brake, from, to - 0.5 * brake * (to - from) / (t1 - t0));
            late = 0.5 * brake;
            if (rests && rig_.failure().empty() && !stopped_)
                stop(t1, brake, to, (to - from) / (t1 - t0));
        }
        return std::move(trace_);
    }
    [[nodiscard]] bool stopped() const { return stopped_; }
    [[nodiscard]] double bendMost() const { return bendMost_; }

private:
    /// What the drive shows: the head and all that gives in series with it.
    [[nodiscard]] double position() const {
        return rig_.displacement() + give_ * pressing_ +
               0.5 * apparatus_.slack * pressing_ / std::hypot(pressing_, apparatus_.slackForce);
    }
    [[nodiscard]] bool rigid() const { return give_ <= 0.0 && apparatus_.slack <= 0.0; }

    /// A mean force is work over way: of a head that follows a resting drive the way is next to none, and what the
    /// specimen lost meanwhile has other causes.
    [[nodiscard]] bool meanCounts() const { return rig_.meanForce().known && !following_; }

    /// The force that compresses what is in series and the place of the head where it does, both smoothed over 2 um of
    /// travel, without the spikes with which an inextensible strip meets the floor: 60 to 1000 N for a microsecond or
    /// two, hundreds of times the load under which it buckles. What is in series would have taken them up. Smoothed
    /// alike they stay points of one curve; the load cell, in series too, reads this force. A strip that touches gains
    /// a newton within a micrometre of the head's travel but, at 400 N/m, 2.5 mm of the drive's: read unsmoothed, its
    /// force ran ahead of the clock by a millimetre. Where the head follows a drive that rests it hardly travels: there
    /// time smooths too.
    void press() {
        constexpr double kSmooth = 2e-6; // m
        const double way = rig_.displacement() - lastDisplacement_;
        lastDisplacement_ = rig_.displacement();
        const double time = std::exchange(lastTime_, rig_.time());
        const bool known = meanCounts();
        const double force = known ? rig_.meanForce().force : rig_.force();
        if (std::abs(force) >= impact_)
            return;
        const double settled = following_ ? (rig_.time() - time) / kSettle : 0.0;
        const double share = -std::expm1(-std::abs(way) / kSmooth - settled);
        pressing_ += share * (force - pressing_);
        pressedAt_ += share * (rig_.displacement() - (known ? 0.5 * way : 0.0) - pressedAt_);
    }

    /// How much farther the drive moves than the head: 1 + c K.
    [[nodiscard]] double ratio() const {
        const double f = std::hypot(pressing_, apparatus_.slackForce);
        const double play = apparatus_.slack > 0.0
                                ? 0.5 * apparatus_.slack * apparatus_.slackForce * apparatus_.slackForce / (f * f * f)
                                : 0.0;
        return 1.0 + (give_ + play) * stiffness_;
    }

    /// Moves the head so that a drive with something in series shows `goal` after `duration`.
    void followTo(double goal, double duration, const std::function<bool()>& observe) {
        constexpr double kNear = 1e-7, kFar = 2e-8, kForgets = 0.9; // m of the drive, m of the head, 1
        const double open = goal - position();
        const double force = pressing_, displacement = rig_.displacement();
        following_ = true;
        rig_.move(std::abs(open) > kNear ? open / ratio() : 0.0, duration, observe);
        following_ = false;
        const double moved = rig_.displacement() - displacement;
        if (std::abs(moved) <= kFar)
            return;
        if ((goal - position()) * open < 0.0)
            stiffness_ = std::max(stiffness_, (pressing_ - force) / moved);
        else
            stiffness_ *= kForgets; // one kick must not slow the head for ever
    }

    /// The drive rests at `to`; what relaxes takes the head along.
    void rest(double to, double duration, const std::function<bool()>& observe) {
        constexpr double kShortest = 2e-3, kLongest = 0.5, kNear = 5e-7; // s, s, m of the drive
        double done = 0.0;
        for (double piece = kShortest; done < duration && !stopped_ && rig_.failure().empty();) {
            const bool last = duration - done < 1.5 * piece;
            const double next = last ? duration - done : piece;
            followTo(to, next, observe);
            done = last ? duration : done + next;
            piece =
                std::abs(to - position()) < kNear ? std::min(1.3 * piece, kLongest) : std::max(0.7 * piece, kShortest);
        }
    }

    /// Comes to rest around time t1, evenly slower. A drive that stopped at once would shake the specimen: the inertia
    /// of 10 mm/s carries it on by micrometres, and the recoil loosens whatever dry friction holds. With something in
    /// series the head goes its share of these micrometres by what is known of the stiffness and is put right while the
    /// drive rests: led by the force in pieces of half a millisecond it shook a shell in a soft machine instead, whose
    /// inertia is 2 kN/m to such pieces (spikes of 7 mN where .2 were due).
    void stop(double t1, double duration, double to, double speed) {
        constexpr int kPieces = 10;
        started_ = true;
        double shown = position();
        for (int k = 1; k <= kPieces && rig_.failure().empty() && !stopped_; ++k) {
            const double left = duration * (1.0 - static_cast<double>(k) / kPieces); // s
            const double goal = to - 0.5 * speed * left * left / duration;
            const double end = t1 + 0.5 * duration - left;
            following_ = !rigid();
            rig_.move((goal - shown) / (rigid() ? 1.0 : ratio()), duration / kPieces, [&] {
                press();
                stopped_ = options_.interrupt != nullptr && options_.interrupt->load();
                return stopped_;
            });
            following_ = false;
            shown = rigid() ? position() : goal;
            clock_ = std::max(clock_, end);
            trace_.forces.push_back({clock_, rigid() ? rig_.force() : pressing_}); // which has no impacts
            addMarkers(clock_);
        }
    }

    /// Drives something in series with the specimen to `to`: the way left shrinks as the force grows, so it is gone in
    /// parts and the head never overshoots. It is never slower than a twentieth of the drive: where a specimen suddenly
    /// gives way, it would not arrive. Parts are short where the stiffness is not known yet: a leg begins as stiff as
    /// any part so far, because what slid may stick when the drive turns. An arch that did was taken for as soft as
    /// before, through all the way its feet stuck, six times too fast, and a viscous one read 20 mN of 290 too little.
    /// @param length of the whole leg, m @param arrived what `observe` says of the clock
    void inParts(double to, double length, double speed, const std::function<bool()>& observe, const bool& arrived) {
        constexpr double kNear = 1e-7, kPart = 0.8, kOfLeg = 0.05, kFirst = 0.005, kSlowest = 20.0; // m, then 1
        constexpr double kAlike = 1.25;                                                             // ratios
        stiffness_ = std::max(stiffness_, stiffest_);
        double part = kFirst;
        for (int i = 0; i < 400 && !arrived && !stopped_ && rig_.failure().empty(); ++i) {
            const double left = to - position();
            if (left * speed <= kNear * std::abs(speed))
                break;
            const double way = std::copysign(std::min(kPart * std::abs(left), part * length), left);
            const double force = pressing_, displacement = rig_.displacement(), expected = ratio();
            rig_.move(way / std::min(kSlowest, expected), way / speed, observe);
            const double enough = std::min(kNear, 0.2 * std::abs(way) / kSlowest);
            if (const double moved = rig_.displacement() - displacement; std::abs(moved) > enough)
                stiffness_ = std::max(0.0, (pressing_ - force) / moved);
            stiffest_ = std::max(stiffest_, stiffness_);
            const double change = ratio() / expected;
            part =
                change < kAlike && change * kAlike > 1.0 ? std::min(2.0 * part, kOfLeg) : std::max(0.5 * part, kFirst);
        }
    }

    void leg(double t0, double t1, double from, double to) {
        const double speed = (to - from) / (t1 - t0);
        const double begin = rig_.time();
        bool arrived = false;
        const auto observe = [&] {
            press();
            const bool byDisplacement = !rigid() && speed != 0.0;
            const double now = byDisplacement ? t0 + (position() - from) / speed : t0 + rig_.time() - begin;
            const double before = std::exchange(clock_, std::clamp(now, clock_, t1));
            if (byDisplacement)
                readPressing(t0 + (position() - rig_.displacement() + pressedAt_ - from) / speed);
            else
                readForce(before);
            addMarkers(clock_);
            bendMost_ = std::max(bendMost_, rig_.bend());
            if (options_.progress)
                options_.progress((clock_ - run_.driveTime.front()) / (run_.driveTime.back() - run_.driveTime.front()));
            stopped_ = options_.interrupt != nullptr && options_.interrupt->load();
            arrived = byDisplacement && now >= t1;
            return stopped_ || arrived;
        };
        started_ = false;
        lastTime_ = rig_.time();
        if (rigid() || speed == 0.0) {
            if (rigid())
                rig_.move(to - from, t1 - t0, observe);
            else
                rest(to, t1 - t0, observe);
            finishLeg(rigid() ? rig_.force() : pressing_);
            return;
        }
        inParts(to, std::abs(to - from), speed, observe, arrived);
        clock_ = stopped_ ? clock_ : t1;
        finishLeg(pressing_);
    }

    /// The first step of a leg changes the velocity at once; its inertia, m v / dt, is a matter of the step size and no
    /// load cell is that quick, so it is passed over.
    void readForce(double before) {
        if (!std::exchange(started_, true))
            return;
        if (meanCounts())
            take(0.5 * (before + clock_), rig_.meanForce().force);
        else
            take(clock_, following_ ? pressing_ : rig_.force());
    }

    /// Of a head that moves with something in series, at the time when it presses so.
    void readPressing(double at) {
        started_ = true;
        take(std::clamp(at, trace_.forces.back().time, clock_), pressing_);
    }

    void addMarkers(double at) {
        trace_.time.push_back(at);
        trace_.markers.resize(e_.markers.size());
        for (std::size_t m = 0; m < e_.markers.size(); ++m)
            trace_.markers[m].push_back(rig_.point(e_.markers[m].specimen, e_.markers[m].arcFraction));
    }

    /// Takes a step's force down and says what is to be thought of it (see the essay in rig.cpp).
    void take(double at, double force) {
        constexpr double kShort = 0.5; // of the last step that was steady: on the way to another step size
        const Rig::MeanForce& mean = rig_.meanForce();
        const bool known = meanCounts(), brief = std::abs(mean.way) < kShort * steadyWay_;
        if (known && mean.steady)
            steadyWay_ = std::abs(mean.way);
        const Kind kind = known && mean.steady ? Kind::Steady : known || brief ? Kind::Doubtful : Kind::Other;
        trace_.forces.push_back({at, force, kind, std::abs(mean.way)});
    }

    /// The force at the very end of a leg, where its slope may turn: carried on from the last two steady means.
    void finishLeg(double end) {
        if (clock_ > trace_.time.back())
            addMarkers(clock_);
        if (const auto tangent = endTangent(trace_.forces))
            end = tangent->at(clock_);
        if (clock_ > trace_.forces.back().time)
            trace_.forces.push_back({clock_, end});
    }

    Rig& rig_;
    const Experiment& e_;
    const Run& run_;
    double give_;
    effects::ApparatusModel apparatus_;
    const Options& options_;
    double clock_;                  ///< of the recording, s
    bool started_ = false;          ///< the leg has had its first step
    double pressing_ = 0.0;         ///< N
    double pressedAt_ = 0.0;        ///< head where it was pressing so, m
    double lastDisplacement_ = 0.0; ///< m
    double lastTime_ = 0.0;         ///< of the set-up, s
    double stiffness_ = 0.0;        ///< of the specimen, N/m, as it answered last
    double stiffest_ = 0.0;         ///< largest of these over a part of a leg, N/m
    double steadyWay_ = 0.0;        ///< of the head in the last step that was as long as the one before, m
    bool following_ = false;        ///< the drive brakes or rests
    double impact_ = 0.0;           ///< N, forces beyond it are impacts
    bool stopped_ = false;
    double bendMost_ = 0.0; ///< 1/m
    Trace trace_;
};

/// Takes out impacts of rigid on inextensible: steps whose force is ten times what stands on either side of them. Such
/// a force is an impulse over a step, as large as the step is short, and no load cell would show it.
void withoutImpacts(std::vector<Reading>& readings) {
    constexpr std::ptrdiff_t kNear = 3, kFar = 8;
    constexpr double kShare = 10.0;
    std::vector<double> force, sizes;
    for (const Reading& r : readings) {
        force.push_back(r.force);
        sizes.push_back(std::abs(r.force));
    }
    const auto n = static_cast<std::ptrdiff_t>(force.size());
    std::nth_element(sizes.begin(), sizes.begin() + n / 2, sizes.end());
    const double scale = n > 0 ? sizes[static_cast<std::size_t>(n / 2)] : 0.0; // what most steps show
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        double around = scale, before = 0.0, after = 0.0;
        for (std::ptrdiff_t k = kNear; k <= kFar; ++k) {
            const double b = force[static_cast<std::size_t>(std::max<std::ptrdiff_t>(i - k, 0))];
            const double a = force[static_cast<std::size_t>(std::min<std::ptrdiff_t>(i + k, n - 1))];
            around = std::max({around, std::abs(b), std::abs(a)});
            if (k == kNear) {
                before = b;
                after = a;
            }
        }
        if (std::abs(force[static_cast<std::size_t>(i)]) > kShare * around)
            readings[static_cast<std::size_t>(i)].force = 0.5 * (before + after);
    }
}

void read(const Trace& trace, const Experiment& e, const Run& run, Simulated& out) {
    const std::vector<double>& times = run.readings.time.empty() ? evenTimes(run, run.samplingRate) : run.readings.time;
    std::vector<double> forceTimes;
    for (const Reading& reading : trace.forces)
        forceTimes.push_back(reading.time);
    const Weights at(forceTimes, times);
    experiment::Readings& r = out.readings;
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t k = 0; k < at.row.size(); ++k) {
        r.time.push_back(times[k]);
        r.displacement.push_back(experiment::commanded(run, times[k]));
        r.force.push_back(at.at(k, [&](std::size_t i) { return trace.forces[i].force; }));
        if (times[k] < times.front() + e.sensors.forceZeroWindow) {
            sum += r.force.back();
            ++count;
        }
    }
    out.forceZero = count > 0 ? sum / static_cast<double>(count) : 0.0;
    for (double& f : r.force)
        f -= out.forceZero;
    for (const Reading& reading : trace.forces) {
        out.trace.time.push_back(reading.time);
        out.trace.displacement.push_back(experiment::commanded(run, reading.time));
        out.trace.force.push_back(reading.force - out.forceZero);
    }
    const std::vector<double> markerTimes =
        run.markers.time.empty() ? evenTimes(run, run.markersSamplingRate) : run.markers.time;
    const Weights seen(trace.time, markerTimes);
    out.markers.time.assign(markerTimes.begin(), markerTimes.begin() + static_cast<std::ptrdiff_t>(seen.row.size()));
    for (const std::vector<Vec2>& marker : trace.markers) {
        out.markers.x.emplace_back();
        out.markers.y.emplace_back();
        for (std::size_t k = 0; k < seen.row.size(); ++k) {
            out.markers.x.back().push_back(seen.at(k, [&](std::size_t i) { return marker[i].x(); }));
            out.markers.y.back().push_back(seen.at(k, [&](std::size_t i) { return marker[i].y(); }));
        }
    }
}

} // namespace

Resolution Resolution::full() {
    return {};
}

Resolution Resolution::coarse() {
    return {15, 1e-6, 5e-5, 0.5, 5e-3};
}

Resolution Resolution::finer() {
    Resolution r = full();
    r.elements = 61;
    r.freeStep *= 0.5;
    return r;
}

Simulated simulate(const Experiment& e, std::size_t run, const Parameters& parameters, const Resolution& resolution,
                   const Options& options) {
    Simulated out;
    const double begin = cpuClock();
    if (run >= e.runs.size()) {
        out.failure = "there is no run " + std::to_string(run + 1);
        return out;
    }
    if (e.scene) {
        out = simulateFree(e, run, parameters, resolution, options);
        out.cpuSeconds = cpuClock() - begin;
        return out;
    }
    Rig rig(e, parameters, resolution, e.runs[run].turned);
    if (rig.failure().empty()) {
        const effects::Model common = effects::modelFor(parameters.effects, "all");
        Player player(rig, e, e.runs[run], parameters.seriesCompliance, common.apparatus, options);
        Trace trace = player.play();
        trace.forces = mended(trace.forces);
        withoutImpacts(trace.forces);
        effects::SensorChain sensor(common.sensor);
        if (common.sensor.on())
            for (Reading& reading : trace.forces)
                reading.force = sensor.read(reading.time, reading.force);
        out.stopped = player.stopped();
        out.bendMost = player.bendMost();
        read(trace, e, e.runs[run], out);
    }
    out.failure = rig.failure();
    out.steps = rig.counters().steps;
    out.rejected = rig.counters().rejected;
    out.unconverged = rig.counters().unconverged;
    out.cpuSeconds = cpuClock() - begin;
    return out;
}

} // namespace supercircle::replay
