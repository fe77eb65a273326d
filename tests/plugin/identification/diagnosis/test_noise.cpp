#include "toy.h"

#include "plugin/identification/diagnosis/likelihood/whitening.h"
#include "plugin/identification/diagnosis/noise.h"

#include <catch2/catch.hpp>
#include <functional>

using namespace supercircle::diagnosis;

namespace {

const double kTotal = std::hypot(toy::kWhite, toy::kColoured);

/// Recordings in which nothing is missing, their noise `times` as large as they state.
Data noisier(std::uint64_t seed, double times, double cubic = 0.0) {
    Data data = toy::recordings(seed, "cubic", cubic);
    const toy::Spring spring(data);
    const Point truth{{103.0, 0.08}, {{2, {cubic}}}};
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const Eigen::VectorXd quiet = spring.simulate(r, truth, Fineness::Fine, nullptr).force;
        data.runs[r].force = quiet + times * (data.runs[r].force - quiet);
    }
    return data;
}

/// In steps of `size`.
double stepped(double v, double size) {
    return size * std::round(v / size);
}

Diagnosis diagnosisOf(const Data& data) {
    const toy::Spring spring(data);
    Store store;
    Evaluator evaluator(spring, data.runs.size(), {}, store);
    return diagnose(data, evaluator, toy::exact());
}

} // namespace

TEST_CASE("noise that is not what is stated is found, and is no physics", "[diagnosis]") {
    for (const double times : {0.04, 0.2, 5.0, 100.0})
        for (const std::uint64_t seed : {1, 2, 3}) {
            CAPTURE(times, seed);
            const Noise noise = estimateNoise(noisier(seed, times));
            CHECK(noise.total() == Approx(times * kTotal).epsilon(0.2));
            CHECK(noise.white == Approx(times * toy::kWhite).epsilon(0.1));
            CHECK_THAT(noise.source, Catch::Contains("the stated noise of 0.01 N was found to be "));
            CHECK_THAT(noise.source, !Catch::Contains("prior"));
        }
    for (const std::uint64_t seed : {11, 12, 13}) {
        const Diagnosis d = diagnosisOf(noisier(seed, 5.0));
        INFO(d.statement);
        CHECK((d.verdict == "nothing_missing" || d.verdict == "not_enough_information"));
        CHECK(d.baselinePerRow == Approx(1.0).margin(0.15)); // 25 with the stated noise
    }
}

TEST_CASE("noise within what is stated keeps the stated size as a prior", "[diagnosis]") {
    for (const double times : {0.7, 1.0, 1.3}) {
        const Noise noise = estimateNoise(noisier(4, times));
        CHECK(noise.total() == Approx(times * kTotal).epsilon(0.2));
        CHECK_THAT(noise.source, Catch::Contains(", with the stated size as a prior; no repeats"));
    }
}

TEST_CASE("repeats that differ by noise alone scatter by nothing, and others by what they do", "[diagnosis]") {
    for (const double step : {0.0, 0.6 * kTotal, 1.0 * kTotal}) { // readings come in steps that are as large as noise
        int scatters = 0;
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
            Data data = toy::recordings(seed);
            data.runs.resize(1);
            const toy::Spring spring(data);
            const Eigen::VectorXd quiet = spring.simulate(0, {{103.0, 0.08}, {}}, Fineness::Fine, nullptr).force;
            data.runs.resize(3, data.runs.front());
            Random random(100 + seed);
            for (RecordedRun& run : data.runs) {
                run.force = quiet;
                toy::addNoise(run, random);
                for (double& f : run.force)
                    f = step > 0.0 ? stepped(f, step) : f;
            }
            const Noise alone = estimateNoise(data);
            CHECK(alone.repeats == 2); // runs, not pairs
            scatters += alone.runToRun > 0.0 ? 1 : 0;
            for (std::size_t r = 0; r < 3; ++r) // a seat that is another one each time, and wanders
                for (Eigen::Index k = 0; k < quiet.size(); ++k)
                    data.runs[r].force[k] +=
                        3.0 * kTotal * std::sin(0.9 * data.runs[r].time[k] + 2.0 * static_cast<double>(r));
            // Sines a third of a period apart differ by a sine sqrt(3) times as large.
            CHECK(estimateNoise(data).runToRun == Approx(3.0 * kTotal * std::sqrt(0.75)).epsilon(0.25));
        }
        CHECK(scatters <= 1); // of 20, each with a chance of one in a thousand, more where memories are few
    }
}

TEST_CASE("bends of a curve are no noise of a quiet sensor", "[diagnosis]") {
    Data data = noisier(7, 1e-4, 4e5); // second differences of the cubic law are up to 1 mN, a thousand times the noise
    data.statedForceNoise = 1e-6;
    const Noise noise = estimateNoise(data);
    CHECK(noise.total() < 4e-6);
    CHECK_THAT(noise.source, Catch::Contains(", with the stated size as a prior; no repeats"));
}

TEST_CASE("what only neighbouring rows show does not refute what is stated", "[diagnosis]") {
    Data data = noisier(8, 0.1);
    for (RecordedRun& run : data.runs)
        for (Leg& leg : run.legs) // nothing rests: a noise of some seconds would not show
            leg.phase = Phase::Loading;
    CHECK_THAT(estimateNoise(data).source, Catch::StartsWith("neighbouring rows of all runs, with the stated size"));
    data = noisier(8, 5.0);
    for (RecordedRun& run : data.runs)
        for (Leg& leg : run.legs)
            leg.phase = Phase::Loading;
    CHECK(estimateNoise(data).white == Approx(5.0 * toy::kWhite).epsilon(0.2));
}

TEST_CASE("readings of a steep curve are far apart, and in no steps", "[diagnosis]") {
    Data data = toy::recordings(9);
    data.runs.resize(1);
    RecordedRun& run = data.runs.front();
    run.time = Eigen::VectorXd::LinSpaced(21, 0.0, 20.0);
    run.displacement = 1e-3 * run.time;
    run.drivenBy({{Phase::Loading, 0.0, 20.0, 1e-3}});
    run.force = Eigen::VectorXd::LinSpaced(21, 0.0, 16.0); // .8 N from row to row, as exact as it is read
    for (Eigen::Index k = 0; k < 21; ++k)
        run.force[k] = stepped(run.force[k] + 0.01 * std::sin(5.0 * static_cast<double>(k)), 1e-3);
    CHECK(estimateNoise(data).total() == Approx(0.01).epsilon(0.3));
}

TEST_CASE("noise that nobody stated is as large as it is", "[diagnosis]") {
    for (const double times : {0.04, 5.0}) {
        Data data = noisier(5, times);
        data.statedForceNoise = 0.0;
        const Noise noise = estimateNoise(data);
        CHECK(noise.total() == Approx(times * kTotal).epsilon(0.2));
        CHECK_THAT(noise.source, !Catch::Contains("stated"));
    }
}

namespace {

/// One marker on a machine that never rests.
Data moving(const std::function<double(double)>& track, double deviation) {
    Data data;
    data.runs = {toy::motion("slow", 1e-3, 25.0)};
    RecordedRun& run = toy::withMarkers(data, {0.5});
    data.statedMarkerNoise = 0.0;
    const Eigen::Index n = run.time.size();
    run.drivenBy({{Phase::Loading, 0.0, run.time[n - 1], 1e-3}});
    Random random(6);
    for (Eigen::Index k = 0; k < 2 * n; ++k)
        run.markers[k] = track(run.time[k % n]) + deviation * random.normal();
    return data;
}

} // namespace

TEST_CASE("the noise of markers is never taken for zero where it can be told", "[diagnosis]") {
    const auto bends = [](double t) { return 5e-3 * std::sin(0.3 * t); };
    // 2 x 600 fourth differences: the median of absolute values of such correlated ones scatters by some 5 %.
    Data shaken = moving(bends, 2e-5);
    CHECK(estimateNoise(shaken).marker == Approx(2e-5).epsilon(0.2));
    shaken.statedMarkerNoise = 3e-5;
    CHECK(estimateNoise(shaken).marker == 3e-5); // nothing rests: it is as stated
    const Data coarse = moving([&](double t) { return stepped(bends(t), 1e-3); }, 0.0);
    CHECK(estimateNoise(coarse).marker == Approx(1e-3 / std::sqrt(12.0)));
    const Data apart = moving([&](double t) { return t < 5.0 ? 0.0 : 1e-3; }, 0.0);
    CHECK(estimateNoise(apart).marker == Approx(1e-3 / std::sqrt(12.0)));
    CHECK(estimateNoise(moving([](double) { return 1.0; }, 0.0)).marker == 0.0);
    Data free = shaken;
    free.free = true;
    free.statedMarkerNoise = 0.0;
    CHECK(estimateNoise(free).marker == Approx(2e-5).epsilon(0.2));
}

TEST_CASE("the noise of short runs that nobody stated is told from all of them", "[diagnosis]") {
    double sum = 0.0;
    constexpr int kTrials = 10;
    for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
        Data data = toy::recordings(seed);
        data.statedForceNoise = 0.0;
        for (RecordedRun& run : data.runs) { // 22 rows, all of them on the way down
            run.time = run.time.segment(30, 22).eval();
            run.displacement = run.displacement.segment(30, 22).eval();
            run.force = run.force.segment(30, 22).eval();
            run.drivenBy({{Phase::Loading, run.time[0], run.time[21], run.legs[1].speed}});
        }
        const Noise noise = estimateNoise(data);
        CHECK(noise.white > 0.0);
        sum += noise.white / kTrials;
    }
    CHECK(sum == Approx(toy::kWhite).epsilon(0.15)); // 54 differences each, 30 % of luck, 10 % in the mean
}

TEST_CASE("no noise is smaller than the steps of the readings", "[diagnosis]") {
    constexpr double kStep = 0.05; // N, five times the noise
    for (const double stated : {0.0, 0.01}) {
        Data data = toy::recordings(3);
        data.statedForceNoise = stated;
        for (RecordedRun& run : data.runs)
            for (double& f : run.force)
                f = stepped(f, kStep);
        const Noise noise = estimateNoise(data);
        CHECK(noise.white >= Approx(kStep / std::sqrt(12.0)));
        CHECK(noise.total() < kStep);
        data.free = true;
        CHECK(estimateNoise(data).white >= Approx(kStep / std::sqrt(12.0)));
    }
    Data data = toy::recordings(3); // two readings only, nothing stated
    data.statedForceNoise = 0.0;
    for (RecordedRun& run : data.runs)
        for (double& f : run.force)
            f = f > 0.5 ? 1.0 : 0.0;
    CHECK(estimateNoise(data).total() > 0.1);
}

TEST_CASE("without any noise nothing is said, in words", "[diagnosis]") {
    for (const bool free : {false, true}) {
        Data data = toy::recordings(3);
        data.free = free;
        data.statedForceNoise = 0.0;
        for (RecordedRun& run : data.runs)
            run.force.setConstant(0.5);
        const Diagnosis d = diagnosisOf(data);
        CHECK(d.verdict == "not_enough_information");
        CHECK_THAT(d.statement, Catch::Contains("State the noise (force_noise_std_N_approx)"));
        CHECK(d.forwardRuns == 0);
        CHECK(d.failure.empty());
    }
}

TEST_CASE("noise that is larger than thought stays below what it may be", "[diagnosis]") {
    // The bound is exceeded by a fortieth of what is possible, plus two deviations of a mean over rows that remember
    // nothing: one or two of forty recordings at most, four by bad luck (a binomial of .05, p = .05).
    int beyond = 0;
    double most = 0.0;
    for (std::uint64_t seed = 601; seed < 641; ++seed) {
        const Data data = toy::recordings(seed);
        const Noise noise = estimateNoise(data);
        const double squares = mostSquares(data, noise, 1);
        CHECK(squares >= 1.0);
        most = std::max(most, squares);
        const toy::Spring spring(data);
        double sum = 0.0, rows = 0.0;
        for (std::size_t r = 0; r < data.runs.size(); ++r) {
            const RecordedRun& run = data.runs[r];
            const Eigen::VectorXd left =
                run.force - spring.simulate(r, {{103.0, 0.08}, {}}, Fineness::Fine, nullptr).force;
            sum += Whitening(run.time, noise.white, noise.coloured, noise.memory).apply(left).squaredNorm();
            rows += static_cast<double>(run.time.size());
        }
        beyond += sum / rows > squares + 2.0 * std::sqrt(2.0 / rows) ? 1 : 0;
    }
    CHECK(beyond <= 4);
    CHECK(most < 1.5); // the slow part is known to a quarter: it says something

    Noise sure = estimateNoise(toy::recordings(601));
    sure.possible.assign(10, {sure.white, sure.coloured, sure.memory});
    CHECK(mostSquares(toy::recordings(601), sure, 1) == Approx(1.0));
    for (Noise::Possible& p : sure.possible) // twice as large: four times the squares
        p = {2.0 * sure.white, 2.0 * sure.coloured, sure.memory};
    CHECK(mostSquares(toy::recordings(601), sure, 1) == Approx(4.0));
    sure.possible.clear();
    CHECK(mostSquares(toy::recordings(601), sure, 1) == 1.0);
}
