// Jumps of the force as observations of their place, on a spring with a latch that springs open at a place.

#include "toy.h"

#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/likelihood/jumps.h"
#include "plugin/identification/diagnosis/localisation/localise.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/selection/heldout.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

namespace replay = supercircle::replay;
using namespace supercircle::diagnosis;

namespace {

constexpr double kDrop = 0.5, kTravel = 0.01; // N, m

/// The toy's spring, whose force falls by half a newton for the rest of the run where it first passes a place.
class Latch final : public toy::Spring {
public:
    explicit Latch(const Data& data) : Spring(data), nominal_(Spring::nominal()) {
        nominal_.push_back({"place", "m", "", 6e-3, 4e-3, 8e-3, 1e-3, Scale::Linear, false});
    }
    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] std::string identity() const override { return "spring with a latch"; }

private:
    void alter(std::size_t r, const Point& p, Response& out) const override {
        const Leg& down = data_.runs[r].legs[1];
        const double open = down.from + p.nominal[2] / down.speed; // s
        for (Eigen::Index k = 0; k < out.force.size(); ++k)
            out.force[k] -= data_.runs[r].time[k] > open ? kDrop : 0.0;
        out.jumps = Eigen::VectorXd::Constant(1, open);
    }

    std::vector<Scalar> nominal_;
};

Data latched(std::uint64_t seed, double place) {
    Data data = toy::recordings(seed);
    const Latch model(data);
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        data.runs[r].force +=
            model.simulate(r, Point{{103.0, 0.08, place}, {}}, Fineness::Fine, nullptr).force -
            model.simulate(r, Point{{103.0, 0.08, 1.0}, {}}, Fineness::Fine, nullptr).force; // beyond the travel
    return data;
}

std::vector<Response> at(const Data& data, const Point& p) {
    const Latch model(data);
    std::vector<Response> all;
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        all.push_back(model.simulate(r, p, Fineness::Fine, nullptr));
    return all;
}

/// The same drive, given in pieces of a length.
RecordedRun inPieces(RecordedRun run, double length) {
    std::vector<Leg> pieces;
    for (const Leg& leg : run.legs) {
        const double n = std::ceil((leg.to - leg.from) / length);
        for (double i = 0.0; i < n; ++i) {
            pieces.push_back(leg);
            pieces.back().from = leg.from + i / n * (leg.to - leg.from);
            pieces.back().to = i + 1.0 < n ? leg.from + (i + 1.0) / n * (leg.to - leg.from) : leg.to;
        }
    }
    run.drivenBy(std::move(pieces));
    return run;
}

} // namespace

TEST_CASE("in how many pieces a drive is given changes nothing", "[diagnosis]") {
    Data whole = latched(11, 6.437e-3);
    RecordedRun& seen = toy::withMarkers(whole, {0.5});
    seen.markers = 1e-4 * Eigen::VectorXd::LinSpaced(2 * seen.time.size(), 0.0, 20.0).array().sin();
    Data pieces = whole;
    for (RecordedRun& run : pieces.runs)
        run = inPieces(run, 0.05);
    auto late = at(whole, Point{{103.0, 0.08, 6.737e-3}, {}});
    late.front().markers = Eigen::VectorXd::Zero(seen.markers.size());
    const Noise noise = estimateNoise(whole);
    for (const std::size_t runs : {3, 1}) { // groups are runs, or stretches of the only one
        CAPTURE(runs);
        whole.runs.resize(runs);
        pieces.runs.resize(runs);
        late.resize(runs);
        const Misfit a(whole, noise, late, late), b(pieces, noise, late, late);
        REQUIRE(a.rows() == b.rows());
        for (std::size_t r = 0; r < runs; ++r) {
            CHECK(a.jumps(r).size() == 1);
            CHECK(b.jumps(r).size() == 1);
            CHECK(b.errors(r).memory == a.errors(r).memory);
        }
        CHECK(*b.residual(late) == *a.residual(late));
        Random random(5); // the transposed map, where landings and places of a marker overlap and jumps are rows
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
        CHECK(m.family == l.family);
        CHECK(m.p == l.p);
    }
}

TEST_CASE("a smooth start and a short rest are no turning points", "[diagnosis]") {
    RecordedRun run;
    run.time = Eigen::VectorXd::LinSpaced(1001, 0.0, 10.0); // rows 10 ms apart
    run.drivenBy({{Phase::Hold, 0.0, 0.5, 0.0},
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
    for (const Leg& leg : run.legs)
        of.push_back(leg.stroke);
    CHECK(of == std::vector<std::size_t>{0, 0, 1, 1, 1, 1, 1, 2, 3, 4, 5, 6, 7});
    CHECK(&run.strokeAt(3.01) == &run.strokes[1]); // the short rest
    CHECK(run.stroke(501) == 2);
    CHECK(atTurningPoint(run, 1.05));
    CHECK_FALSE(atTurningPoint(run, 1.2)); // 50 ms ramps end at 1.1 s
    CHECK_FALSE(atTurningPoint(run, 3.02));
    CHECK(atTurningPoint(run, 6.02));
    CHECK(reachOf(run, 1.07, 0.2) == Approx(0.2 * 4.0));
}

TEST_CASE("a jump that comes late is one observation, not one in every row it is late by", "[diagnosis]") {
    const Point truth{{103.0, 0.08, 6.437e-3}, {}};
    Data data = latched(3, 6.437e-3);
    const auto exact = at(data, truth);
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        data.runs[r].force = exact[r].force; // no noise
    Noise noise;
    noise.white = 0.01;
    const Misfit misfit(data, noise, exact, exact, {});
    const std::size_t slow = 0; // 1 mm/s, 25 readings/s: 1 mm takes 25 rows
    REQUIRE(misfit.jumps(slow).size() == 1);
    const Eigen::VectorXd there = misfit.departure(slow, exact[slow]).rows;
    // A recorded jump lies somewhere between two readings.
    CHECK(std::abs(there[there.size() - 1]) <= 0.5 / 25.0 + 1e-12);
    const auto late = at(data, Point{{103.0, 0.08, 7.437e-3}, {}});
    const Departure late1 = misfit.departure(slow, late[slow]);
    const Eigen::VectorXd& d = late1.rows;
    CHECK(d[d.size() - 1] - there[there.size() - 1] == Approx(-1.0).epsilon(1e-9)); // s
    // Its error: of a uniform distribution between two readings, and of the simulated place.
    const double error =
        std::hypot(data.runs[slow].spacing() / std::sqrt(12.0), MisfitSettings{}.jumpPlace * kTravel / 1e-3);
    const Eigen::VectorXd u = misfit.whiten(slow, d);
    CHECK(u[u.size() - 1] == Approx(d[d.size() - 1] / error).epsilon(1e-9));
    CHECK(u.head(u.size() - 1).cwiseAbs().maxCoeff() < 1e-9); // equal before and behind: rounding
    CHECK(misfit.counts(slow, u.size() - 1));
    CHECK(misfit.stroke(slow, u.size() - 1) == 1);
    // Rows that say nothing are worth nothing: one unit each.
    const auto hidden = std::count(late1.hidden.begin(), late1.hidden.end(), true);
    CHECK(hidden >= 24); // 1 s, .4 s of which is left out anyway, on either side of it
    CHECK(misfit.charge(late).head(misfit.rowsOf(slow)).sum() == static_cast<double>(hidden));
    CHECK(misfit.difference(late, late)->norm() == 0.0);
    CHECK((*misfit.difference(late, exact))[misfit.rowsOf(slow) - 1] == Approx(1.0 / error).epsilon(1e-9));

    SECTION("a simulation without the jump is wrong in every row") {
        const auto never = at(data, Point{{103.0, 0.08, 1.0}, {}});
        const Eigen::VectorXd n = misfit.departure(slow, never[slow]).rows;
        const double leg = data.runs[slow].legs[1].to - data.runs[slow].legs[1].from;
        CHECK(n[n.size() - 1] == Approx(-MisfitSettings{}.jumpFarthest * leg).epsilon(1e-9)); // as late as may be
        CHECK(misfit.whiten(slow, n).norm() > 2.0 * u.norm());
    }
    SECTION("a jump that comes or goes is no derivative") {
        const auto never = at(data, Point{{103.0, 0.08, 1.0}, {}});
        const Eigen::VectorXd gone = misfit.change(slow, exact[slow], never[slow]).rows;
        CHECK(gone[gone.size() - 1] == 0.0);
        const auto early = at(data, Point{{103.0, 0.08, 4.0e-3}, {}}); // out of reach, on the other side
        const Eigen::VectorXd e = misfit.departure(slow, early[slow]).rows;
        CHECK(e[e.size() - 1] > 1.0);
    }
    SECTION("jumps of other legs, and too far away, are other events") {
        const RecordedRun& run = data.runs[slow];
        std::vector<replay::Landmark> a(1), b(1);
        const Leg& down = run.legs[1];
        a[0].time = down.from + 0.5;
        b[0].time = a[0].time + 0.9 * 0.2 * (down.to - down.from);
        CHECK(sameJumps(run, a, b, 0.2) == std::vector<int>{0});
        b[0].time = a[0].time + 1.1 * 0.2 * (down.to - down.from);
        CHECK(sameJumps(run, a, b, 0.2) == std::vector<int>{-1});
        a[0].time = down.to - 0.1;
        b[0].time = down.to + 0.1;
        CHECK(sameJumps(run, a, b, 0.2) == std::vector<int>{-1});
    }
    SECTION("pairs keep their order, directions too, and none is spent on another leg") {
        const RecordedRun& run = data.runs[slow];
        const Leg &down = run.legs[1], &up = run.legs[3];
        const auto jumps = [](std::initializer_list<double> times, bool rise = false) {
            std::vector<replay::Landmark> all;
            for (const double t : times)
                all.push_back({t, 0.0, rise ? 0.0 : 1.0, rise ? 1.0 : 0.0});
            return all;
        };
        const double t = down.from + 3.0;
        CHECK(sameJumps(run, jumps({t, t + 1.0}), jumps({t + 0.6, t + 1.6}), 0.2) == std::vector<int>{0, 1});
        CHECK(sameJumps(run, jumps({t}), jumps({t + 0.1}, true), 0.2) == std::vector<int>{-1});
        CHECK(sameJumps(run, jumps({up.from + 0.5}), jumps({down.to - 0.1, up.from + 1.5}), 0.2) ==
              std::vector<int>{1});
    }
}

TEST_CASE("where a viscous specimen is touched, and where its machine turns round, rows say nothing", "[diagnosis]") {
    // (Rows beside abrupt turns never count, see below. Here jumps have to be seen.)
    Data data = toy::recordings(3);
    const toy::Spring spring(data);
    const std::size_t dashpot = 0, slow = 0, fast = 1;
    REQUIRE(spring.candidates()[dashpot].label == "dashpot");
    const Point elastic{{103.0, 0.0}, {}}, viscous{{103.0, 0.0}, {{dashpot, {20.0}}}}; // 20 and 100 mN at 1 and 5 mm/s
    Noise noise;
    noise.white = 0.01;
    // A millimetre is driven before the spring is touched.
    const auto touched = [&](std::size_t r, const Point& p) {
        Response out = spring.simulate(r, p, Fineness::Fine, nullptr);
        for (Eigen::Index k = 0; k < out.force.size(); ++k) {
            const bool free = data.runs[r].displacement[k] < 1.01e-3;
            out.force[k] = free ? 0.0 : out.force[k] - 0.103;
        }
        return out;
    };
    MisfitSettings usual;
    usual.turnAtOnce = 2.0; // no change of speed is as large
    const auto missing = [&](std::size_t r, const Point& recorded, const Point& simulated, const MisfitSettings& s) {
        data.runs[r].force = touched(r, recorded).force;
        const Response there = touched(r, simulated);
        const RowErrors errors = rowErrors(data.runs[r], noise, there, there, 1.0, s);
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
    for (const bool recorded : {true, false}) { // whichever of the two shows it
        CAPTURE(recorded);
        const auto out = missing(fast, recorded ? viscous : elastic, recorded ? elastic : viscous, usual);
        CHECK(near(out, touch) == 2); // the last reading ahead of it and the first behind
        CHECK(near(out, top) >= 2);
        CHECK(near(out, top) <= 4);
        CHECK(near(out, touch) + near(out, top) + near(out, top + 2.0) == static_cast<long>(out.size())); // no others
    }
    // A slope that begins is no jump, and what the noise hides is none.
    CHECK(missing(fast, elastic, elastic, usual).empty());
    CHECK(missing(slow, viscous, viscous, usual).empty());
    // The further a touch may be off, the more readings may have seen it: .2 mm are a row of the fast run.
    MisfitSettings wide = usual;
    wide.touchPlace = 5e-4;
    CHECK(near(missing(fast, viscous, viscous, wide), touch) > 2);
}

TEST_CASE("rows beside an abrupt turn of the drive do not count, rows of a ramp do", "[diagnosis]") {
    // No machine turns round in no time: of five repeats such rows made a wrong gain of a misalignment.
    Data data = toy::recordings(3);
    RecordedRun& run = data.runs.front();
    const Response there{{}, Eigen::VectorXd::Zero(run.time.size()), {}};
    run.force.setZero(); // nothing can be seen at the turns
    Noise noise;
    noise.white = 0.01;
    const double reach = MisfitSettings{}.turnRows * run.spacing();
    const RowErrors abrupt = rowErrors(run, noise, there, there, 1.0, {});
    for (Eigen::Index k = 0; k < run.time.size(); ++k) {
        double nearest = 1e9;
        for (std::size_t l = 1; l < run.legs.size(); ++l)
            nearest = std::min(nearest, std::abs(run.time[k] - run.legs[l].from));
        CAPTURE(run.time[k]);
        CHECK(std::isfinite(abrupt.force[k]) == (nearest >= reach));
    }
    // The same way in which each leg speeds up and slows down in twelve steps.
    std::vector<Leg> ramps;
    for (const Leg& leg : run.legs) {
        constexpr int kSteps = 12;
        const double piece = (leg.to - leg.from) / (2 * kSteps);
        for (int i = 0; i < 2 * kSteps; ++i)
            ramps.push_back({leg.phase, leg.from + piece * i, leg.from + piece * (i + 1),
                             leg.speed * std::min(i + 0.5, 2 * kSteps - i - 0.5) / kSteps});
    }
    run.drivenBy(std::move(ramps));
    CHECK(rowErrors(run, noise, there, there, 1.0, {}).force.allFinite());
}

TEST_CASE("noise is no snap", "[diagnosis]") {
    for (const std::uint64_t seed : {1, 2, 3}) {
        CAPTURE(seed);
        Data data = toy::recordings(seed);
        std::vector<Response> there;
        Random random(seed);
        for (RecordedRun& run : data.runs) { // the peak is ten deviations of white noise
            there.push_back({{}, 10.0 * run.displacement, {}});
            run.force = there.back().force;
            for (double& f : run.force)
                f += 0.01 * random.normal();
        }
        Noise noise;
        noise.white = 0.01;
        const Misfit misfit(data, noise, there, there, toy::exact().misfit);
        CHECK(misfit.present() == misfit.rows());
        // One of fifteen deviations is a snap, whose rows say nothing.
        RecordedRun& slow = data.runs.front();
        slow.force.tail(slow.force.size() - 150).array() -= 0.15;
        const Misfit snaps(data, noise, there, there, toy::exact().misfit);
        REQUIRE(snaps.errors(0).snaps.size() == 1);
        CHECK(snaps.errors(0).snaps.front() == Approx(slow.time[150]).margin(2.0 * slow.spacing()));
        CHECK_FALSE(snaps.counts(0, 150));
        CHECK(std::abs(snaps.rows() - snaps.present() - 10) <= 1); // .4 s of 25 readings/s
    }
}

TEST_CASE("where hardly a row counts nothing stands out, and nothing could", "[diagnosis]") {
    Data data = toy::recordings(3);
    const auto exact = at(data, Point{{103.0, 0.08, 1.0}, {}});
    for (RecordedRun& run : data.runs)
        run.force.tail(run.force.size() - 3).setConstant(std::nan(""));
    data.runs.resize(1); // three rows: a window has four
    Noise noise;
    noise.white = 0.01;
    const Misfit misfit(data, noise, {exact.front()}, {exact.front()}, toy::exact().misfit);
    REQUIRE(misfit.present() == 3);
    const Eigen::VectorXd residual = Eigen::VectorXd::Constant(misfit.rows(), 9.0);
    for (const Eigen::Index signatures : {0, 2}) {
        CAPTURE(signatures);
        const Localisation l =
            localise(misfit, residual, {}, 1, 99, Eigen::MatrixXd::Identity(misfit.rows(), signatures));
        CHECK(l.p == 1.0);
        CHECK(l.tail == 1.0);
        CHECK(l.significant.empty());
        CHECK(l.critical == std::numeric_limits<double>::infinity()); // no size of an effect is visible
    }
}

TEST_CASE("stretches of a single run are stretches of time, markers and all", "[diagnosis]") {
    Data data = toy::recordings(3);
    data.runs.resize(1);
    const auto exact = at(data, Point{{103.0, 0.08, 1.0}, {}});
    Noise noise;
    noise.white = 0.01;
    RecordedRun& run = data.runs.front();
    const Eigen::Index n = run.time.size();
    std::vector<int> fifths;
    for (Eigen::Index k = 0; k < n; ++k)
        fifths.push_back(static_cast<int>(5 * k / n));
    CHECK(groupingOf(Misfit(data, noise, {exact.front()}, {exact.front()}, toy::exact().misfit)).fold == fifths);

    toy::withMarkers(data, {0.3, 0.7}, 3);
    const Eigen::Index seen = run.markerTime.size();
    Response there = exact.front();
    there.markers = run.markers;
    MisfitSettings settings = toy::exact().misfit;
    settings.swing = 0.0; // all rows count
    const Misfit misfit(data, noise, {there}, {there}, settings);
    const Grouping g = groupingOf(misfit);
    REQUIRE(g.folds == 5);
    REQUIRE(std::all_of(g.fold.begin(), g.fold.end(), [](int f) { return f >= 0; }));
    std::vector<double> first(5, 1e9), last(5, 0.0), force(5, 0.0), markers(5, 0.0);
    for (Eigen::Index k = 0; k < misfit.rows(); ++k) {
        const bool byForce = misfit.isForce(0, k);
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

TEST_CASE("a bridge is a straight line between what counts on either side", "[diagnosis]") {
    const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(11, 0.0, 10.0);
    Eigen::VectorXd errors = Eigen::VectorXd::Ones(11), d = 2.0 * time;
    errors[3] = std::numeric_limits<double>::infinity();
    d[3] = 77.0;
    d.segment(4, 3).setConstant(1e3);
    bridge(d, time, errors, rowsIn({{3.5, 6.5}}, time));
    CHECK(d[3] == 77.0);
    for (const Eigen::Index k : {4, 5, 6})
        CHECK(d[k] == Approx(2.0 * time[k]).epsilon(1e-12)); // from 0, 1, 2 and 7, 8, 9
    d.tail(6).setConstant(1e3);
    bridge(d, time, errors, rowsIn({{4.5, 20.0}}, time)); // nothing behind it: as before it
    CHECK(d[10] == Approx((2.0 * time[1] + 2.0 * time[2] + 2.0 * time[4]) / 3.0));
}

TEST_CASE("bridges of neighbours do not lean on each other", "[diagnosis]") {
    // 1.4 N too much from 2.5 to 5.5 and from 6.5 to 8.5; the row between counts and is right.
    const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(13, 0.0, 12.0), errors = Eigen::VectorXd::Ones(13);
    Eigen::VectorXd d = Eigen::VectorXd::Zero(13);
    d.segment(3, 3).setConstant(1.4);
    d.segment(7, 2).setConstant(1.4);
    bridge(d, time, errors, rowsIn({{2.5, 5.5}, {6.5, 8.5}}, time));
    CHECK(d.cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("a jump that nothing reconciles with the simulation stands out", "[diagnosis]") {
    Data data = latched(11, 6.437e-3);
    const Data elsewhere = latched(11, 6.737e-3); // .3 mm, in one run only: 13 deviations
    data.runs[0] = elsewhere.runs[0];
    const auto exact = at(data, Point{{103.0, 0.08, 6.437e-3}, {}});
    const Misfit misfit(data, estimateNoise(data), exact, exact, {});
    const Localisation l = localise(misfit, *misfit.residual(exact), {}, 1, 199);
    CHECK(l.p <= 0.01);
    REQUIRE_FALSE(l.significant.empty());
    CHECK(l.significant.front().timeFrom == Approx(1.0 + 6.737 - 0.1).margin(0.05));
}

TEST_CASE("a fit is led by where a jump happens, and a forecast knows how far that is uncertain", "[diagnosis]") {
    constexpr double kPlace = 6.437e-3;
    const Data data = latched(11, kPlace);
    const Latch model(data);
    Store store;
    Evaluator evaluator(model, data.runs.size(), {}, store);
    const Diagnosis d = diagnose(data, evaluator, toy::exact(1));
    INFO(d.verdict << ": nothing " << d.nothing << ", p " << d.mismatch.p);
    CHECK(d.verdict == "nothing_missing");
    CHECK(d.nothing > 0.5);
    // Known to .02 mm of simulation and a fraction of a row (.04, .08 and .2 mm) in three runs; three times that.
    CHECK(d.nominal.back().fitted == Approx(kPlace).margin(6e-5));
}
