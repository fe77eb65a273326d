#pragma once
// The runs of a sweep in a SQLite file (write-ahead log): a run is stored completely or not at all, even if the
// computer stops. Tables: meta(key, value); runs(parameters, seed, status, message, result), one row a run, `result` as
// run_record.h serialises it; timings(parameters, seed, host, build, wall_s, cpu_s).

#include "supercircle/support/result.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::sweep {

/// A run by the key of its parameters (keyOf()) and its seed.
using RunName = std::pair<std::string, std::int64_t>;

/// A row of the table `runs`, and of `timings`.
struct StoredRun {
    std::string parameters;
    std::int64_t seed = 0;
    std::string status;
    std::string message;
    std::string result;           ///< serialised, empty if the process died
    std::string host;             ///< computer that ran it
    std::string build;            ///< program that ran it
    double wall = 0.0, cpu = 0.0; ///< s
};

inline constexpr const char* kStoreFormat = "supercircle-sweep-store/2"; ///< value of the meta key "format"
inline constexpr const char* kStoreFile = "results.sqlite";              ///< in the folder of a sweep or shard

class ResultStore {
public:
    ResultStore();
    ~ResultStore();
    ResultStore(const ResultStore&) = delete;
    ResultStore& operator=(const ResultStore&) = delete;

    /// Opens or makes the file. Empty, or why not.
    [[nodiscard]] std::string open(const std::string& path);
    /// Whether the last error is that the disk takes nothing (full, write-protected); reading needs room too.
    [[nodiscard]] bool cannotWrite() const;
    /// Value of the table meta, empty if there is none.
    [[nodiscard]] Result<std::string> meta(const std::string& key);
    [[nodiscard]] std::string setMeta(const std::string& key, const std::string& value);
    /// Empty if the file is new or of this version; else a message for the user.
    [[nodiscard]] std::string checkFormat();
    /// Stores a run, in place of an earlier one of this name; on the disk when this returns.
    [[nodiscard]] std::string save(const StoredRun& run);
    /// Names of the runs that need no repetition: all but those whose process died.
    [[nodiscard]] Result<std::set<RunName>> finished();
    /// Calls `each` for every run, ordered by parameters and seed.
    [[nodiscard]] std::string forEach(const std::function<void(const StoredRun&)>& each);
    /// Copies the runs of another store that are missing or crashed here; only those named, unless `only` is empty.
    [[nodiscard]] std::string mergeFrom(ResultStore& other, const std::set<RunName>& only = {});

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::sweep
