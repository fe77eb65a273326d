#include "plugin/identification/replay/drive.h"

#include "supercircle/effects/backlash.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supercircle::replay {

namespace {

using experiment::Experiment;
using experiment::Run;

/// Follows the commanded motion. With a compliance c in series the commanded displacement is d = x + c F, and time is
/// read from d while the drive moves. Where a snap lets d jump back, time stands still. The speed of the crosshead is
/// that of the drive less the rate of the spring.
///
/// While the drive brakes or rests, d is given and x follows by 1 / (1 + c K) of the difference, K the stiffness of the
/// specimen. A full correction would oscillate for c K > 1 (decision 0152).
///
/// Lengths and times are those of the reference specimen, in units of the set-up (experiment::NaturalUnits).
class Drive {
    static constexpr double kApproach = 1.0; ///< s, duration of the motion to the start of a run
    static constexpr double kBraking = 5e-3; ///< s, duration of braking
    static constexpr double kSettle = 2e-4;  ///< s, see updateSeriesForce()

public:
    Drive(TestRig& rig, const Experiment& e, const Run& run, double compliance,
          const effects::ApparatusModel& apparatus, const Options& options, const LoadCourse* loads)
        : rig_(rig), e_(e), run_(run), compliance_(compliance + apparatus.compliance), apparatus_(apparatus),
          options_(options), loads_(loads), clock_(run.driveTime.front()) {}

    Trace play() {
        if (loads_ != nullptr)
            return playLoads();
        const effects::DriveMotion drive =
            effects::motionBehindBacklash({run_.driveTime, run_.driveDisplacement}, apparatus_.backlash);
        if (drive.displacement.front() != 0.0) // the crosshead moves from displacement 0 to the start of the run
            rig_.move(drive.displacement.front(), kApproach * rig_.units().settling, {});
        trace_.forces.push_back({clock_, rig_.force()});
        addMarkers(clock_);
        lastDisplacement_ = seriesForceAt_ = rig_.displacement();
        seriesForce_ = rig_.force();
        largest_ = std::max(0.0, seriesForce_);
        double delay = 0.0; // s, delay of the segment before
        for (std::size_t i = 0; i < e_.specimens.size();
             ++i) { // ten times the Euler load of a rod clamped at both ends
            const double turn = 2.0 * M_PI / e_.specimens[i].length;
            impact_ = std::max(impact_, 10.0 * turn * turn * e_.specimens[i].bendingModulus.value);
        }
        for (std::size_t i = 1; i < drive.time.size() && rig_.failure().empty() && !stopped_; ++i) {
            const double t0 = drive.time[i - 1], t1 = drive.time[i];
            const double from = drive.displacement[i - 1], to = drive.displacement[i];
            const bool rests = i + 1 < drive.time.size() && drive.displacement[i + 1] == to && to != from;
            const double brake =
                rests ? std::min({kBraking * rig_.units().time, t1 - t0, drive.time[i + 1] - t1}) : 0.0;
            leg(t0 + delay, t1 - 0.5 * brake, from, to - 0.5 * brake * (to - from) / (t1 - t0));
            delay = 0.5 * brake;
            if (rests && rig_.failure().empty() && !stopped_)
                stop(t1, brake, to, (to - from) / (t1 - t0));
        }
        return std::move(trace_);
    }
    [[nodiscard]] bool stopped() const { return stopped_; }
    [[nodiscard]] double largestCurvatureChange() const { return largestCurvatureChange_; }

private:
    /// A prescribed load. Between rows or break points it changes evenly and then rests, so that rows are read in
    /// equilibrium: a tenth of the time is thousands of periods where only rest counts.
    Trace playLoads() {
        constexpr double kRest = 0.1; // of the time between rows
        std::vector<double> times = run_.driveTime;
        times.insert(times.end(), run_.readings.time.begin(), run_.readings.time.end());
        std::sort(times.begin(), times.end());
        times.erase(std::unique(times.begin(), times.end()), times.end());
        const auto stop = [&] { return stopped_ = options_.interrupt != nullptr && options_.interrupt->load(); };
        const auto seen = [&] {
            trace_.forces.push_back({clock_, 0.0});
            addMarkers(clock_);
            largestCurvatureChange_ = std::max(largestCurvatureChange_, rig_.bend());
        };
        seen(); // the rig has settled under the first load
        for (std::size_t i = 1; i < times.size() && !stopped_ && times[i] <= run_.driveTime.back(); ++i) {
            const double from = experiment::commanded(run_, times[i - 1]), to = experiment::commanded(run_, times[i]);
            const double time = times[i] - times[i - 1];
            const double begin = rig_.time(), duration = (1.0 - kRest) * time;
            const auto change = [&] { // a step is implicit: it has the load of its end
                const double share = std::min(1.0, (rig_.time() + rig_.nextStep() - begin) / duration);
                loads_->set(rig_, from + share * (to - from));
                return stop();
            };
            change();
            if (!rig_.move(0.0, duration, change))
                break;
            loads_->set(rig_, to);
            if (!rig_.move(0.0, kRest * time, stop))
                break;
            clock_ = times[i];
            seen();
            if (options_.progress)
                options_.progress((clock_ - run_.driveTime.front()) / (run_.driveTime.back() - run_.driveTime.front()));
            (void)stop();
        }
        return std::move(trace_);
    }

    /// Displacement of the drive: crosshead and series compliance.
    [[nodiscard]] double position() const {
        return rig_.displacement() + compliance_ * seriesForce_ + apparatus_.bedding * largest_ +
               0.5 * apparatus_.slack * seriesForce_ / math::hypot(seriesForce_, apparatus_.slackForce);
    }
    [[nodiscard]] bool rigid() const {
        return compliance_ <= 0.0 && apparatus_.slack <= 0.0 && apparatus_.bedding <= 0.0;
    }

    /// A mean force is work over travel. While the crosshead follows a resting drive the travel is almost zero and the
    /// mean is meaningless.
    [[nodiscard]] bool meanCounts() const { return rig_.meanForce().known && !followsDrive_; }

    /// Force in the series compliance and the crosshead position there, smoothed over a short travel and without impact
    /// spikes of an inextensible strip, which a compliance would absorb.
    void updateSeriesForce() {
        constexpr double kSmooth = 2e-6; // m
        const double travel = rig_.displacement() - lastDisplacement_;
        lastDisplacement_ = rig_.displacement();
        const double time = std::exchange(lastTime_, rig_.time());
        const bool known = meanCounts();
        const double force = known ? rig_.meanForce().force : rig_.force();
        if (std::abs(force) >= impact_)
            return;
        const double settled = followsDrive_ ? (rig_.time() - time) / (kSettle * rig_.units().time) : 0.0;
        const double share = -math::expm1(-std::abs(travel) / (kSmooth * rig_.units().length) - settled);
        seriesForce_ += share * (force - seriesForce_);
        largest_ = std::max(largest_, seriesForce_);
        seriesForceAt_ += share * (rig_.displacement() - (known ? 0.5 * travel : 0.0) - seriesForceAt_);
    }

    /// Ratio of drive motion to crosshead motion, 1 + c K; a support beds in at the largest force only.
    [[nodiscard]] double ratio() const {
        const double f = math::hypot(seriesForce_, apparatus_.slackForce);
        const double play = apparatus_.slack > 0.0
                                ? 0.5 * apparatus_.slack * apparatus_.slackForce * apparatus_.slackForce / (f * f * f)
                                : 0.0;
        const double bedding = seriesForce_ >= largest_ ? apparatus_.bedding : 0.0;
        return 1.0 + (compliance_ + play + bedding) * stiffness_;
    }

    /// Moves the crosshead so that the drive reaches `goal` after `duration`.
    void followTo(double goal, double duration, const std::function<bool()>& observe) {
        constexpr double kNear = 1e-7, kFar = 2e-8, kDecay = 0.9; // m of the drive, m of the crosshead, 1
        const double open = goal - position();
        const double force = seriesForce_, displacement = rig_.displacement();
        followsDrive_ = true;
        const double length = rig_.units().length;
        rig_.move(std::abs(open) > kNear * length ? open / ratio() : 0.0, duration, observe);
        followsDrive_ = false;
        const double moved = rig_.displacement() - displacement;
        if (std::abs(moved) <= kFar * length)
            return;
        if ((goal - position()) * open < 0.0)
            stiffness_ = std::max(stiffness_, (seriesForce_ - force) / moved);
        else
            stiffness_ *= kDecay; // one spike must not slow the crosshead permanently
    }

    /// The drive rests at `to`; relaxation moves the crosshead.
    void rest(double to, double duration, const std::function<bool()>& observe) {
        constexpr double kShortest = 2e-3, kLongest = 0.5, kNear = 5e-7; // s, s, m of the drive
        const experiment::NaturalUnits& units = rig_.units();
        const double shortest = kShortest * units.time, longest = kLongest * units.settling,
                     near = kNear * units.length;
        double done = 0.0;
        for (double piece = shortest; done < duration && !stopped_ && rig_.failure().empty();) {
            const bool last = duration - done < 1.5 * piece;
            const double next = last ? duration - done : piece;
            followTo(to, next, observe);
            done = last ? duration : done + next;
            piece = std::abs(to - position()) < near ? std::min(1.3 * piece, longest) : std::max(0.7 * piece, shortest);
        }
    }

    /// Decelerates evenly around time t1. An instant stop would excite the specimen, whose recoil releases friction.
    /// With a series compliance the crosshead moves by the estimated share and is corrected while the drive rests
    /// (decision 0152).
    void stop(double t1, double duration, double to, double speed) {
        constexpr int kPieces = 10;
        started_ = true;
        double shown = position();
        for (int k = 1; k <= kPieces && rig_.failure().empty() && !stopped_; ++k) {
            const double left = duration * (1.0 - static_cast<double>(k) / kPieces); // s
            const double goal = to - 0.5 * speed * left * left / duration;
            const double end = t1 + 0.5 * duration - left;
            followsDrive_ = !rigid();
            rig_.move((goal - shown) / (rigid() ? 1.0 : ratio()), duration / kPieces, [&] {
                updateSeriesForce();
                stopped_ = options_.interrupt != nullptr && options_.interrupt->load();
                return stopped_;
            });
            followsDrive_ = false;
            shown = rigid() ? position() : goal;
            clock_ = std::max(clock_, end);
            trace_.forces.push_back({clock_, rigid() ? rig_.force() : seriesForce_}); // without impacts
            addMarkers(clock_);
        }
    }

    /// Drives a series compliance to `to`. The remaining travel shrinks as the force grows, so it is covered in parts
    /// and never overshoots. The crosshead keeps at least a twentieth of the drive speed, to arrive after a sudden loss
    /// of force. Parts are short while the stiffness is unknown: a segment starts with the largest stiffness so far,
    /// because sliding contacts may stick at a reversal (decision 0152).
    /// @param length of the whole segment, m
    /// @param arrived what `observe` returns about the clock
    void inParts(double to, double length, double speed, const std::function<bool()>& observe, const bool& arrived) {
        constexpr double kNear = 1e-7, kPart = 0.8, kOfLeg = 0.05, kFirst = 0.005, kSlowest = 20.0; // m, then 1
        constexpr double kAlike = 1.25;                                                             // ratios
        stiffness_ = std::max(stiffness_, stiffest_);
        const double near = kNear * rig_.units().length;
        double part = kFirst;
        for (int i = 0; i < 400 && !arrived && !stopped_ && rig_.failure().empty(); ++i) {
            const double left = to - position();
            if (left * speed <= near * std::abs(speed))
                break;
            const double travel = std::copysign(std::min(kPart * std::abs(left), part * length), left);
            const double force = seriesForce_, displacement = rig_.displacement(), expected = ratio();
            rig_.move(travel / std::min(kSlowest, expected), travel / speed, observe);
            const double enough = std::min(near, 0.2 * std::abs(travel) / kSlowest);
            if (const double moved = rig_.displacement() - displacement; std::abs(moved) > enough)
                stiffness_ = std::max(0.0, (seriesForce_ - force) / moved);
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
            updateSeriesForce();
            const bool byDisplacement = !rigid() && speed != 0.0;
            const double now = byDisplacement ? t0 + (position() - from) / speed : t0 + rig_.time() - begin;
            const double before = std::exchange(clock_, std::clamp(now, clock_, t1));
            if (byDisplacement)
                readPressing(t0 + (position() - rig_.displacement() + seriesForceAt_ - from) / speed);
            else
                readForce(before);
            addMarkers(clock_);
            largestCurvatureChange_ = std::max(largestCurvatureChange_, rig_.bend());
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
            finishLeg(rigid() ? rig_.force() : seriesForce_);
            return;
        }
        inParts(to, std::abs(to - from), speed, observe, arrived);
        clock_ = stopped_ ? clock_ : t1;
        finishLeg(seriesForce_);
    }

    /// The first step of a segment changes the velocity at once. Its inertia force depends on the step size and is
    /// skipped.
    void readForce(double before) {
        if (!std::exchange(started_, true))
            return;
        if (meanCounts())
            take(0.5 * (before + clock_), rig_.meanForce().force);
        else
            take(clock_, followsDrive_ ? seriesForce_ : rig_.force());
    }

    /// Force of a crosshead with a series compliance, at its own time.
    void readPressing(double at) {
        started_ = true;
        take(std::clamp(at, trace_.forces.back().time, clock_), seriesForce_);
    }

    /// What instruments see of the specimens.
    void addMarkers(double at) {
        if (e_.scene && e_.scene->observation.of == scene::Observation::Of::Shell)
            observe(e_.scene->observation, trace_.observed);
        const std::vector<experiment::FurtherChannel>& further = experiment::furtherChannels(e_);
        trace_.further.resize(further.size());
        for (std::size_t k = 0; k < further.size(); ++k)
            if (further[k].observation.of == scene::Observation::Of::Shell)
                observe(further[k].observation, trace_.further[k]);
        trace_.time.push_back(at);
        trace_.markers.resize(e_.markers.size());
        for (std::size_t m = 0; m < e_.markers.size(); ++m)
            trace_.markers[m].push_back(rig_.point(e_.markers[m].specimen, e_.markers[m].arcFraction));
    }

    void observe(const scene::Observation& o, Track& track) {
        using Quantity = scene::Observation::Quantity;
        std::size_t i = 0;
        while (i + 1 < e_.specimens.size() && e_.specimens[i].id != o.target)
            ++i;
        if (o.quantity == Quantity::Angle) {
            track.value.push_back(rig_.angle(i, o.arc_fraction));
            if (rig_.inMotion())
                track.rate.push_back(rig_.spin(i, o.arc_fraction));
            return;
        }
        const int axis = o.quantity == Quantity::X ? 0 : 1;
        track.value.push_back(rig_.point(i, o.arc_fraction)[axis]);
        if (rig_.inMotion())
            track.rate.push_back(rig_.velocity(i, o.arc_fraction)[axis]);
    }

    /// Records the force of a step and its reliability (decision 0151).
    void take(double at, double force) {
        constexpr double kShort = 0.5; // share of the last steady step: the step size is changing
        const TestRig::MeanForce& mean = rig_.meanForce();
        const bool known = meanCounts(), brief = std::abs(mean.travel) < kShort * steadyTravel_;
        if (known && mean.steady)
            steadyTravel_ = std::abs(mean.travel);
        const MeanForceKind kind = known && mean.steady ? MeanForceKind::Steady
                                   : known || brief     ? MeanForceKind::Uncertain
                                                        : MeanForceKind::Other;
        trace_.forces.push_back({at, force, kind, std::abs(mean.travel)});
    }

    /// Force at the end of a segment, extrapolated from the last two steady means.
    void finishLeg(double end) {
        if (clock_ > trace_.time.back())
            addMarkers(clock_);
        if (const auto tangent = endTangent(trace_.forces))
            end = tangent->at(clock_);
        if (clock_ > trace_.forces.back().time)
            trace_.forces.push_back({clock_, end});
    }

    TestRig& rig_;
    const Experiment& e_;
    const Run& run_;
    double compliance_;
    effects::ApparatusModel apparatus_;
    const Options& options_;
    const LoadCourse* loads_;       ///< of a prescribed load; nullptr: the machine moves
    double clock_;                  ///< s, of the recording
    bool started_ = false;          ///< the segment has had its first step
    double seriesForce_ = 0.0;      ///< N, force in the series compliance
    double seriesForceAt_ = 0.0;    ///< m, crosshead position at that force
    double largest_ = 0.0;          ///< N, largest force so far
    double lastDisplacement_ = 0.0; ///< m
    double lastTime_ = 0.0;         ///< s, of the set-up
    double stiffness_ = 0.0;        ///< N/m, latest stiffness of the specimen
    double stiffest_ = 0.0;         ///< N/m, largest of these over a part of a segment
    double steadyTravel_ = 0.0;     ///< m, of the crosshead in the last step as long as the one before
    bool followsDrive_ = false;     ///< the drive brakes or rests
    double impact_ = 0.0;           ///< N, larger forces are impacts
    bool stopped_ = false;
    double largestCurvatureChange_ = 0.0; ///< 1/m
    Trace trace_;
};

} // namespace

Driven drive(TestRig& rig, const Experiment& e, const Run& run, double compliance,
             const effects::ApparatusModel& apparatus, const Options& options, const LoadCourse* loads) {
    Drive player(rig, e, run, compliance, apparatus, options, loads);
    Driven out;
    out.trace = player.play();
    out.stopped = player.stopped();
    out.largestCurvatureChange = player.largestCurvatureChange();
    return out;
}

} // namespace supercircle::replay
