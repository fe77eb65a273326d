#include "plugin/recording/import/scene_run.h"

#include "plugin/recording/table/json_text.h"
#include "plugin/scene/loader/loader.h"
#include "plugin/scene/loader/shipped.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

namespace supercircle::importing {

namespace {

using Json = nlohmann::ordered_json;
using Observed = scene::Observation;

/// Two digits: these numbers are guesses.
double rough(double v) {
    if (!(v > 0.0) || !std::isfinite(v))
        return 0.0;
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", v);
    return std::strtod(text, nullptr);
}

/// Standard deviation of readings about the line through their neighbours, over time or load: an upper bound of their
/// noise, since it counts curvature too. 0: fewer than three rows.
double roughness(const std::vector<double>& x, const std::vector<double>& y) {
    double sum = 0.0, count = 0.0;
    for (std::size_t i = 1; i + 1 < y.size(); ++i) {
        const double width = x[i + 1] - x[i - 1], share = width == 0.0 ? 0.5 : (x[i] - x[i - 1]) / width;
        const double off = y[i] - (1.0 - share) * y[i - 1] - share * y[i + 1];
        if (!std::isfinite(off))
            continue;
        sum += off * off / (1.0 + share * share + (1.0 - share) * (1.0 - share));
        count += 1.0;
    }
    return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

double range(const std::vector<double>& v) {
    double lo = INFINITY, hi = -INFINITY;
    for (const double x : v)
        if (std::isfinite(x)) {
            lo = std::min(lo, x);
            hi = std::max(hi, x);
        }
    return hi > lo ? hi - lo : 0.0;
}

/// Parameters that all loads of the scene are proportional to.
std::vector<std::string> loadParameters(const NamedScene& named) {
    std::vector<std::string> all;
    for (const scene::Parameter& p : named.scene.parameters) {
        std::vector<scene::Problem> problems;
        const double twice = 2.0 * p.value;
        if (p.value == 0.0 || twice > p.max || twice < p.min)
            continue;
        const auto other = scene::loadText(named.text, named.path, {{p.name, twice}}, problems);
        const auto doubled = [&](const scene::PointLoad& a, const scene::PointLoad& b) {
            const auto size = [](double x, double y, double moment) {
                return std::abs(x) + std::abs(y) + std::abs(moment);
            };
            return size(b.force.x - 2.0 * a.force.x, b.force.y - 2.0 * a.force.y, b.moment - 2.0 * a.moment) <=
                   1e-12 * size(a.force.x, a.force.y, a.moment);
        };
        if (other && std::equal(named.scene.loads.begin(), named.scene.loads.end(), other->loads.begin(),
                                other->loads.end(), doubled))
            all.push_back(p.name);
    }
    return all;
}

/// Channel and drive of a scene that loads move: the first way that the first load does work on, if there is one.
void addLoad(const NamedScene& named, const Imported& all, Json& json, Description& d) {
    const std::vector<std::string> parameters = loadParameters(named);
    json["drive"] = {{"parameter", nullptr}, {"column", "force_N"}};
    std::string names;
    for (const std::string& name : parameters)
        names += (names.empty() ? "" : ", ") + name;
    if (parameters.size() == 1) {
        json["drive"]["parameter"] = parameters.front();
        json["scene_parameters"].erase(parameters.front());
    } else if (!parameters.empty()) {
        d.remarks.push_back("/drive/parameter is one of " + names + ": every load is proportional to each of them");
    }
    const scene::PointLoad& load = named.scene.loads.front();
    const Observed* found = nullptr;
    double along = 0.0;
    for (const Observed& o : named.scene.observe) {
        const double way = o.quantity == Observed::Quantity::X   ? load.force.x
                           : o.quantity == Observed::Quantity::Y ? load.force.y
                                                                 : 0.0;
        if (found == nullptr && way != 0.0) {
            found = &o;
            along = way;
        }
    }
    double noise = 0.0, first = 0.0, most = 0.0, work = 0.0;
    for (const ImportedRun& run : all.runs) {
        const std::vector<double>&f = *run.signals.find(Quantity::Force),
              &y = *run.signals.find(Quantity::Displacement);
        noise = std::max(noise, 1e3 * roughness(run.atRest ? f : *run.signals.find(Quantity::Time), y));
        most = std::max(most, 1e3 * range(y));
        const auto least = std::min_element(f.begin(), f.end(), [](double a, double b) {
            return std::isfinite(a) && (!std::isfinite(b) || std::abs(a) < std::abs(b));
        });
        const auto row = static_cast<std::size_t>(least - f.begin());
        first = &run == &all.runs.front() ? 1e3 * y[row] : first;
        for (std::size_t i = 0; i < f.size(); ++i)
            if (std::isfinite(f[i]) && std::isfinite(y[i]))
                work += (f[i] - f[row]) * (y[i] - y[row]);
    }
    const double sign = work * along < 0.0 ? -1.0 : 1.0;
    json["channels"] = {{{"observe", found == nullptr ? Json() : Json(found->name)},
                         {"column", "displacement_mm"},
                         {"sign", sign},
                         {"noise_std", rough(noise)},
                         {"zero", {{"value", first}, {"unc", rough(0.05 * most)}}}}};
    d.assumed.emplace_back("/channels/0/sign: the loaded point moves along its load");
    d.assumed.emplace_back("/channels/0/noise_std: deviations from the line through neighbouring rows, an upper bound");
    d.assumed.emplace_back("/channels/0/zero: the reading at the smallest load, to a twentieth of the range");
}

/// Channel and drive of a scene with a machine.
void addMachine(const NamedScene& named, const Imported& all, Json& json, Description& d) {
    Json force;
    for (const Observed& o : named.scene.observe)
        if (o.of == Observed::Of::Machine && o.quantity == Observed::Quantity::Force && force.is_null())
            force = o.name;
    double noise = 0.0, window = INFINITY;
    for (const ImportedRun& run : all.runs) {
        noise = std::max(
            noise, run.atRest ? roughness(*run.signals.find(Quantity::Displacement), *run.signals.find(Quantity::Force))
                              : run.forceNoise);
        window = std::min(window, run.forceZeroWindow);
    }
    json["channels"] = {{{"observe", force}, {"column", "force_N"}, {"noise_std", rough(noise)}}};
    d.assumed.emplace_back("/channels/0/noise_std: from second differences of neighbouring rows");
    if (!(window > 0.0)) { // nothing was subtracted: the machine's own zero
        json["channels"][0]["zero"] = {{"value", 0.0}, {"unc", rough(5.0 * noise)}};
        d.assumed.emplace_back("/channels/0/zero: within five standard deviations of the noise");
    }
    if (all.runs.front().atRest)
        json["drive"] = {{"column", "displacement_mm"}};
}

} // namespace

Result<NamedScene> readNamedScene(const std::string& file) {
    using Answer = Result<NamedScene>;
    std::vector<scene::Problem> problems;
    std::error_code missing;
    NamedScene named{{}, file, {}, {}};
    if (!std::filesystem::is_regular_file(file, missing)) // the name of one that comes with the program
        if (const std::string shipped = scene::shippedScene(file); !shipped.empty())
            named.path = shipped;
    const auto text = scene::readFile(named.path, problems);
    auto read = text ? scene::loadText(*text, named.path, {}, problems) : Result<scene::Scene>::failure(text.error());
    if (!read) { // the first error says enough
        const auto first = std::find_if(problems.begin(), problems.end(), [](const scene::Problem& p) {
            return p.severity == scene::Problem::Severity::Error;
        });
        return Answer::failure(first->toString());
    }
    named.name = std::filesystem::path(named.path).filename().string();
    named.text = *text;
    named.scene = *std::move(read);
    return named;
}

Result<Description> describeScene(const Imported& all, const TemplateOptions& options, const std::string& runs) {
    using Answer = Result<Description>;
    const auto named = readNamedScene(options.sceneFile);
    if (!named)
        return Answer::failure(named.error());
    if (!named->scene.protocol && named->scene.loads.empty())
        return Answer::failure(named->path +
                               ": this scene has neither a machine nor a load that the recording could move; expected "
                               "a \"protocol\" or a \"load\"");
    Description d;
    Json json = {{"schema", "rod-recordings/1"},
                 {"protocol", "scene"},
                 {"description", "(describe the set-up)"},
                 {"uncertainty_meaning", "half-width of a uniform interval"},
                 {"scene", named->name},
                 {"scene_parameters", Json::object()}};
    for (const scene::Parameter& p : named->scene.parameters)
        json["scene_parameters"][p.name] = {{"value", p.value}, {"unc", 0.0}};
    if (named->scene.protocol)
        addMachine(*named, all, json, d);
    else
        addLoad(*named, all, json, d);
    json["runs"] = Json::array();
    const Json driven = record::parseJson(runs);
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
        Json run = {{"file", all.runs[k].file}};
        for (const char* key : {"drive_time_s", "drive_displacement_mm"})
            if (named->scene.protocol && !all.runs[k].atRest)
                run[key] = driven[k][key];
        json["runs"].push_back(run);
    }
    d.files.emplace_back(named->name, named->text);
    d.json = record::jsonText(json) + "\n";
    return d;
}

} // namespace supercircle::importing
