#include "plugin/recording/import/velocity.h"

#include "supercircle/support/failure.h"

#include <algorithm>
#include <cmath>

namespace supercircle::importing {

namespace {

using Kind = Remark::Kind;

/// Sum of the ways between rows, m; missing velocities are those of the row before.
template <class Way>
std::vector<double> integrated(const std::vector<double>& time, const std::vector<double>& v, const Way& way) {
    SC_ASSERT(time.size() == v.size(), "velocities and times differ in number");
    std::vector<double> sum{0.0};
    double last = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const double now = std::isfinite(v[i]) ? way(v[i]) : last;
        if (i > 0)
            sum.push_back(sum.back() + 0.5 * (last + now) * (time[i] - time[i - 1]));
        last = now;
    }
    return sum;
}

} // namespace

std::vector<double> takeVelocity(Signals& s, std::vector<Remark>& remarks) {
    const std::vector<double>* found = s.find(Quantity::Velocity);
    if (found == nullptr)
        return {};
    std::vector<double> velocity = *found;
    s.channels.erase(std::remove_if(s.channels.begin(), s.channels.end(),
                                    [](const Channel& c) { return c.quantity == Quantity::Velocity; }),
                     s.channels.end());
    if (s.find(Quantity::Displacement) != nullptr || s.find(Quantity::Force) == nullptr)
        return velocity;
    s.channels.push_back(
        {Quantity::Displacement, {}, integrated(*s.find(Quantity::Time), velocity, [](double v) { return v; })});
    remarks.push_back({Kind::Assumed, 0,
                       "there is no displacement: the velocities are integrated from the first row on; an offset of "
                       "theirs grows with time"});
    return {};
}

void compareVelocity(ImportedRun& run, const std::vector<double>& velocity) {
    if (velocity.empty() || run.drive.time.size() < 2)
        return;
    double driven = 0.0;
    for (std::size_t i = 1; i < run.drive.time.size(); ++i)
        driven += std::abs(run.drive.displacement[i] - run.drive.displacement[i - 1]);
    // speeds are often without a sign
    const double way =
        integrated(*run.signals.find(Quantity::Time), velocity, [](double v) { return std::abs(v); }).back();
    const std::string both =
        "the velocities add up to a way of " + shownLength(way) + ", the displacement to " + shownLength(driven);
    if (way > 2.0 * driven || driven > 2.0 * way)
        run.remarks.push_back(
            {Kind::Doubtful, 0,
             both + "; the displacement is taken (is a unit of time, displacement or velocity wrong?)"});
    else
        run.remarks.push_back({Kind::Understood, 0, both + "; they are not used otherwise"});
}

} // namespace supercircle::importing
