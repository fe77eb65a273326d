#pragma once
// Checkpoints: a file from which an interrupted run continues to the same bytes.

#include "supercircle/support/result.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::scene {
struct Scene;
}

namespace supercircle::lab {

/// What decides the numbers of a run, by name and value: program, text of the scene, parameters, seed, options.
using RunIdentity = std::vector<std::pair<std::string, std::string>>;

/// The checkpoint of one run: the file `checkpoint.state` of its folder.
class CheckpointFile {
public:
    CheckpointFile(const std::string& folder, RunIdentity identity)
        : folder_(folder), path_(folder + "/checkpoint.state"), identity_(std::move(identity)) {}

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] bool exists() const;
    /// State of the run. Fails with a sentence for the user if there is no file, if it is damaged, or if it is of
    /// another run; then the sentence names what differs.
    [[nodiscard]] Result<std::vector<std::uint8_t>> read() const;
    /// The old file stays until the new one is on the disk.
    [[nodiscard]] Status write(const std::vector<std::uint8_t>& state) const;
    void remove() const;

private:
    std::string folder_, path_;
    RunIdentity identity_;
};

struct CheckpointOptions {
    const CheckpointFile* file = nullptr; ///< none: no checkpoints. The file is removed when the run is done
    double interval = std::numeric_limits<double>::infinity(); ///< s of wall clock between two states
    std::vector<std::uint8_t> resume;                          ///< state to continue from; empty: from the beginning
    std::function<void(const std::string&)> onFailure;         ///< a state could not be written; the run goes on
};

/// Why a run of the scene cannot be continued from a file; empty if it can.
[[nodiscard]] std::string whyNoCheckpoint(const scene::Scene& scene);

} // namespace supercircle::lab
