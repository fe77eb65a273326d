#include "plugin/bench/bench.h"

#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/text.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <sys/resource.h>

namespace supercircle::cli {

namespace {

void printHeader() {
    std::printf("%-34s %12s %12s %12s %7s %9s\n", "benchmark", "median ms", "p95 ms", "best ms", "samples", "peak MB");
}

void printRow(const Measurement& m) {
    std::printf("%-34s %12.5g %12.5g %12.5g %7zu %9.1f", m.name.c_str(), m.median, m.p95, m.best, m.samples,
                m.peakMemory);
    for (const auto& [key, value] : m.more)
        std::printf("  %s %.4g", key.c_str(), value);
    std::printf("\n");
    std::fflush(stdout);
}

std::string jsonText(const std::vector<Measurement>& rows, const std::string& filter) {
    std::string out = "{\n  \"schema\": \"supercircle-bench/1\",\n  \"version\": \"" SC_VERSION "\",\n  \"filter\": ";
    record::appendJsonString(out, filter);
    out += ",\n  \"threads\": 1,\n  \"peak_memory_MB\": ";
    record::appendJsonNumber(out, peakMemory());
    out += ",\n  \"benchmarks\": [";
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Measurement& m = rows[i];
        record::appendJsonString(out += i == 0 ? "\n    {\"name\": " : ",\n    {\"name\": ", m.name);
        record::appendJsonNumber(out += ", \"median_ms\": ", m.median);
        record::appendJsonNumber(out += ", \"p95_ms\": ", m.p95);
        record::appendJsonNumber(out += ", \"best_ms\": ", m.best);
        out += ", \"samples\": " + std::to_string(m.samples);
        record::appendJsonNumber(out += ", \"peak_memory_MB\": ", m.peakMemory);
        for (const auto& [key, value] : m.more) {
            record::appendJsonString(out += ", ", key);
            record::appendJsonNumber(out += ": ", value);
        }
        out += '}';
    }
    return out + "\n  ]\n}\n";
}

/// Empty, or why the file could not be written.
std::string writeJson(const std::string& file, const std::vector<Measurement>& rows, const std::string& filter) {
    const std::filesystem::path path(file);
    return record::writeAtomically(path.parent_path().string(), {{path.filename().string(), jsonText(rows, filter)}})
        .error();
}

} // namespace

double peakMemory() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double threadCpuSeconds() {
    timespec t{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Measurement summarise(std::string name, std::vector<double> milliseconds) {
    Measurement m;
    m.name = std::move(name);
    std::sort(milliseconds.begin(), milliseconds.end());
    m.samples = milliseconds.size();
    if (milliseconds.empty())
        return m;
    const auto quantile = [&](double p) { // the nearest entry; published times are not those of lowerQuantile()
        return milliseconds[static_cast<std::size_t>(std::lround(p * static_cast<double>(m.samples - 1)))];
    };
    m.median = quantile(0.5);
    m.p95 = quantile(0.95);
    m.best = milliseconds.front();
    return m;
}

std::function<std::string(const std::vector<Measurement>&, const std::string&)>
writesPictures(std::shared_ptr<const std::vector<record::NamedText>> files, std::string names) {
    return
        [files = std::move(files), names = std::move(names)](const std::vector<Measurement>&, const std::string& json) {
            if (files->empty())
                return std::string();
            const std::filesystem::path folder = json.empty() ? "out" : std::filesystem::path(json).parent_path();
            std::printf("pictures: %s\n", (folder / names).c_str());
            return record::writeAtomically(folder.string(), *files).error();
        };
}

double timed(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

Measurement repeat(std::string name, const std::function<void()>& work) {
    work(); // warms the caches and allocates work spaces
    const double once = std::max(timed(work), 1e-6);
    const int calls = std::max(1, static_cast<int>(0.05 / once)); // the clock itself costs some 30 ns
    std::vector<double> samples;
    double spent = 0.0;
    while ((spent < 500.0 || samples.size() < 10) && samples.size() < 2000 && !interrupted) {
        const double all = timed([&] {
            for (int i = 0; i < calls; ++i)
                work();
        });
        spent += all;
        samples.push_back(all / calls);
    }
    return summarise(std::move(name), std::move(samples));
}

int bench(const std::string& filter, const std::string& json) {
    std::vector<Benchmark> all;
    addPartBenchmarks(all);
    addContactBenchmarks(all);
    addSolverBenchmarks(all);
    addScalingBenchmarks(all);
    addGameBenchmarks(all);
    addFrameBenchmarks(all);
    addWeldedBoxBenchmarks(all);
    addGuidePictures(all);
    addEffectsPicture(all);
    addSceneBenchmarks(all);
    std::vector<Measurement> rows;
    bool any = false;
    for (const Benchmark& b : all) {
        const auto wanted = [&](const std::string& name) {
            if (interrupted || filter.rfind(b.prefix, 0) != 0)
                return false;
            return (b.onRequest ? filter == name : name.find(filter) != std::string::npos);
        };
        if (std::none_of(b.names.begin(), b.names.end(), wanted))
            continue;
        if (!any)
            printHeader();
        any = true;
        const std::string error = b.measure(wanted, [&](Measurement m) {
            m.peakMemory = peakMemory();
            printRow(m);
            rows.push_back(std::move(m));
        });
        if (!error.empty()) {
            std::fprintf(stderr, "%s\n", error.c_str());
            return kBadInput;
        }
    }
    if (!any && !interrupted) {
        std::fprintf(stderr, "no benchmark is called \"%s\"; there are:\n", filter.c_str());
        for (const Benchmark& b : all) {
            if (!b.prefix.empty()) {
                std::fprintf(stderr, "  %s (%zu, only with a --filter that begins with it)\n", b.prefix.c_str(),
                             b.names.size());
                continue;
            }
            for (const std::string& name : b.names)
                std::fprintf(stderr, "  %s%s\n", name.c_str(), b.onRequest ? " (only with --filter and its name)" : "");
        }
        return kBadInput;
    }
    std::printf("peak memory %.1f MB\n", peakMemory());
    for (const Benchmark& b : all)
        if (const std::string error = b.finish ? b.finish(rows, json) : ""; !error.empty()) {
            std::fprintf(stderr, "%s\n", error.c_str());
            return kCannotWrite;
        }
    if (const std::string error = json.empty() ? "" : writeJson(json, rows, filter); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    if (!printed())
        return kCannotWrite;
    return interrupted ? kInterrupted : kDone;
}

} // namespace supercircle::cli
