// A run that is interrupted anywhere and continued from its checkpoint gives the bytes of one that is not.

#include "plugin/lab/session/checkpoint.h"
#include "plugin/recording/table/writer.h"
#include "tests/plugin/lab/session/simulation.h"

#include <atomic>
#include <filesystem>
#include <map>
#include <unistd.h>

using namespace supercircle;
using namespace supercircle::test;

namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string name = (fs::temp_directory_path() / "sc-checkpoint-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        path = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::string path;
};

const lab::RunIdentity kIdentity{{"program", "1"}, {"text of the scene", "abc"}, {"--seed", "1"}};

struct Start {
    lab::RunStatus status = lab::RunStatus::Done;
    std::string phase; ///< last one
    std::uint64_t frames = 0;
    std::map<std::string, std::string> files;
};

/// Starts the run, or continues it where there is a checkpoint; interrupts it in frame `stopAt`.
Start start(const scene::Scene& scene, const lab::CheckpointFile* file, std::uint64_t stopAt) {
    std::string error;
    std::shared_ptr<step::HostWorld> host = bridge::makeWorld(scene.rigid, error);
    REQUIRE(host);
    Start out;
    std::atomic<bool> interrupt{false};
    lab::RunOptions options;
    options.interrupt = &interrupt;
    options.onStage = [&](step::Stage stage) {
        if (stage == step::Stage::ReadHost && ++out.frames == stopAt)
            interrupt = true;
    };
    options.checkpoint.file = file;
    if (file && file->exists()) {
        auto state = file->read();
        REQUIRE(state);
        options.checkpoint.resume = *std::move(state);
    }
    lab::RunResult run = lab::runScene(scene, host, options);
    INFO(run.message);
    REQUIRE((run.status == lab::RunStatus::Done || run.status == lab::RunStatus::Interrupted));
    out.status = run.status;
    if (!run.recording.frames.empty())
        out.phase = run.recording.frames.back().phase;
    run.recording.timing.clear();
    const auto files = record::recordingFiles(run.recording);
    REQUIRE(files);
    out.files.insert(files->begin(), files->end());
    return out;
}

/// Interrupts the run in each of these frames, counted from the last start, and continues it to its end.
void checkContinued(const scene::Scene& scene, const Start& whole, const std::vector<std::uint64_t>& stops,
                    std::vector<std::string>& phases) {
    const TemporaryFolder folder;
    const lab::CheckpointFile file(folder.path, kIdentity);
    for (const std::uint64_t stop : stops) {
        const Start part = start(scene, &file, stop);
        REQUIRE(part.status == lab::RunStatus::Interrupted);
        REQUIRE(file.exists());
        phases.push_back(part.phase);
    }
    const Start last = start(scene, &file, 0);
    REQUIRE(last.status == lab::RunStatus::Done);
    CHECK_FALSE(file.exists());
    CAPTURE(stops);
    for (const auto& [name, content] : whole.files) {
        INFO(name);
        CHECK((last.files.at(name) == content));
    }
}

bool has(const std::vector<std::string>& phases, const std::string& start) {
    return std::any_of(phases.begin(), phases.end(), [&](const std::string& p) { return p.rfind(start, 0) == 0; });
}

} // namespace

TEST_CASE("a squeezed stack continues from its checkpoint to the same bytes", "[lab][checkpoint]") {
    const scene::Scene scene = loadScene("stack30", {{"shells", 3}, {"max_force", 0.3}, {"cycles", 2}});
    const Start whole = start(scene, nullptr, 0);
    std::vector<std::string> phases;
    for (int part = 1; part < 12; ++part)
        checkContinued(scene, whole, {whole.frames * part / 12}, phases);
    for (const char* phase : {"drop", "load 1", "unload 1", "load 2", "unload 2"}) {
        INFO(phase);
        CHECK(has(phases, phase));
    }
    const std::uint64_t step = whole.frames / 9;
    checkContinued(scene, whole, {1, 1, step, step + 1, step, 2, step, step, step}, phases);
}

TEST_CASE("a squeeze with steps longer than its samples continues from a checkpoint", "[lab][checkpoint]") {
    scene::Scene scene = loadScene("stack30", {{"shells", 3}, {"max_force", 0.3}});
    scene.numerics.accuracy = scene::Accuracy::Standard;
    const Start whole = start(scene, nullptr, 0);
    std::vector<std::string> phases;
    for (int part = 3; part < 10; ++part)
        checkContinued(scene, whole, {whole.frames * part / 10}, phases);
}

TEST_CASE("runs of every kind continue from a checkpoint to the same bytes", "[lab][checkpoint]") {
    for (const char* name : {"two_shells", "cantilever", "effects", "pinning", "squeeze"}) {
        INFO(name);
        const scene::Scene scene = loadScene(name, {});
        REQUIRE(lab::whyNoCheckpoint(scene).empty());
        const Start whole = start(scene, nullptr, 0);
        std::vector<std::string> phases;
        for (const int part : {1, 3, 6})
            checkContinued(scene, whole, {1 + whole.frames * part / 8}, phases);
    }
}

TEST_CASE("shells that settle before time 0 and hosts that move continue from a checkpoint", "[lab][checkpoint]") {
    scene::Scene atRest = loadScene("cantilever", {});
    REQUIRE_FALSE(atRest.shells.empty());
    atRest.starts_at_rest = true;
    atRest.duration = 0.2;
    atRest.numerics.quasi_static = false;
    atRest.loads.push_back({atRest.shells.front().name, 1.0, {0.0, -1e-3}, 0.0, true});
    scene::Scene moving = loadScene("ramp", {});
    for (step::BodyDefinition& b : moving.rigid.bodies) {
        b.type = step::BodyType::Kinematic;
        b.linearVelocity = {0.003, 0.001};
        b.angularVelocity = 0.01;
    }
    for (const scene::Scene* scene : {&atRest, &moving}) {
        INFO(scene->name);
        const Start whole = start(*scene, nullptr, 0);
        std::vector<std::string> phases;
        for (const int part : {1, 4, 7})
            checkContinued(*scene, whole, {1 + whole.frames * part / 8}, phases);
    }
}

TEST_CASE("a checkpoint of another run is refused with what differs", "[lab][checkpoint]") {
    const TemporaryFolder folder;
    const lab::CheckpointFile file(folder.path, kIdentity);
    CHECK_FALSE(file.read());
    REQUIRE(file.write({1, 2, 3}));
    const auto own = file.read();
    REQUIRE(own);
    CHECK(*own == std::vector<std::uint8_t>{1, 2, 3});
    lab::RunIdentity other = kIdentity;
    other[1].second = "abd";
    other[2].second = "7";
    other.emplace_back("parameter mu", "0.3");
    const std::string why = lab::CheckpointFile(folder.path, other).read().error();
    CHECK(why.find("differs in text of the scene, --seed (1 there, 7 here), parameter mu (absent there, 0.3 here)") !=
          std::string::npos);
    fs::resize_file(file.path(), fs::file_size(file.path()) - 1);
    CHECK(file.read().error().find("cut off") != std::string::npos);
}

TEST_CASE("scenes with dynamic bodies have no checkpoints", "[lab][checkpoint]") {
    scene::Scene scene = loadScene("two_shells", {});
    scene.rigid.bodies.emplace_back();
    scene.rigid.bodies.back().name = "crate";
    scene.rigid.bodies.back().type = step::BodyType::Dynamic;
    CHECK(lab::whyNoCheckpoint(scene).find("\"crate\" is dynamic") != std::string::npos);
}
