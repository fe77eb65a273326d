#include "plugin/recording/experiment/natural_units.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::experiment {

namespace {

// The reference shell. Another one would multiply all constants that are scaled by a common factor.
constexpr double kRadius = 0.0192;                               // m
constexpr double kBendingModulus = 2.2e9 * 0.01 * 1.25e-10 / 12; // N m^2
constexpr double kLinearMass = 1270.0 * 0.01 * 5e-4;             // kg/m

constexpr double kTravels = 4.0;    // travels that make a length. Half: twice the steps of small travels; double: half
constexpr double kPeriods = 2000.0; // of the bending mode in a run, at least. Half or double: 2.6 or 10 ms of
constexpr double kPeriod = 1.9404998e-3; // s, braking in a run of 5 s

/// One factor of a unit without its exponent.
double base(const NaturalUnits& u, const std::string& name) {
    return name == "m"    ? u.length
           : name == "s"  ? u.time
           : name == "Hz" ? 1.0 / u.time
           : name == "N"  ? u.force
           : name == "kg" ? u.force * u.time * u.time / u.length
                          : 1.0;
}

/// "N s" or "m^2".
double product(const NaturalUnits& u, const std::string& text) {
    double out = 1.0;
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t end = std::min(text.find(' ', at), text.size());
        std::string word = text.substr(at, end - at);
        int power = 1;
        if (const std::size_t hat = word.find('^'); hat != std::string::npos) {
            power = word[hat + 1] - '0';
            word.erase(hat);
        }
        for (int i = 0; i < power; ++i)
            out *= base(u, word);
        at = end + 1;
    }
    return out;
}

} // namespace

double NaturalUnits::of(const std::string& unit) const {
    std::string plain;
    for (const char c : unit)
        if (c != '(' && c != ')')
            plain += c;
    const std::size_t slash = plain.find('/');
    return slash == std::string::npos
               ? product(*this, plain)
               : product(*this, plain.substr(0, slash)) / product(*this, plain.substr(slash + 1));
}

double radiusOf(const Specimen& s) {
    constexpr double kStraight = 0.3; // rad, the whole turn of what counts as straight
    const double curvature = std::abs(s.naturalCurvature.value);
    return curvature * s.length > kStraight ? 1.0 / curvature : s.length / M_PI;
}

NaturalUnits unitsOfSpecimens(const Experiment& e) {
    NaturalUnits u;
    if (e.specimens.empty())
        return u;
    double travel = 0.0, duration = std::numeric_limits<double>::infinity();
    for (const Run& run : e.runs) {
        if (!drivesLoad(e))
            for (const double d : run.driveDisplacement)
                travel = std::max(travel, std::abs(d));
        if (!run.driveTime.empty())
            duration = std::min(duration, run.driveTime.back() - run.driveTime.front());
    }
    u.length = u.settling = u.force = std::numeric_limits<double>::infinity();
    for (const Specimen& s : e.specimens) {
        const double radius = radiusOf(s) / kRadius, stiff = s.bendingModulus.value / kBendingModulus;
        u.length = std::min(u.length, radius);
        u.settling = std::min(u.settling, radius * radius * std::sqrt(s.linearMass.value / kLinearMass / stiff));
        u.force = std::min(u.force, stiff / (radius * radius));
    }
    u.time = std::min(u.settling, duration / (kPeriods * kPeriod));
    if (travel > 0.0)
        u.length = std::min(u.length, kTravels * travel / kRadius);
    return u;
}

} // namespace supercircle::experiment
