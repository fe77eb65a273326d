#include "plugin/recording/import/free_run.h"

#include "plugin/recording/import/release_state.h"
#include "plugin/recording/import/scene_run.h"
#include "plugin/recording/table/json_text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace supercircle::importing {

namespace {

using Json = nlohmann::ordered_json;
using Kind = Remark::Kind;

constexpr double kDegrees = 180.0 / M_PI;

double rounded(double v) {
    const double r = std::round(v * 1e6) / 1e6;
    return r == 0.0 ? 0.0 : r;
}

/// Means over `half` rows on either side; rows that are missing do not count.
std::vector<double> smooth(const std::vector<double>& v, std::size_t half) {
    std::vector<double> out;
    for (std::size_t i = 0; i < v.size(); ++i) {
        double sum = 0.0, n = 0.0;
        for (std::size_t k = i > half ? i - half : 0; k < std::min(v.size(), i + half + 1); ++k)
            if (std::isfinite(v[k])) {
                sum += v[k];
                n += 1.0;
            }
        out.push_back(n > 0.0 ? sum / n : std::numeric_limits<double>::quiet_NaN());
    }
    return out;
}

/// Row of the first turning point, from which the angle returns by a hundredth of its range. 0: none.
std::size_t firstTurn(const std::vector<double>& v) {
    const auto [lo, hi] = std::minmax_element(v.begin(), v.end());
    const double back = 0.01 * (*hi - *lo);
    std::size_t top = 0, bottom = 0;
    for (std::size_t i = 1; i < v.size(); ++i) {
        top = v[i] > v[top] ? i : top;
        bottom = v[i] < v[bottom] ? i : bottom;
        if (v[top] - v[i] > back && top > 0 && v[top] - v[0] > back)
            return top;
        if (v[i] - v[bottom] > back && bottom > 0 && v[0] - v[bottom] > back)
            return bottom;
    }
    return 0;
}

} // namespace

void cutToTurningPoint(Signals& signals, int which, std::vector<Remark>& remarks) {
    std::vector<double>& t = *signals.find(Quantity::Time);
    const std::vector<double>& v = *signals.find(Quantity::Angle);
    if (v.size() < 10)
        return;
    const double dt = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
    const double half = swingPeriod(t, v) / 70.0; // of the mean: far shorter than the swing
    std::vector<double> rest = smooth(v, std::max<std::size_t>(1, static_cast<std::size_t>(half / dt)));
    std::size_t turn = 0;
    for (int k = 0; k < which; ++k) {
        const std::size_t next = firstTurn(rest);
        if (next == 0) {
            remarks.push_back({Kind::Assumed, 0,
                               "the angle turns back " + std::to_string(k) + " times, not " + std::to_string(which) +
                                   ": no rows are removed at its start"});
            return;
        }
        turn += next;
        rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(next));
    }
    const std::size_t line = signals.line[turn];
    const double at = t[turn];
    std::vector<char> gone(signals.rows(), 0);
    std::fill(gone.begin(), gone.begin() + static_cast<std::ptrdiff_t>(turn), 1);
    remarks.push_back({Kind::Omitted, signals.line.front(),
                       std::to_string(turn) + " rows up to turning point " + std::to_string(which) + ", line " +
                           std::to_string(line) + ", at " + shown(kDegrees * v[turn]) + " deg"});
    signals.erase(gone);
    for (double& time : *signals.find(Quantity::Time))
        time -= at;
}

void average(Signals& signals, int size, std::vector<Remark>& remarks) {
    const auto n = static_cast<std::size_t>(std::max(1, size));
    if (n == 1)
        return;
    const std::size_t rows = signals.rows() / n;
    for (Channel& c : signals.channels) {
        std::vector<double> means;
        for (std::size_t i = 0; i < rows; ++i) {
            double sum = 0.0, count = 0.0;
            for (std::size_t k = i * n; k < (i + 1) * n; ++k)
                if (std::isfinite(c.values[k])) {
                    sum += c.values[k];
                    count += 1.0;
                }
            means.push_back(count > 0.0 ? sum / count : std::numeric_limits<double>::quiet_NaN());
        }
        c.values = std::move(means);
    }
    std::vector<std::size_t> lines;
    for (std::size_t i = 0; i < rows; ++i)
        lines.push_back(signals.line[i * n]);
    signals.line = std::move(lines);
    std::vector<double>& time = *signals.find(Quantity::Time);
    for (const double first = time.empty() ? 0.0 : time.front(); double& t : time)
        t -= first;
    remarks.push_back({Kind::Corrected, 0, "rows are means of " + std::to_string(n)});
}

namespace {

/// Parameters of a scene; those of the release belong to the runs.
void addParameters(const scene::Scene& s, const Imported& all, Json& json, std::vector<std::string>& remarks) {
    bool angle = false, spin = false;
    for (const scene::Parameter& p : s.parameters) {
        angle = angle || p.name == "release_angle";
        spin = spin || p.name == "release_spin";
        if (p.name != "release_angle" && p.name != "release_spin")
            json["scene_parameters"][p.name] = {{"value", p.value}, {"unc", 0.0}};
    }
    for (std::size_t k = 0; k < all.runs.size() && angle; ++k) {
        const ReleaseState b = releaseStateOf(all.runs[k].signals);
        Json& run = json["runs"][k]["parameters"];
        run["release_angle"] = {{"value", rounded(b.angle)}, {"unc", rounded(b.angleHalfWidth)}};
        if (spin)
            run["release_spin"] = {{"value", rounded(b.spin)}, {"unc", rounded(b.spinHalfWidth)}};
        remarks.push_back(all.runs[k].file + " is released at " + shown(kDegrees * b.angle) + " +- " +
                          shown(kDegrees * b.angleHalfWidth) + " deg" +
                          (spin
                               ? ", " + shown(kDegrees * b.spin) + " +- " + shown(kDegrees * b.spinHalfWidth) + " deg/s"
                               : std::string()) +
                          (b.bySpin ? ", by angles and angular velocities" : ""));
        if (b.spinApart != 0.0)
            remarks.push_back("the angular velocities of " + all.runs[k].file +
                              " are not used for it: they are off by " + shown(kDegrees * std::abs(b.spinApart)) +
                              " deg/s (is their sign, unit or clock another one?)");
    }
}

} // namespace

Result<Description> describeFree(const Imported& all, const TemplateOptions& options) {
    using Answer = Result<Description>;
    Description d;
    Json runs = Json::array();
    double step = 0.0;
    for (const ImportedRun& run : all.runs) {
        const std::vector<double>& t = *run.signals.find(Quantity::Time);
        step = std::max(step, encoderStep(*run.signals.find(Quantity::Angle)));
        runs.push_back({{"file", run.file}, {"duration_s", rounded(t.back())}, {"sampling_hz", rounded(run.rate)}});
    }
    Json json = {{"schema", "rod-recordings/1"},
                 {"protocol", "free_scene"},
                 {"description", "(describe the set-up)"},
                 {"gravity_m_s2", {0.0, -9.81}},
                 {"uncertainty_meaning", "half-width of a uniform interval"},
                 {"scene", nullptr},
                 {"scene_parameters", Json::object()},
                 {"observed", {{"body", nullptr}, {"quantity", "angle"}, {"zero_unc_deg", 0.5}}},
                 {"runs", runs},
                 {"sensors", {{"angle_noise_std_deg_approx", rounded(std::max(0.01, 0.5 * kDegrees * step))}}}};
    d.assumed = {"/gravity_m_s2: [0.0,-9.81]", "/observed/zero_unc_deg: 0.5",
                 "/sensors/angle_noise_std_deg_approx: half a step of the encoder"};
    if (!options.sceneFile.empty()) {
        const auto named = readNamedScene(options.sceneFile);
        if (!named)
            return Answer::failure(named.error());
        json["scene"] = named->name;
        d.files.emplace_back(named->name, named->text);
        std::vector<std::string> moving;
        for (const step::BodyDefinition& b : named->scene.rigid.bodies)
            if (b.type == step::BodyType::Dynamic)
                moving.push_back(b.name);
        if (moving.size() == 1)
            json["observed"]["body"] = moving.front();
        addParameters(named->scene, all, json, d.remarks);
    }
    d.json = record::jsonText(json) + "\n";
    return d;
}

} // namespace supercircle::importing
