#include "plugin/cli/diagnose_ensembles.h"

#include "plugin/cli/output.h"

#include "plugin/diagnosis/ensembles.h"
#include "plugin/record/csv.h"
#include "plugin/record/files.h"
#include "plugin/scene/document.h"
#include "plugin/scene/loader.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace supercircle::cli {

namespace {

namespace fs = std::filesystem;
using diagnosis::Ensemble;
using diagnosis::EnsembleDiagnosis;
using Json = nlohmann::ordered_json;

struct Request {
    std::vector<std::string> quantities = {"H0_over_R", "delta_max_over_R", "eta", "snap_fits"};
    Ensemble recorded, nominal;
    std::vector<Ensemble> effects;
};

/// One place for what is wrong with the file.
class Loader {
public:
    Loader(std::string file, const scene::Document& document) : file_(std::move(file)), document_(document) {}

    bool load(Request& r) {
        const scene::Node& root = document_.root;
        const scene::Node* quantities = root.find("quantities");
        if (quantities != nullptr) {
            r.quantities.clear();
            for (const scene::Node& q : quantities->children)
                r.quantities.push_back(q.text);
            if (quantities->kind != scene::Node::Kind::Array || r.quantities.empty())
                return wrong("/quantities", "expected a list of column names");
        }
        if (!table(root, "recorded", "/recorded", r.quantities, r.recorded) ||
            !table(root, "nominal", "/nominal", r.quantities, r.nominal))
            return false;
        const scene::Node* effects = root.find("effects");
        for (std::size_t i = 0; effects != nullptr && i < effects->children.size(); ++i) {
            const scene::Node& entry = effects->children[i];
            const std::string at = "/effects/" + std::to_string(i);
            const scene::Node* label = entry.find("label");
            if (label == nullptr || label->text.empty())
                return wrong(at, "expected \"label\" and \"file\"");
            Ensemble e;
            if (!table(entry, "file", at + "/file", r.quantities, e))
                return false;
            e.label = label->text;
            r.effects.push_back(std::move(e));
        }
        return true;
    }

private:
    bool wrong(const std::string& pointer, const std::string& what) const {
        std::fprintf(stderr, "%s: %s: %s\n", file_.c_str(), pointer.c_str(), what.c_str());
        return false;
    }

    bool table(const scene::Node& in, const char* key, const std::string& pointer,
               const std::vector<std::string>& quantities, Ensemble& out) const {
        const scene::Node* name = in.find(key);
        if (name == nullptr || name->kind != scene::Node::Kind::String)
            return wrong(pointer, "expected the name of a CSV file with a row for each stack");
        const fs::path path = fs::path(file_).parent_path() / name->text;
        record::CsvOptions options;
        options.required = quantities;
        options.ignored = {"scene", "snap_type"};
        const auto series = record::readCsv(path.string(), options);
        if (!series)
            return wrong(pointer, series.error);
        out.label = key;
        const std::size_t rows = series.value.rows();
        out.values.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(quantities.size()));
        for (std::size_t q = 0; q < quantities.size(); ++q)
            for (std::size_t k = 0; k < rows; ++k) {
                const double v = (*series.value.find(quantities[q]))[k];
                if (!std::isfinite(v))
                    return wrong(pointer,
                                 path.string() + ": row " + std::to_string(k + 1) + " has no " + quantities[q]);
                out.values(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(q)) = v;
            }
        return true;
    }

    std::string file_;
    const scene::Document& document_;
};

std::string jsonOf(const EnsembleDiagnosis& d, std::int64_t seed) {
    Json effects = Json::array(), mismatch = Json::array();
    for (const diagnosis::FoundEffect& e : d.effects)
        effects.push_back({{"label", e.label},
                           {"probability", e.probability},
                           {"group", e.group},
                           {"gain", e.gain},
                           {"gain_error", e.gainError}});
    for (const diagnosis::EnsembleShift& s : d.shifts)
        mismatch.push_back({{"run", "ensemble"},
                            {"channel", s.quantity},
                            {"recorded_mean", s.recorded},
                            {"simulated_mean", s.simulated},
                            {"z", s.z},
                            {"p_value", s.p}});
    const Json json = {{"verdict", d.verdict},
                       {"statement", d.statement},
                       {"mismatch", mismatch},
                       {"mismatch_p_value", d.p},
                       {"effects", effects},
                       {"probability_nothing", d.nothing},
                       {"probability_unknown", d.unknown},
                       {"seed", seed}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace

std::optional<int> diagnoseEnsembleFile(const DiagnoseArguments& a) {
    std::vector<scene::Problem> problems; // whoever loads an experiment finds them again
    const auto text = scene::readFile(a.file, problems);
    const auto document = text ? scene::parseDocument(*text, a.file, problems) : std::nullopt;
    const scene::Node* schema = document ? document->root.find("schema") : nullptr;
    if (schema == nullptr || schema->text != "stack-ensembles/1")
        return std::nullopt;
    Request request;
    if (!Loader(a.file, *document).load(request))
        return kBadInput;
    const EnsembleDiagnosis d = diagnosis::diagnoseEnsembles(request.quantities, request.recorded, request.nominal,
                                                             request.effects, static_cast<std::uint64_t>(a.seed));
    if (!d.failure.empty()) {
        std::fprintf(stderr, "%s: %s\n", a.file.c_str(), d.failure.c_str());
        return kBadInput;
    }
    Folder folder(a.out.empty() ? "out/" + fs::path(a.file).stem().string() + "_diagnosis" : a.out);
    std::string why = folder.prepare();
    if (why.empty())
        why = record::writeAtomically(folder.path(), {{"diagnosis.json", jsonOf(d, a.seed)}});
    if (!why.empty()) {
        std::fprintf(stderr, "%s\n", why.c_str());
        return kCannotWrite;
    }
    if (!a.quiet) {
        std::printf("%s: %s\n", d.verdict.c_str(), d.statement.c_str());
        for (const diagnosis::EnsembleShift& s : d.shifts)
            std::printf("  %-20s recorded %.4g, simulated %.4g, t %.1f, p %.3f\n", s.quantity.c_str(), s.recorded,
                        s.simulated, s.z, s.p);
        for (const diagnosis::FoundEffect& e : d.effects)
            std::printf("  %-26s probability %.3f\n", e.label.c_str(), e.probability);
    }
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
