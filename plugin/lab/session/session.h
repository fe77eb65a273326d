#pragma once
// One run in progress: the shells, the host world, what is recorded (private to lab/).

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/lab/session/energy_release.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/scene/player/random.h"
#include "supercircle/effects/sensor.h"
#include "supercircle/step/stepper.h"

#include <array>
#include <limits>
#include <optional>
#include <utility>

namespace supercircle::lab {

/// CPU time of the whole process so far, s.
double cpuSeconds();
/// Time of a steady clock, s.
double wallSeconds();

class Session {
public:
    Session(const scene::Scene& scene, std::shared_ptr<step::HostWorld> host, const RunOptions& options);

    /// Creates the shells and holds that the scene names; empty, or why it cannot start (overlap, unknown names).
    [[nodiscard]] std::string populate();
    /// Continues from a state that another session of the same run has saved; after populate().
    [[nodiscard]] Status restoreState(const std::vector<std::uint8_t>& state);
    /// Drops the scene's random shells in batches and lets them settle.
    void drop();
    void settleAtStart(); ///< of a scene that starts at rest
    /// Runs the protocol, or the scene's duration when there is none.
    void runProtocol();
    /// Fills summary, events, cycles and key frames.
    record::Recording finish(RunStatus status, const std::string& message);

    [[nodiscard]] bool beforeProtocol() const { return at_.part == Part::Start; }
    [[nodiscard]] RunStatus status() const { return status_; }
    [[nodiscard]] const std::string& message() const { return message_; }

private:
    using Rows = std::pair<std::size_t, std::size_t>;                   ///< of the series, the second one past the end
    enum class Part : std::uint8_t { Start, Approach, Segments, Free }; ///< Start: drop and settling
    /// Where the run is. A run that is continued enters the loop of this part, as it was before a frame.
    struct Position {
        Part part = Part::Start;
        double start = 0.0; ///< when the present loop of frames began, s
        int dropped = 0;    ///< shells so far
        std::size_t segment = 0;
        std::size_t firstRow = 0;   ///< of the segment
        double travelAtStart = 0.0; ///< of the segment, m
    };
    using Bodies = std::vector<std::pair<step::BodyId, step::BodyState>>;
    /// Frames that can be made again.
    struct ToRepeat {
        bool kept = false;            ///< the rest has a meaning
        Snapshot state{};             ///< before the first of them ...
        Bodies moving{};              ///< ... of the host too
        std::vector<double> frames{}; ///< s, those that are over
        double present = 0.0;         ///< s, the one after them
    };
    /// Time that the run has taken.
    struct Spent {
        double wall = 0.0, cpu = 0.0, protocolCpu = 0.0; ///< s
        std::array<double, static_cast<std::size_t>(step::Stage::Count)> stages{};
    };
    template <class Self, class Archive>
    static void io(Self& session, Archive& archive);
    [[nodiscard]] std::vector<std::uint8_t> saveState();
    [[nodiscard]] Bodies movingBodies() const; ///< kinematic ones of the host
    [[nodiscard]] Spent spent();
    void keepCheckpoint();
    [[nodiscard]] bool interrupted() const { return options_.interrupt && options_.interrupt->load(); }
    /// Whether the coming loop begins; else it is the one that a checkpoint was written in.
    [[nodiscard]] bool begins() { return !std::exchange(resumes_, false); }

    [[nodiscard]] bool frame(double dt, const std::function<bool()>& stop); ///< false when the run is over
    [[nodiscard]] bool frameToForce(double dt, double limit, bool& reached);
    void keepFramesToRepeat();
    [[nodiscard]] bool repeatFrames(int steps);
    [[nodiscard]] bool cutToForce(double low, double high, double span, double limit, bool& reached);
    [[nodiscard]] bool beginFrame();
    [[nodiscard]] bool endFrame(const FrameReport& report);
    void record();
    /// With checkpoints a frame is completed: a run that is continued makes the same frames.
    [[nodiscard]] bool stopsAtOnce() const { return !options_.checkpoint.file && interrupted(); }
    bool settle(double speed, double longest);
    void approach(); ///< brings the crosshead to first contact
    [[nodiscard]] bool beginApproach();
    [[nodiscard]] double approachSpeed() const; ///< m/s
    void beginRecording();
    void runFree(); ///< a scene without a protocol
    /// m/s along the protocol's direction; false after a refusal, which is the end of the run.
    [[nodiscard]] bool setCrossheadSpeed(double speed);
    [[nodiscard]] bool beginSegment(const scene::ProtocolSegment& segment);
    void runSegment(const scene::ProtocolSegment& segment, std::size_t number);
    void watchVibration();
    void sample();
    void keepFrame(bool always); ///< for the player
    void addShellInfo(std::size_t rod);
    void describeOutlines();
    void reportProgress(double fraction);
    [[nodiscard]] std::string dropBatch(int count);
    /// Sets the largest step and frame while the crosshead moves at `speed` m/s for `branch` m.
    void setStepLimits(double speed, double branch = std::numeric_limits<double>::infinity());
    void setAccuracy(double speed); ///< of a segment at `speed` m/s
    void addRow(double time, double travel, double force);
    void addRowsBetween(double rawForce);
    [[nodiscard]] double pileTop() const;         ///< highest point of the shells' surfaces, m
    [[nodiscard]] double crossheadBottom() const; ///< lowest point of the driven bodies, m
    [[nodiscard]] double force() const;           ///< on the crosshead, N, positive while the specimen resists
    [[nodiscard]] double travel() const;          ///< of the crosshead as measured, m since first contact
    void addEffects(std::size_t rod, const std::string& shell);

    void summarise();
    void summariseCounters();
    void summariseForces();
    void summariseSegment(std::size_t index, double R, double forceUnit);
    void summariseEnergy();
    void put(const std::string& key, record::Value value) { out_.summary.emplace_back(key, std::move(value)); }

    const scene::Scene& scene_;
    std::shared_ptr<step::HostWorld> host_;
    const RunOptions& options_;
    Shells shells_;
    player::Random random_;
    std::vector<ForceHandle> released_; ///< forces that end at time 0
    record::Recording out_;
    Position at_;
    bool resumes_ = false;        ///< the state was restored and no frame was made since
    double lastCheckpoint_ = 0.0; ///< s
    Spent earlier_;               ///< before the state was restored
    RunStatus status_ = RunStatus::Done;
    std::string message_;
    std::string phase_ = "start";
    effects::ApparatusModel apparatus_;
    effects::SensorChain sensor_;
    bool sensorOn_ = false;
    bool reversed_ = false;     ///< the crosshead moves back, backlash is on its other side
    double largestForce_ = 0.0; ///< N, so far
    bool inProtocol_ = false;
    bool loading_ = false; ///< the present segment is a loading branch
    EnergyRelease energyRelease_;
    std::vector<double> energies_; ///< scratch: of all shells, J
    double zeroTravel_ = 0.0;
    double pileHeight_ = 0.0; ///< H0, m
    double nextFrameTime_ = 0.0;
    double nextSampleTime_ = 0.0;
    double fixedDt_ = 0.0;     ///< s, wanted by options or scene
    double localError_ = 0.0;  ///< as in step::Settings, but for the drop ...
    double motionLimit_ = 0.0; ///< ... where both are coarser
    bool secondOrder_ = false; ///< as in step::Settings, but for settling at the start
    scene::Accuracy accuracy_ = scene::Accuracy::Exact;
    double sampleTravel_ = 0.0;            ///< m, longest travel between two rows; 0: one row a step
    double rawForce_ = 0.0;                ///< of the last row, before the sensor, N
    bool repeatable_ = false;              ///< a frame can be made again: no host body keeps forces to itself
    ToRepeat toRepeat_;                    ///< of the present segment
    double sizeRatio_ = 1.0;               ///< of the shells, over the size that the absolute settings are for
    double frame_ = 4e-3;                  ///< s, one call of pre_step
    step::EnergyBalance energyAtStart_{};  ///< when the protocol began
    std::vector<Rows> segmentRows_;        ///< by finished segment
    std::vector<int> segmentIndex_;        ///< its place in the protocol
    double largestForceDrop_ = 0.0;        ///< N
    double creepStart_ = -1.0;             ///< s
    std::vector<double> firstFrequencies_; ///< of the rods, rad/s
    double unitDamping_ = 0.0;             ///< what damping ratios of 1 would have taken, J
    std::vector<rod::Vec2> creepFrom_;
    double wallStart_ = 0.0;
    double cpuStart_ = 0.0;               ///< s of CPU time when the session began ...
    double cpuAtProtocol_ = -1.0;         ///< ... and when the protocol did
    step::Counters countersAtProtocol_{}; ///< counters then
};

} // namespace supercircle::lab
