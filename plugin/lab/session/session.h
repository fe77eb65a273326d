#pragma once
// One run in progress: the shells, the host world, what is recorded (private to lab/).

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/lab/session/release.h"
#include "plugin/lab/session/runner.h"
#include "plugin/scene/player/random.h"
#include "supercircle/effects/sensor.h"
#include "supercircle/step/stepper.h"

#include <limits>

namespace supercircle::lab {

/// Processor time of the process so far, s.
double cpuClock();

class Session {
public:
    Session(const scene::Scene& scene, std::shared_ptr<step::HostWorld> host, const Options& options);

    /// Shells and holds the scene names; empty or why it cannot start (overlap, unknown names).
    std::string populate();
    /// Drops the scene's random shells one by one and lets them settle.
    void drop();
    /// Plays the protocol, or the scene's duration when there is none.
    void protocol();
    /// Fills summary, events, cycles and key frames.
    record::Recording finish(End end, const std::string& message);

    [[nodiscard]] End end() const { return end_; }
    [[nodiscard]] const std::string& message() const { return message_; }

private:
    bool frame(double dt, const std::function<bool()>& stop); ///< false when the run is over
    bool settle(double speed, double longest);
    void touch(); ///< brings the machine to the first touch
    void play(const scene::Move& move, std::size_t number);
    void sample();
    void keep(bool force); ///< a frame for the player
    void addShellInfo(std::size_t rod);
    void describeOutlines();
    void report(double fraction);
    std::string dropBatch(int count);
    /// How long steps and frames may be while the machine moves at `speed` m/s for `branch` m.
    void pace(double speed, double branch = std::numeric_limits<double>::infinity());
    [[nodiscard]] double pileTop() const;       ///< highest point of the shells' surfaces, m
    [[nodiscard]] double machineBottom() const; ///< lowest point of the carried bodies, m
    [[nodiscard]] double force() const;
    [[nodiscard]] double travel() const; ///< of the drive, m since touch
    void addEffects(std::size_t rod, const std::string& shell);
    void summarise(record::Recording& out);

    const scene::Scene& scene_;
    std::shared_ptr<step::HostWorld> host_;
    const Options& options_;
    Shells shells_;
    player::Random random_;
    record::Recording out_;
    End end_ = End::Done;
    std::string message_;
    std::string phase_ = "start";
    effects::ApparatusModel apparatus_;
    effects::SensorChain sensor_;
    bool sensorOn_ = false;
    bool back_ = false; ///< the machine moves back, play is on its other side
    bool inProtocol_ = false;
    bool loading_ = false; ///< the move under way is a loading branch
    Release release_;
    std::vector<double> energies_; ///< scratch: of all shells, J
    double zeroTravel_ = 0.0;
    double pileHeight_ = 0.0; ///< H0, m
    double nextFrameTime_ = 0.0;
    double nextSampleTime_ = 0.0;
    double fixedDt_ = 0.0;   ///< s, wanted by options or scene
    double size_ = 1.0;      ///< of the shells, over the size that the absolute settings are for
    double frame_ = 4e-3;    ///< s, one call of pre_step
    step::Ledger atStart_{}; ///< books when the protocol began
    std::vector<std::pair<std::size_t, std::size_t>> legs_; ///< rows of the series per move
    std::vector<int> legMove_;
    double creepStart_ = -1.0;
    std::vector<rod::Vec2> creepFrom_;
    double wallStart_ = 0.0;
    double cpuStart_ = 0.0;          ///< s of processor time when the session began ...
    double cpuProtocol_ = -1.0;      ///< ... and when the protocol did
    step::Counters countProtocol_{}; ///< counters then
    double expectedTime_ = 0.0;
};

} // namespace supercircle::lab
