#pragma once
// Simulated runs that are already known, in memory and in a file, so that a diagnosis that was killed goes on where it
// was. Every entry carries its whole key and a check sum; what does not fit, such as the torn end of a killed process,
// is dropped.

#include "plugin/identification/diagnosis/model/model.h"

#include <cstdint>
#include <cstdio>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace supercircle::diagnosis {

/// Checksum of the simulator's sources (made by the build).
const char* simulatorStamp();

class Store {
public:
    Store() = default;
    ~Store();
    Store(const Store&) = delete;
    Store& operator=(const Store&) = delete;

    /// Reads what `file` holds for `identity` and keeps everything new there. Empty, or why not; without a file,
    /// entries live in memory only.
    std::string open(const std::string& file, const std::string& identity);
    std::optional<Response> find(const std::string& key) const;
    void keep(const std::string& key, const Response& response);
    /// Empties memory and file.
    void forget();
    [[nodiscard]] std::size_t fromFile() const { return fromFile_; }
    /// Why runs are not kept in the file any more (a full disk); empty: they are. What it held before stays there.
    [[nodiscard]] std::string failure() const;

private:
    void write(const std::string& bytes);

    mutable std::mutex mutex_;
    std::map<std::string, Response> known_;
    std::FILE* file_ = nullptr;
    std::string path_, head_, failure_;
    std::uintmax_t written_ = 0; ///< length of the file up to its last whole entry
    std::size_t fromFile_ = 0;
};

} // namespace supercircle::diagnosis
