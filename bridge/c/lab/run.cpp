// One run: what `supercircle run` writes into its folder, as one text.

#include "bridge/c/lab/request.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/pages/run/figures.h"
#include "plugin/recording/table/writer.h"

using namespace supercircle::c;
using supercircle::record::Recording;
namespace graphics = supercircle::graphics;
namespace lab = supercircle::lab;
namespace pages = supercircle::pages;

namespace {

const char* word(lab::RunStatus status) {
    return status == lab::RunStatus::Done ? "done" : status == lab::RunStatus::Interrupted ? "cancelled" : "failed";
}

Json seriesJson(const supercircle::record::Series& series) {
    Json out = Json::object();
    for (std::size_t i = 0; i < series.names.size(); ++i)
        out[series.names[i]] = numbersJson(series.columns[i]);
    return out;
}

Json eventsJson(const Recording& r) {
    Json out = Json::array();
    for (const supercircle::record::Event& e : r.events)
        out.push_back({{"time_s", numberJson(e.time)},
                       {"displacement_m", numberJson(e.displacement)},
                       {"force_N", numberJson(e.force)},
                       {"kind", e.kind},
                       {"text", e.text}});
    return out;
}

/// SVG of the key frames, and of the force or energy curve.
Json picturesJson(const Recording& r) {
    constexpr double kWidth = 480.0, kHeight = 360.0;
    const graphics::Rect sheet{0.0, 0.0, kWidth, kHeight};
    Json out = Json::object();
    const std::vector<pages::KeyView> views = pages::keyViews(r);
    std::vector<std::size_t> frames;
    for (const pages::KeyView& v : views)
        frames.push_back(v.frame);
    for (const pages::KeyView& v : views) {
        graphics::SvgCanvas canvas(kWidth, kHeight, "supercircle-" + v.id, v.title);
        pages::drawConfiguration(canvas, r, v.frame, pages::viewOf(r, frames), pages::largestBendingEnergy(r), sheet,
                                 v.title);
        out[v.id] = canvas.finish();
    }
    graphics::SvgCanvas curve(kWidth, kHeight, "supercircle-curve", "curve");
    const auto drawn = pages::hasForceCurve(r) ? pages::drawForce(curve, r, sheet) : pages::drawEnergy(curve, r, sheet);
    if (drawn)
        out["curve"] = curve.finish();
    return out;
}

Json resultJson(const lab::RunResult& result, const Input& input, bool pictures, bool motion) {
    const Recording& r = result.recording;
    const auto summary = supercircle::record::summaryJson(r);
    Json out = {{"status", word(result.status)},
                {"message", result.message},
                {"scene", r.scene},
                {"notes", input.notes},
                {"summary", Json::parse(done(summary, SC_FAILED))},
                {"series", seriesJson(r.series)},
                {"events", eventsJson(r)}};
    if (pictures)
        out["pictures"] = picturesJson(r);
    if (motion)
        out["motion"] = Json::parse(supercircle::record::trajectoryJson(r));
    return out;
}

} // namespace

const char* sc_lab_run(const char* request, sc_lab_progress progress, void* context) {
    return answer([&] {
        const Request r(request,
                        {"scene", "file", "parameters", "seed", "threads", "fixed_dt_s", "pictures", "motion"});
        const auto source = sceneText(r);
        const Input input = startable(source.first, source.second, r.numbers("parameters"));
        const bool pictures = r.flag("pictures", false), motion = r.flag("motion", false);
        lab::RunOptions options;
        options.seed = static_cast<std::uint64_t>(r.integer("seed", 1, 0, std::int64_t{1} << 53));
        options.threads = static_cast<int>(r.integer("threads", 1, 1, 256));
        options.fixedDt = r.number("fixed_dt_s", 0.0);
        if (!(options.fixedDt >= 0.0 && options.fixedDt <= 1.0))
            refuse(SC_BAD_INPUT, "\"fixed_dt_s\" of the request must lie between 0 and 1 s");
        options.keepFrames = pictures || motion;
        return watched(progress, context, [&](Watch& watch) {
            options.interrupt = &watch.cancelled();
            options.progress = [&](const lab::RunProgress& p) { watch.tell(p.fraction, p.phase); };
            const lab::RunResult result = lab::runScene(input.scene, input.host, options);
            if (result.status == lab::RunStatus::BadScene)
                refuse(SC_BAD_INPUT, source.second + ": " + result.message);
            return resultJson(result, input, pictures, motion);
        });
    });
}
