#include "plugin/identification/diagnosis/simulation_cache.h"

#include "supercircle/support/hash.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace supercircle::diagnosis {

namespace {

constexpr char kMagic[] = "supercircle simulation cache 4\n";

void put(std::string& to, std::uint64_t v) {
    char raw[8];
    std::memcpy(raw, &v, 8);
    to.append(raw, 8);
}
void put(std::string& to, const std::string& v) {
    put(to, static_cast<std::uint64_t>(v.size()));
    to += v;
}
void put(std::string& to, const Eigen::VectorXd& v) {
    put(to, static_cast<std::uint64_t>(v.size()));
    to.append(reinterpret_cast<const char*>(v.data()), static_cast<std::size_t>(v.size()) * sizeof(double));
}

/// Reads fields of a text in order; `good` becomes false at its end.
struct Reader {
    const std::string& text;
    std::size_t at = 0;
    bool good = true;

    std::uint64_t number() {
        std::uint64_t v = 0;
        if (const char* raw = take(8); raw != nullptr)
            std::memcpy(&v, raw, 8);
        return v;
    }
    std::string string() {
        const std::uint64_t n = number();
        const char* raw = take(n);
        return raw != nullptr ? std::string(raw, static_cast<std::size_t>(n)) : std::string();
    }
    Eigen::VectorXd vector() {
        const std::uint64_t n = number();
        const char* raw = n <= text.size() ? take(n * sizeof(double)) : nullptr;
        if (raw == nullptr) {
            good = false;
            return {};
        }
        Eigen::VectorXd v(static_cast<Eigen::Index>(n));
        std::memcpy(v.data(), raw, static_cast<std::size_t>(n) * sizeof(double));
        return v;
    }

private:
    const char* take(std::uint64_t n) {
        if (!good || n > text.size() - at) {
            good = false;
            return nullptr;
        }
        const char* raw = text.data() + at;
        at += n;
        return raw;
    }
};

std::string entryOf(const std::string& key, const Response& r) {
    std::string body;
    put(body, key);
    put(body, r.failure);
    put(body, r.force);
    put(body, r.markers);
    put(body, r.jumps);
    put(body, r.further);
    std::string entry;
    put(entry, body);
    put(entry, checkSum(body));
    return entry;
}

} // namespace

SimulationCache::~SimulationCache() {
    if (file_ != nullptr)
        std::fclose(file_);
}

std::string SimulationCache::open(const std::string& path, const std::string& identity) {
    std::string head = kMagic;
    put(head, identity);
    path_ = path;
    head_ = head;
    std::string text;
    {
        std::ifstream in(path, std::ios::binary);
        text.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
    std::size_t good = 0;
    if (text.compare(0, head.size(), head) == 0) {
        Reader reader{text, head.size()};
        good = reader.at;
        while (reader.good && reader.at < text.size()) {
            const std::string body = reader.string();
            const std::uint64_t sum = reader.number();
            if (!reader.good || sum != checkSum(body))
                break;
            Reader inside{body};
            const std::string key = inside.string();
            Response r;
            r.failure = inside.string();
            r.force = inside.vector();
            r.markers = inside.vector();
            r.jumps = inside.vector();
            r.further = inside.vector();
            if (!inside.good)
                break;
            known_.emplace(key, std::move(r));
            good = reader.at;
        }
    }
    loadedFromFile_ = known_.size();
    std::error_code error;
    if (good > 0)
        std::filesystem::resize_file(path, good, error);
    const bool goesOn = good > 0 && !error;
    file_ = std::fopen(path.c_str(), goesOn ? "ab" : "wb");
    if (file_ == nullptr)
        return path + ": cannot be written: " + std::strerror(errno);
    written_ = goesOn ? good : 0;
    if (!goesOn)
        write(head);
    return failure_;
}

void SimulationCache::write(const std::string& bytes) {
    // Flushed, so that a killed process keeps the entry.
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_) == bytes.size() && std::fflush(file_) == 0) {
        written_ += bytes.size();
        return;
    }
    failure_ = path_ + ": cannot be written: " + std::strerror(errno);
    std::fclose(file_);
    file_ = nullptr;
    std::error_code ignored; // a torn entry hides those after it
    std::filesystem::resize_file(path_, written_, ignored);
}

std::string SimulationCache::failure() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return failure_;
}

void SimulationCache::clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    known_.clear();
    loadedFromFile_ = 0;
    if (file_ == nullptr)
        return;
    std::fclose(file_);
    written_ = 0;
    file_ = std::fopen(path_.c_str(), "wb");
    if (file_ != nullptr)
        write(head_);
    else
        failure_ = path_ + ": cannot be written: " + std::strerror(errno);
}

std::optional<Response> SimulationCache::find(const std::string& key) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto at = known_.find(key);
    return at != known_.end() ? std::optional<Response>(at->second) : std::nullopt;
}

void SimulationCache::insert(const std::string& key, const Response& response) {
    const std::string entry = entryOf(key, response);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!known_.emplace(key, response).second || file_ == nullptr)
        return;
    write(entry);
}

} // namespace supercircle::diagnosis
