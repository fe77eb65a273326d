#include "plugin/pages/diagnosis/ensemble_file.h"

#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/json_text.h"
#include "plugin/scene/loader/document.h"
#include "plugin/scene/loader/reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace supercircle::cli {

namespace {

namespace fs = std::filesystem;
using diagnosis::Ensemble;
using diagnosis::EnsembleDiagnosis;
using Json = nlohmann::ordered_json;

class Loader {
public:
    Loader(std::string file, scene::Context& context) : file_(std::move(file)), context_(context) {}

    void load(EnsembleRequest& r) {
        scene::ObjectReader root(context_, context_.document.root(), "");
        root.ignore({"schema"});
        quantities(root, r.quantities);
        table(root, "recorded", r.quantities, r.recorded);
        table(root, "nominal", r.quantities, r.nominal);
        for (const scene::ArrayItem& place : root.array("effects")) {
            scene::ObjectReader entry(context_, place.node, place.pointer);
            if (!entry.valid())
                continue;
            Ensemble e;
            table(entry, "file", r.quantities, e);
            entry.require("label", "the name of the effect");
            e.label = entry.string("label", "");
            entry.finish();
            r.effects.push_back(std::move(e));
        }
        root.finish();
    }

private:
    void quantities(scene::ObjectReader& root, std::vector<std::string>& names) {
        const std::optional<scene::Node> list = root.find("quantities");
        if (!list)
            return;
        std::vector<std::string> stated;
        for (const scene::ArrayItem& place : root.array("quantities"))
            if (place.node.kind() == scene::Node::Kind::String && !place.node.text().empty())
                stated.push_back(place.node.text());
            else
                context_.error(place.node, place.pointer, "this is not a column name", "the name of a column");
        if (list->kind() == scene::Node::Kind::Array && list->children().empty())
            context_.error(*list, root.pointerTo("quantities"), "the list of quantities is empty", "names of columns");
        if (!stated.empty())
            names = std::move(stated);
    }

    void table(scene::ObjectReader& in, const char* key, const std::vector<std::string>& quantities, Ensemble& out) {
        constexpr std::size_t kLeast = 4; // for a covariance
        out.label = key;
        const std::optional<scene::Node> name = in.find(key);
        if (!in.require(key, "the name of a CSV file with a row for each stack") || in.string(key, "").empty())
            return;
        const auto wrong = [&](const std::string& what, const std::string& expected = {}) {
            context_.error(*name, in.pointerTo(key), what, expected);
        };
        const std::string path = (fs::path(file_).parent_path() / name->text()).string();
        std::vector<scene::Problem> unread;
        const auto text = scene::readFile(path, unread);
        if (!text)
            return wrong(unread.front().toString());
        record::CsvOptions options;
        options.required = quantities;
        options.ignored = {"scene", "snap_type"};
        const auto series = record::parseCsv(*text, path, options);
        if (!series)
            return wrong(series.error());
        const std::size_t rows = series->rows();
        if (rows < kLeast)
            return wrong(path + " holds " + std::to_string(rows) + " stacks", "at least 4");
        out.values.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(quantities.size()));
        for (std::size_t q = 0; q < quantities.size(); ++q)
            for (std::size_t k = 0; k < rows; ++k) {
                const double v = (*series->find(quantities[q]))[k];
                if (!std::isfinite(v))
                    return wrong(path + ":" + std::to_string(record::lineOfRow(*text, k)) + ": there is no " +
                                 quantities[q]);
                out.values(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(q)) = v;
            }
    }

    std::string file_;
    scene::Context& context_;
};

} // namespace

std::optional<EnsembleRequest> readEnsembles(const std::string& file, std::vector<scene::Problem>& problems) {
    std::vector<scene::Problem> unread; // found again by whoever reads the file as an experiment
    const auto text = scene::readFile(file, unread);
    const auto document =
        text ? scene::parseDocument(*text, file, unread) : Result<scene::Document>::failure(text.error());
    const std::optional<scene::Node> schema = document ? document->root().find("schema") : std::nullopt;
    if (!schema || schema->text() != "stack-ensembles/1")
        return std::nullopt;
    problems.insert(problems.end(), unread.begin(), unread.end());
    EnsembleRequest request;
    scene::Scope none;
    scene::Context context{*document, problems, none};
    Loader(file, context).load(request);
    return request;
}

std::string ensembleJson(const EnsembleDiagnosis& d, std::uint64_t seed) {
    Json effects = Json::array(), shifts = Json::array();
    for (const diagnosis::FittedEffect& e : d.effects)
        effects.push_back({{"label", e.label},
                           {"probability", e.probability},
                           {"confounded_with", e.confoundedWith},
                           {"heldout_gain", e.gain},
                           {"heldout_gain_error", e.gainError}});
    for (const diagnosis::EnsembleShift& s : d.shifts)
        shifts.push_back({{"run", "ensemble"},
                          {"channel", s.quantity},
                          {"recorded_mean", s.recorded},
                          {"simulated_mean", s.simulated},
                          {"z", s.z},
                          {"p_value", s.p}});
    const Json json = {{"schema", "supercircle-diagnosis/2"},
                       {"verdict", d.verdict},
                       {"statement", d.statement},
                       {"probability_adequate", d.adequate},
                       {"probability_outside_catalogue", d.outsideCatalogue},
                       {"misfit_p_value", d.p},
                       {"misfit_intervals", shifts},
                       {"effects", effects},
                       {"seed", seed}};
    return record::jsonText(json) + "\n";
}

} // namespace supercircle::cli
