#include "plugin/lab/session/checkpoint.h"

#include "plugin/api/snapshot_archive.h"
#include "plugin/recording/table/files.h"
#include "plugin/scene/loader/scene.h"

#include <algorithm>
#include <filesystem>

namespace supercircle::lab {

namespace {

constexpr archive::FileKind kKind{"SCRUN   ", 2};
constexpr std::uintmax_t kMostBytes = std::uintmax_t{16} << 30;

/// Values that only tell whether two texts are the same are no help to who reads them.
bool isReadable(const std::string& name) {
    return name.find("text") == std::string::npos;
}

std::string valueOf(const RunIdentity& identity, const std::string& name) {
    const auto it =
        std::find_if(identity.begin(), identity.end(), [&](const auto& part) { return part.first == name; });
    return it != identity.end() ? it->second : "absent";
}

/// What differs, in words; empty if nothing does.
std::string difference(const RunIdentity& there, const RunIdentity& here) {
    RunIdentity all = here;
    for (const auto& part : there)
        if (valueOf(here, part.first) == "absent")
            all.push_back(part);
    std::string out;
    for (const auto& [name, unused] : all) {
        const std::string before = valueOf(there, name), now = valueOf(here, name);
        if (before == now)
            continue;
        out += (out.empty() ? "" : ", ") + name +
               (isReadable(name) ? " (" + before + " there, " + now + " here)" : std::string{});
    }
    return out;
}

} // namespace

bool CheckpointFile::exists() const {
    std::error_code ignored;
    return std::filesystem::exists(path_, ignored);
}

Result<std::vector<std::uint8_t>> CheckpointFile::read() const {
    using State = Result<std::vector<std::uint8_t>>;
    const std::string remedy = "; remove it or name another folder with --out";
    const auto text = record::readText(path_, kMostBytes);
    if (!text)
        return State::failure(text.error());
    const std::vector<std::uint8_t> bytes(text->begin(), text->end());
    const auto start = archive::unwrap(kKind, bytes);
    if (!start)
        return State::failure(path_ + " is no checkpoint of this program: " + start.error() + remedy);
    archive::Loader in(bytes.data() + *start, bytes.size() - *start);
    RunIdentity identity;
    std::vector<std::uint8_t> state;
    in(identity);
    if (const std::string other = difference(identity, identity_); in.fault().empty() && !other.empty())
        return State::failure(path_ + " is the checkpoint of another run, which differs in " + other + remedy);
    in(state);
    if (!in.fault().empty())
        return State::failure(path_ + ": " + in.fault() + remedy);
    return state;
}

Status CheckpointFile::write(const std::vector<std::uint8_t>& state) const {
    archive::Saver out;
    out(identity_, state);
    const std::vector<std::uint8_t> bytes = archive::wrap(kKind, out.bytes);
    return record::writeAtomically(
        folder_, {{std::filesystem::path(path_).filename().string(), std::string(bytes.begin(), bytes.end())}});
}

void CheckpointFile::remove() const {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
}

std::string whyNoCheckpoint(const scene::Scene& scene) {
    for (const step::BodyDefinition& b : scene.rigid.bodies)
        if (b.type == step::BodyType::Dynamic)
            return "body \"" + b.name +
                   "\" is dynamic: Box2D keeps forces of such bodies to itself, so that a run with them cannot be "
                   "continued from a checkpoint";
    return {};
}

} // namespace supercircle::lab
