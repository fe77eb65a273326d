// Runs for sets of parameters and seeds, several threads at a time. The program makes a process of each run instead,
// which outlives a crash of another one (decision 0174); a library may not fork its host.

#include "bridge/c/lab/request.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/lab/sweep/definition.h"
#include "plugin/lab/sweep/run_record.h"
#include "plugin/scene/loader/document.h"

#include <thread>

using namespace supercircle::c;
namespace lab = supercircle::lab;
namespace scene = supercircle::scene;
namespace sweep = supercircle::sweep;

namespace {

struct Plan {
    sweep::SweepDefinition definition;
    std::string sceneText, sceneFile;
    std::vector<sweep::Task> tasks;
    std::size_t jobs = 1;
};

std::vector<std::int64_t> seedsOf(const Request& r) {
    const std::string text = r.text("seeds");
    std::vector<std::int64_t> seeds = sweep::parseSeeds(text);
    if (seeds.empty())
        refuse(SC_BAD_INPUT, "\"seeds\" of the request: expected a text such as \"1:20\" or \"1:5,8\"");
    return seeds;
}

Plan planOf(const Request& r) {
    std::vector<scene::Problem> problems;
    const std::string text = r.document("sweep"), file = r.text("file");
    if (text.empty() && file.empty())
        refuse(SC_BAD_INPUT, "the request needs a \"sweep\" (an object or a text) or a \"file\"");
    auto loaded =
        text.empty() ? sweep::load(file, problems) : sweep::loadText(text, file.empty() ? "sweep" : file, problems);
    if (!loaded)
        refuse(SC_BAD_INPUT, scene::errorText(problems));
    Plan plan;
    plan.definition = *std::move(loaded);
    if (r.has("seeds"))
        plan.definition.seeds = seedsOf(r);
    plan.sceneText = r.document("scene");
    plan.sceneFile = plan.definition.scene;
    if (plan.sceneText.empty()) {
        const auto read = scene::readFile(plan.sceneFile, problems);
        if (!read)
            refuse(SC_BAD_INPUT, scene::errorText(problems));
        plan.sceneText = *read;
    }
    plan.tasks = sweep::tasks(plan.definition, {});
    const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
    plan.jobs = static_cast<std::size_t>(r.integer("jobs", static_cast<std::int64_t>(cores), 1, 256));
    return plan;
}

/// One row; empty when it was cancelled.
Json runOne(const Plan& plan, const sweep::Task& task, const Watch& watch) {
    const auto values = plan.definition.parameterValues(task.set);
    Json row = {{"parameters", Json::object()}, {"seed", task.seed}};
    for (const auto& [name, value] : values)
        row["parameters"][name] = value;
    try {
        const Input input = startable(plan.sceneText, plan.sceneFile, values);
        lab::RunOptions options;
        options.seed = static_cast<std::uint64_t>(task.seed);
        options.keepFrames = false;
        options.interrupt = &watch.cancelled();
        const lab::RunResult result = lab::runScene(input.scene, input.host, options);
        if (result.status == lab::RunStatus::Interrupted)
            return {};
        const bool ok = result.status == lab::RunStatus::Done;
        const sweep::RunRecord record = sweep::recordOf(result.recording, ok ? "done" : "failed", result.message);
        row.update(Json::parse(sweep::serialise(record)));
    } catch (const std::exception& e) {
        row["status"] = "failed";
        row["message"] = e.what();
    }
    return row;
}

Json runAll(const Plan& plan, Watch& watch) {
    for (std::size_t set = 0; set < plan.definition.sets.size() && !watch.cancelled(); ++set) // all can be started
        (void)startable(plan.sceneText, plan.sceneFile, plan.definition.parameterValues(set));
    std::vector<Json> rows(plan.tasks.size());
    std::atomic<std::size_t> next{0}, finished{0};
    const auto work = [&] {
        for (std::size_t i = next++; i < rows.size() && !watch.cancelled(); i = next++) {
            rows[i] = runOne(plan, plan.tasks[i], watch);
            const std::size_t n = ++finished;
            watch.tell(static_cast<double>(n) / static_cast<double>(rows.size()),
                       "run " + std::to_string(n) + " of " + std::to_string(rows.size()));
        }
    };
    std::vector<std::thread> others;
    for (std::size_t j = 1; j < std::min(plan.jobs, rows.size()); ++j)
        others.emplace_back(work);
    work();
    for (std::thread& t : others)
        t.join();
    Json runs = Json::array();
    for (Json& row : rows)
        if (!row.is_null())
            runs.push_back(std::move(row));
    return {{"status", watch.cancelled() ? "cancelled" : "done"},
            {"name", plan.definition.name},
            {"varied", plan.definition.names},
            {"planned", rows.size()},
            {"runs", std::move(runs)}};
}

} // namespace

const char* sc_lab_sweep(const char* request, sc_lab_progress progress, void* context) {
    return answer([&] {
        const Request r(request, {"sweep", "file", "scene", "seeds", "jobs"});
        const Plan plan = planOf(r);
        return watched(progress, context, [&](Watch& watch) { return runAll(plan, watch); });
    });
}
