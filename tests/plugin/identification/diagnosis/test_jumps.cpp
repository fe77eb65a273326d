// Jumps of the force as observations of their time, on a spring with a latch that opens at a displacement.

#include "toy.h"

#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/likelihood/jumps.h"
#include "plugin/identification/diagnosis/localisation/localise.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/selection/cross_validation.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

namespace replay = supercircle::replay;
using namespace supercircle::diagnosis;

namespace {

constexpr double kDrop = 0.5, kTravel = 0.01; // N, m

/// The toy's spring, whose force falls by half a newton for the rest of the run when it first passes a displacement.
class Latch final : public toy::Spring {
public:
    explicit Latch(const RecordedData& data) : Spring(data), nominal_(Spring::nominal()) {
        nominal_.push_back({"place", "m", "", 6e-3, 4e-3, 8e-3, 1e-3, Scale::Linear, false});
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] std::string identity() const override { return "spring with a latch"; }

private:
    void alter(std::size_t r, const ParameterPoint& p, Response& out) const override {
        const DriveSegment& down = data_.runs[r].segments[1];
        const double open = down.from + p.nominal[2] / down.speed; // s
        for (Eigen::Index k = 0; k < out.force.size(); ++k)
            out.force[k] -= data_.runs[r].time[k] > open ? kDrop : 0.0;
        out.jumps = Eigen::VectorXd::Constant(1, open);
    }

    std::vector<Scalar> nominal_;
};

RecordedData latched(std::uint64_t seed, double place) {
    RecordedData data = toy::recordings(seed);
    const Latch model(data);
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        data.runs[r].force +=
            model.simulate(r, ParameterPoint{{103.0, 0.08, place}, {}}, Fidelity::Fine, nullptr).force -
            model.simulate(r, ParameterPoint{{103.0, 0.08, 1.0}, {}}, Fidelity::Fine, nullptr)
                .force; // beyond the travel
    return data;
}

std::vector<Response> at(const RecordedData& data, const ParameterPoint& p) {
    const Latch model(data);
    std::vector<Response> all;
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        all.push_back(model.simulate(r, p, Fidelity::Fine, nullptr));
    return all;
}

/// The same drive, divided into segments of one length.
RecordedRun inPieces(RecordedRun run, double length) {
    std::vector<DriveSegment> pieces;
    for (const DriveSegment& segment : run.segments) {
        const double n = std::ceil((segment.to - segment.from) / length);
        for (double i = 0.0; i < n; ++i) {
            pieces.push_back(segment);
            pieces.back().from = segment.from + i / n * (segment.to - segment.from);
            pieces.back().to = i + 1.0 < n ? segment.from + (i + 1.0) / n * (segment.to - segment.from) : segment.to;
        }
    }
    run.setDrive(std::move(pieces));
    return run;
}

} // namespace

TEST_CASE("the number of segments of a drive does not matter", "[diagnosis]") {
    RecordedData whole = latched(11, 6.437e-3);
    RecordedRun& seen = toy::withMarkers(whole, {0.5});
    seen.markers = 1e-4 * Eigen::VectorXd::LinSpaced(2 * seen.time.size(), 0.0, 20.0).array().sin();
    RecordedData pieces = whole;
    for (RecordedRun& run : pieces.runs)
        run = inPieces(run, 0.05);
    auto late = at(whole, ParameterPoint{{103.0, 0.08, 6.737e-3}, {}});
    late.front().markers = Eigen::VectorXd::Zero(seen.markers.size());
    const Noise noise = estimateNoise(whole);
    for (const std::size_t runs : {3, 1}) { // folds are runs, or intervals of a single run
        CAPTURE(runs);
        whole.runs.resize(runs);
        pieces.runs.resize(runs);
        late.resize(runs);
        const Likelihood a(whole, noise, late, late), b(pieces, noise, late, late);
        REQUIRE(a.rows() == b.rows());
        for (std::size_t r = 0; r < runs; ++r) {
            CHECK(a.jumps(r).size() == 1);
            CHECK(b.jumps(r).size() == 1);
            CHECK(b.errors(r).correlationTime == a.errors(r).correlationTime);
        }
        CHECK(*b.residual(late) == *a.residual(late));
        Random random(5); // transposed map with overlapping marker shifts and jumps
        Eigen::VectorXd x(a.rowsOf(0)), y(a.rowsOf(0));
        for (Eigen::Index k = 0; k < x.size(); ++k) {
            x[k] = a.counts(0, k) ? random.normal() : 0.0;
            y[k] = random.normal();
        }
        CHECK(a.whiten(0, x).dot(y) == Approx(x.dot(a.whitenTransposed(0, y))).epsilon(1e-9));
        const Grouping g = groupingOf(a), h = groupingOf(b);
        CHECK(h.fold == g.fold);
        CHECK(h.block == g.block);
        const Localisation l = localise(a, *a.residual(late), {}, 1, 99), m = localise(b, *b.residual(late), {}, 1, 99);
        CHECK(m.familySize == l.familySize);
        CHECK(m.p == l.p);
    }
}

TEST_CASE("a smooth start and a short dwell are no reversals", "[diagnosis]") {
    RecordedRun run;
    run.time = Eigen::VectorXd::LinSpaced(1001, 0.0, 10.0); // rows 10 ms apart
    run.setDrive({{Phase::Hold, 0.0, 0.5, 0.0},
                  {Phase::Hold, 0.5, 1.0, 0.0},
                  {Phase::Loading, 1.0, 1.05, 2e-4},
                  {Phase::Loading, 1.05, 1.1, 6e-4},
                  {Phase::Loading, 1.1, 3.0, 1e-3},
                  {Phase::Hold, 3.0, 3.02, 0.0},
                  {Phase::Loading, 3.02, 5.0, 1e-3},
                  {Phase::Hold, 5.0, 5.5, 0.0},
                  {Phase::Loading, 5.5, 6.0, 1e-3},
                  {Phase::Hold, 6.0, 6.02, 0.0},
                  {Phase::Unloading, 6.02, 7.0, -1e-3},
                  {Phase::Free, 7.0, 8.0, 0.0},
                  {Phase::Free, 8.0, 10.0, 0.0}});
    std::vector<double> from;
    for (const Stroke& s : run.strokes)
        from.push_back(s.from);
    CHECK(from == std::vector<double>{0.0, 1.0, 5.0, 5.5, 6.0, 6.02, 7.0, 8.0});
    CHECK(run.strokes[1].phase == Phase::Loading);
    CHECK(run.strokes[1].to == 5.0);
    std::vector<std::size_t> of;
    for (const DriveSegment& segment : run.segments)
        of.push_back(segment.stroke);
    CHECK(of == std::vector<std::size_t>{0, 0, 1, 1, 1, 1, 1, 2, 3, 4, 5, 6, 7});
    CHECK(&run.strokeAt(3.01) == &run.strokes[1]); // the short dwell
    CHECK(run.stroke(501) == 2);
    CHECK(atReversal(run, 1.05));
    CHECK_FALSE(atReversal(run, 1.2)); // 50 ms ramps end at 1.1 s
    CHECK_FALSE(atReversal(run, 3.02));
    CHECK(atReversal(run, 6.02));
    CHECK(jumpReachOf(run, 1.07, 0.2) == Approx(0.2 * 4.0));
}

TEST_CASE("a late jump is one observation", "[diagnosis]") {
    const ParameterPoint truth{{103.0, 0.08, 6.437e-3}, {}};
    RecordedData data = latched(3, 6.437e-3);
    const auto exact = at(data, truth);
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        data.runs[r].force = exact[r].force; // no noise
    Noise noise;
    noise.white = 0.01;
    const Likelihood likelihood(data, noise, exact, exact, {});
    const std::size_t slow = 0; // 1 mm/s, 25 readings/s: 1 mm takes 25 rows
    REQUIRE(likelihood.jumps(slow).size() == 1);
    const Eigen::VectorXd there = likelihood.rawResidual(slow, exact[slow]).rows;
    // A recorded jump lies between two readings.
    CHECK(std::abs(there[there.size() - 1]) <= 0.5 / 25.0 + 1e-12);
    const auto late = at(data, ParameterPoint{{103.0, 0.08, 7.437e-3}, {}});
    const RawDifference late1 = likelihood.rawResidual(slow, late[slow]);
    const Eigen::VectorXd& d = late1.rows;
    CHECK(d[d.size() - 1] - there[there.size() - 1] == Approx(-1.0).epsilon(1e-9)); // s
    // Its error: a uniform distribution between two readings, and the error of the simulation.
    const double error = std::hypot(data.runs[slow].spacing() / std::sqrt(12.0),
                                    LikelihoodSettings{}.jumpPositionError * kTravel / 1e-3);
    const Eigen::VectorXd u = likelihood.whiten(slow, d);
    CHECK(u[u.size() - 1] == Approx(d[d.size() - 1] / error).epsilon(1e-9));
    CHECK(u.head(u.size() - 1).cwiseAbs().maxCoeff() < 1e-9); // equal before and after: rounding
    CHECK(likelihood.counts(slow, u.size() - 1));
    CHECK(likelihood.stroke(slow, u.size() - 1) == 1);
    // Masked rows cost one unit each.
    const auto masked = std::count(late1.masked.begin(), late1.masked.end(), true);
    CHECK(masked >= 24); // 1 s, 0.4 s of which is excluded anyway, on either side
    CHECK(likelihood.maskPenalty(late).head(likelihood.rowsOf(slow)).sum() == static_cast<double>(masked));
    CHECK(likelihood.whitenedDifference(late, late)->norm() == 0.0);
    CHECK((*likelihood.whitenedDifference(late, exact))[likelihood.rowsOf(slow) - 1] ==
          Approx(1.0 / error).epsilon(1e-9));

    SECTION("a simulation without the jump is wrong in every row") {
        const auto never = at(data, ParameterPoint{{103.0, 0.08, 1.0}, {}});
        const Eigen::VectorXd n = likelihood.rawResidual(slow, never[slow]).rows;
        const double segment = data.runs[slow].segments[1].to - data.runs[slow].segments[1].from;
        CHECK(n[n.size() - 1] ==
              Approx(-LikelihoodSettings{}.jumpReach * segment).epsilon(1e-9)); // the largest allowed distance
        CHECK(likelihood.whiten(slow, n).norm() > 2.0 * u.norm());
    }
    SECTION("a jump in only one simulation has no derivative") {
        const auto never = at(data, ParameterPoint{{103.0, 0.08, 1.0}, {}});
        const Eigen::VectorXd gone = likelihood.rawDifference(slow, exact[slow], never[slow]).rows;
        CHECK(gone[gone.size() - 1] == 0.0);
        const auto early = at(data, ParameterPoint{{103.0, 0.08, 4.0e-3}, {}}); // out of reach, on the other side
        const Eigen::VectorXd e = likelihood.rawResidual(slow, early[slow]).rows;
        CHECK(e[e.size() - 1] > 1.0);
    }
    SECTION("jumps of other segments or too far away are other events") {
        const RecordedRun& run = data.runs[slow];
        std::vector<replay::Landmark> a(1), b(1);
        const DriveSegment& down = run.segments[1];
        a[0].time = down.from + 0.5;
        b[0].time = a[0].time + 0.9 * 0.2 * (down.to - down.from);
        CHECK(matchJumps(run, a, b, 0.2) == std::vector<int>{0});
        b[0].time = a[0].time + 1.1 * 0.2 * (down.to - down.from);
        CHECK(matchJumps(run, a, b, 0.2) == std::vector<int>{-1});
        a[0].time = down.to - 0.1;
        b[0].time = down.to + 0.1;
        CHECK(matchJumps(run, a, b, 0.2) == std::vector<int>{-1});
    }
    SECTION("pairs keep order, direction and segment") {
        const RecordedRun& run = data.runs[slow];
        const DriveSegment &down = run.segments[1], &up = run.segments[3];
        const auto jumps = [](std::initializer_list<double> times, bool rise = false) {
            std::vector<replay::Landmark> all;
            for (const double t : times)
                all.push_back({t, 0.0, rise ? 0.0 : 1.0, rise ? 1.0 : 0.0});
            return all;
        };
        const double t = down.from + 3.0;
        CHECK(matchJumps(run, jumps({t, t + 1.0}), jumps({t + 0.6, t + 1.6}), 0.2) == std::vector<int>{0, 1});
        CHECK(matchJumps(run, jumps({t}), jumps({t + 0.1}, true), 0.2) == std::vector<int>{-1});
        CHECK(matchJumps(run, jumps({up.from + 0.5}), jumps({down.to - 0.1, up.from + 1.5}), 0.2) ==
              std::vector<int>{1});
    }
}

TEST_CASE("rows near first contact of a viscous specimen and near reversals are excluded", "[diagnosis]") {
    // Rows beside abrupt reversals never count (tested below); here jumps must be visible.
    RecordedData data = toy::recordings(3);
    const toy::Spring spring(data);
    const std::size_t dashpot = 0, slow = 0, fast = 1;
    REQUIRE(spring.candidates()[dashpot].label == "dashpot");
    const ParameterPoint elastic{{103.0, 0.0}, {}},
        viscous{{103.0, 0.0}, {{dashpot, {20.0}}}}; // 20 and 100 mN at 1 and 5 mm/s
    Noise noise;
    noise.white = 0.01;
    // First contact is after one millimetre.
    const auto touched = [&](std::size_t r, const ParameterPoint& p) {
        Response out = spring.simulate(r, p, Fidelity::Fine, nullptr);
        for (Eigen::Index k = 0; k < out.force.size(); ++k) {
            const bool free = data.runs[r].displacement[k] < 1.01e-3;
            out.force[k] = free ? 0.0 : out.force[k] - 0.103;
        }
        return out;
    };
    LikelihoodSettings usual;
    usual.abruptReversal = 2.0; // larger than any change of speed
    const auto missing = [&](std::size_t r, const ParameterPoint& recorded, const ParameterPoint& simulated,
                             const LikelihoodSettings& s) {
        data.runs[r].force = touched(r, recorded).force;
        const Response there = touched(r, simulated);
        const ModelError errors = modelErrorOf(data.runs[r], noise, there, there, 1.0, s);
        std::vector<double> times;
        for (Eigen::Index k = 0; k < errors.force.size(); ++k)
            if (!std::isfinite(errors.force[k]))
                times.push_back(data.runs[r].time[k]);
        return times;
    };
    const double dt = data.runs[fast].spacing(), touch = 1.0 + 1e-3 / 5e-3, top = 1.0 + 0.01 / 5e-3;
    const auto near = [&](const std::vector<double>& times, double at) {
        return std::count_if(times.begin(), times.end(), [&](double t) { return std::abs(t - at) < 2.1 * dt; });
    };
    for (const bool recorded : {true, false}) { // in either of the two
        CAPTURE(recorded);
        const auto out = missing(fast, recorded ? viscous : elastic, recorded ? elastic : viscous, usual);
        CHECK(near(out, touch) == 2); // the last reading before and the first after
        CHECK(near(out, top) >= 2);
        CHECK(near(out, top) <= 4);
        CHECK(near(out, touch) + near(out, top) + near(out, top + 2.0) == static_cast<long>(out.size())); // no others
    }
    // The start of a slope is no jump, and noise hides small jumps.
    CHECK(missing(fast, elastic, elastic, usual).empty());
    CHECK(missing(slow, viscous, viscous, usual).empty());
    // The less accurate a contact is, the more readings are excluded: 0.2 mm are a row of the fast run.
    LikelihoodSettings wide = usual;
    wide.contactAccuracy = 5e-4;
    CHECK(near(missing(fast, viscous, viscous, wide), touch) > 2);
}

TEST_CASE("rows beside an abrupt reversal are excluded, rows of a ramp are not", "[diagnosis]") {
    // No drive reverses instantly.
    RecordedData data = toy::recordings(3);
    RecordedRun& run = data.runs.front();
    const Response there{{}, Eigen::VectorXd::Zero(run.time.size()), {}};
    run.force.setZero(); // no jump is visible at the reversals
    Noise noise;
    noise.white = 0.01;
    const double reach = LikelihoodSettings{}.reversalRows * run.spacing();
    const ModelError abrupt = modelErrorOf(run, noise, there, there, 1.0, {});
    for (Eigen::Index k = 0; k < run.time.size(); ++k) {
        double nearest = 1e9;
        for (std::size_t l = 1; l < run.segments.size(); ++l)
            nearest = std::min(nearest, std::abs(run.time[k] - run.segments[l].from));
        CAPTURE(run.time[k]);
        CHECK(std::isfinite(abrupt.force[k]) == (nearest >= reach));
    }
    // The same motion, each segment accelerating and decelerating in twelve steps.
    std::vector<DriveSegment> ramps;
    for (const DriveSegment& segment : run.segments) {
        constexpr int kSteps = 12;
        const double piece = (segment.to - segment.from) / (2 * kSteps);
        for (int i = 0; i < 2 * kSteps; ++i)
            ramps.push_back({segment.phase, segment.from + piece * i, segment.from + piece * (i + 1),
                             segment.speed * std::min(i + 0.5, 2 * kSteps - i - 0.5) / kSteps});
    }
    run.setDrive(std::move(ramps));
    CHECK(modelErrorOf(run, noise, there, there, 1.0, {}).force.allFinite());
}

TEST_CASE("noise is not taken for a snap", "[diagnosis]") {
    for (const std::uint64_t seed : {1, 2, 3}) {
        CAPTURE(seed);
        RecordedData data = toy::recordings(seed);
        std::vector<Response> there;
        Random random(seed);
        for (RecordedRun& run : data.runs) { // the peak is ten sigma of white noise
            there.push_back({{}, 10.0 * run.displacement, {}});
            run.force = there.back().force;
            for (double& f : run.force)
                f += 0.01 * random.normal();
        }
        Noise noise;
        noise.white = 0.01;
        const Likelihood likelihood(data, noise, there, there, toy::exact().likelihood);
        CHECK(likelihood.countedRows() == likelihood.rows());
        // A jump of fifteen sigma is a snap, whose rows are excluded.
        RecordedRun& slow = data.runs.front();
        slow.force.tail(slow.force.size() - 150).array() -= 0.15;
        const Likelihood snaps(data, noise, there, there, toy::exact().likelihood);
        REQUIRE(snaps.errors(0).snaps.size() == 1);
        CHECK(snaps.errors(0).snaps.front() == Approx(slow.time[150]).margin(2.0 * slow.spacing()));
        CHECK_FALSE(snaps.counts(0, 150));
        CHECK(std::abs(snaps.rows() - snaps.countedRows() - 10) <= 1); // .4 s of 25 readings/s
    }
}

TEST_CASE("with few rows nothing is significant or detectable", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    const auto exact = at(data, ParameterPoint{{103.0, 0.08, 1.0}, {}});
    for (RecordedRun& run : data.runs)
        run.force.tail(run.force.size() - 3).setConstant(std::nan(""));
    data.runs.resize(1); // three rows: a window has four
    Noise noise;
    noise.white = 0.01;
    const Likelihood likelihood(data, noise, {exact.front()}, {exact.front()}, toy::exact().likelihood);
    REQUIRE(likelihood.countedRows() == 3);
    const Eigen::VectorXd residual = Eigen::VectorXd::Constant(likelihood.rows(), 9.0);
    for (const Eigen::Index signatures : {0, 2}) {
        CAPTURE(signatures);
        const Localisation l =
            localise(likelihood, residual, {}, 1, 99, Eigen::MatrixXd::Identity(likelihood.rows(), signatures));
        CHECK(l.p == 1.0);
        CHECK(l.extendedP == 1.0);
        CHECK(l.significant.empty());
        CHECK(l.critical == std::numeric_limits<double>::infinity()); // no amplitude is detectable
    }
}

TEST_CASE("folds of a single run are intervals of time, markers included", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    data.runs.resize(1);
    const auto exact = at(data, ParameterPoint{{103.0, 0.08, 1.0}, {}});
    Noise noise;
    noise.white = 0.01;
    RecordedRun& run = data.runs.front();
    const Eigen::Index n = run.time.size();
    std::vector<int> fifths;
    for (Eigen::Index k = 0; k < n; ++k)
        fifths.push_back(static_cast<int>(5 * k / n));
    CHECK(groupingOf(Likelihood(data, noise, {exact.front()}, {exact.front()}, toy::exact().likelihood)).fold ==
          fifths);

    toy::withMarkers(data, {0.3, 0.7}, 3);
    const Eigen::Index seen = run.markerTime.size();
    Response there = exact.front();
    there.markers = run.markers;
    LikelihoodSettings settings = toy::exact().likelihood;
    settings.releaseOscillation = 0.0; // all rows count
    const Likelihood likelihood(data, noise, {there}, {there}, settings);
    const Grouping g = groupingOf(likelihood);
    REQUIRE(g.folds == 5);
    REQUIRE(std::all_of(g.fold.begin(), g.fold.end(), [](int f) { return f >= 0; }));
    std::vector<double> first(5, 1e9), last(5, 0.0), force(5, 0.0), markers(5, 0.0);
    for (Eigen::Index k = 0; k < likelihood.rows(); ++k) {
        const bool byForce = likelihood.isForce(0, k);
        const double t = byForce ? run.time[k] : run.markerTime[(k - n) % seen];
        const auto f = static_cast<std::size_t>(g.fold[static_cast<std::size_t>(k)]);
        first[f] = std::min(first[f], t);
        last[f] = std::max(last[f], t);
        (byForce ? force : markers)[f] += 1.0;
    }
    for (std::size_t f = 0; f < 5; ++f) {
        CAPTURE(f);
        CHECK(force[f] == Approx(static_cast<double>(n) / 5.0).margin(4.0));
        CHECK(markers[f] == Approx(4.0 * static_cast<double>(seen) / 5.0).margin(8.0));
        if (f > 0)
            CHECK(first[f] > last[f - 1]);
    }
}

TEST_CASE("masked rows are interpolated between rows that count", "[diagnosis]") {
    const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(11, 0.0, 10.0);
    Eigen::VectorXd errors = Eigen::VectorXd::Ones(11), d = 2.0 * time;
    errors[3] = std::numeric_limits<double>::infinity();
    d[3] = 77.0;
    d.segment(4, 3).setConstant(1e3);
    interpolateMasked(d, time, errors, rowsInside({{3.5, 6.5}}, time));
    CHECK(d[3] == 77.0);
    for (const Eigen::Index k : {4, 5, 6})
        CHECK(d[k] == Approx(2.0 * time[k]).epsilon(1e-12)); // from 0, 1, 2 and 7, 8, 9
    d.tail(6).setConstant(1e3);
    interpolateMasked(d, time, errors, rowsInside({{4.5, 20.0}}, time)); // no rows after it: constant
    CHECK(d[10] == Approx((2.0 * time[1] + 2.0 * time[2] + 2.0 * time[4]) / 3.0));
}

TEST_CASE("neighbouring masked ranges are independent", "[diagnosis]") {
    // 1.4 N too large from 2.5 to 5.5 and from 6.5 to 8.5; the row between counts and is correct.
    const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(13, 0.0, 12.0), errors = Eigen::VectorXd::Ones(13);
    Eigen::VectorXd d = Eigen::VectorXd::Zero(13);
    d.segment(3, 3).setConstant(1.4);
    d.segment(7, 2).setConstant(1.4);
    interpolateMasked(d, time, errors, rowsInside({{2.5, 5.5}, {6.5, 8.5}}, time));
    CHECK(d.cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("a jump without a simulated partner is significant", "[diagnosis]") {
    RecordedData data = latched(11, 6.437e-3);
    const RecordedData elsewhere = latched(11, 6.737e-3); // 0.3 mm in one run only: 13 sigma
    data.runs[0] = elsewhere.runs[0];
    const auto exact = at(data, ParameterPoint{{103.0, 0.08, 6.437e-3}, {}});
    const Likelihood likelihood(data, estimateNoise(data), exact, exact, {});
    const Localisation l = localise(likelihood, *likelihood.residual(exact), {}, 1, 199);
    CHECK(l.p <= 0.01);
    REQUIRE_FALSE(l.significant.empty());
    CHECK(l.significant.front().timeFrom == Approx(1.0 + 6.737 - 0.1).margin(0.05));
}

TEST_CASE("the time of a jump guides a fit and has an error in predictions", "[diagnosis]") {
    constexpr double kPlace = 6.437e-3;
    const RecordedData data = latched(11, kPlace);
    const Latch model(data);
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const Diagnosis d = diagnose(data, evaluator, toy::exact(1));
    INFO(d.verdict << ": nothing " << d.adequate << ", p " << d.misfit.p);
    CHECK(d.verdict == "adequate");
    CHECK(d.adequate > 0.5);
    // Known to 0.02 mm of simulation and a fraction of a row (0.04, 0.08 and 0.2 mm) in three runs; three times that.
    CHECK(d.nominal.back().fitted == Approx(kPlace).margin(6e-5));
}
