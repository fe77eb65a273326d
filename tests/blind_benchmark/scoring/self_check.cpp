#include "tests/blind_benchmark/scoring/self_check.h"
#include "tests/reference_simulator/json_text.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace supercircle::blind_benchmark {

namespace {

using Answer = nlohmann::ordered_json;

/// Names in `supercircle effects` of the laws, which are numbers in the answers.
const std::map<std::string, std::vector<std::string>>& laws() {
    static const std::map<std::string, std::vector<std::string>> known = {
        {"stiffness_gradient", {"thickness", "modulus"}},
        {"rate_dependent_friction", {"stribeck", "logarithmic", "viscous"}}};
    return known;
}

std::string inAllDigits(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", x);
    return text;
}

/// Numbers of a CSV file below its header.
std::vector<std::vector<double>> rowsOf(const std::string& file) {
    std::ifstream in(file);
    std::string line;
    if (!std::getline(in, line))
        throw std::runtime_error(file + ": cannot be read");
    std::vector<std::vector<double>> rows;
    while (std::getline(in, line)) {
        std::istringstream cells(line);
        std::vector<double> row;
        for (std::string cell; std::getline(cells, cell, ',');)
            row.push_back(std::strtod(cell.c_str(), nullptr)); // std::stod throws at denormal numbers
        rows.push_back(row);
    }
    return rows;
}

} // namespace

std::vector<std::string> truthFlags(const std::string& answerFile) {
    std::ifstream in(answerFile);
    std::vector<std::string> flags;
    try {
        const Answer answer = reference_simulator::parseOrderedJson(in);
        const std::pair<const char*, const char*> names[] = {{"bending_modulus", "bending_modulus_N_m2"},
                                                             {"natural_curvature", "natural_curvature_1_m"},
                                                             {"friction", "friction"},
                                                             {"thickness", "thickness_m"},
                                                             {"linear_mass", "linear_mass_kg_m"},
                                                             {"gap_shift", "initial_gap_shift_m"}};
        for (const auto& [flag, key] : names) {
            flags.emplace_back("--param");
            flags.push_back(std::string(flag) + "=" +
                            inAllDigits(answer.at("true_parameters").at(key).template get<double>()));
        }
        for (const Answer& effect : answer.at("effects")) {
            const std::string label = effect.at("label");
            if (effect.at("parameters").contains("branch_over_B")) { // the parameters tell the law
                flags.emplace_back("--effect");
                flags.push_back(label + ":law=standard_linear_solid");
            }
            for (const auto& [name, value] : effect.at("parameters").items()) {
                const double v = value;
                flags.emplace_back("--effect");
                flags.push_back(label + ":" + name + "=" +
                                (name == "law" ? laws().at(label).at(static_cast<std::size_t>(v)) : inAllDigits(v)));
            }
        }
    } catch (const std::exception& e) {
        throw std::runtime_error(answerFile + ": " + e.what());
    }
    return flags;
}

CleanReadings replayed(const std::string& folder, std::size_t runs, bool markers) {
    CleanReadings c;
    for (std::size_t r = 1; r <= runs; ++r) {
        const std::string run = folder + "/run_" + std::to_string(r) + "_replay";
        c.force.emplace_back();
        for (const auto& row : rowsOf(run + ".csv"))
            c.force.back().push_back(row.at(3)); // time, displacement, recorded, simulated
        c.markers.emplace_back();
        if (!markers)
            continue;
        for (const auto& row : rowsOf(run + "_markers.csv"))
            for (std::size_t m = 0; 2 * m + 2 < row.size(); ++m) {
                if (c.markers.back().size() <= m)
                    c.markers.back().emplace_back();
                c.markers.back()[m].push_back(Vec2(1e-3 * row[2 * m + 1], 1e-3 * row[2 * m + 2]));
            }
    }
    return c;
}

} // namespace supercircle::blind_benchmark
