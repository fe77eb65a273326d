#pragma once
// Serialisation of a state (for plugin/api and the checkpoints of plugin/lab): one list of fields per struct
// (snapshot_fields.h) serves saving, loading and hashing. Numbers are stored in little-endian order with all their
// bits, so files are portable.

#include "supercircle/contact/outline_points.h"
#include "supercircle/support/result.h"

#include <Eigen/Core>
#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace supercircle::archive {

template <class T, class U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

constexpr std::uint64_t kHashStart = 0xcbf29ce484222325u;

/// FNV-1a, 64 bits.
inline void hashByte(std::uint64_t& hash, std::uint8_t byte) {
    hash = (hash ^ byte) * 0x100000001b3u;
}
std::uint64_t hashOf(const std::uint8_t* bytes, std::size_t count);

class Saver {
public:
    static constexpr bool kLoads = false;
    std::vector<std::uint8_t> bytes;

    template <class... T>
    void operator()(const T&... x);
    /// Fields of a saved state that do not influence its future.
    template <class... T>
    void unhashed(const T&... x) {
        (*this)(x...);
    }
    void word(std::uint64_t value, int count) {
        std::array<std::uint8_t, 8> little{};
        for (int i = 0; i < 8; ++i)
            little[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(value >> (8 * i));
        bytes.insert(bytes.end(), little.begin(), little.begin() + count);
    }
};

class Hasher {
public:
    static constexpr bool kLoads = false;
    std::uint64_t hash = kHashStart;

    template <class... T>
    void operator()(const T&... x);
    template <class... T>
    void unhashed(const T&...) {}
    void word(std::uint64_t value, int count) {
        for (int i = 0; i < count; ++i)
            hashByte(hash, static_cast<std::uint8_t>(value >> (8 * i)));
    }
};

/// Never reads beyond its bytes: after the first fault all values are zero and all lists empty.
class Loader {
public:
    static constexpr bool kLoads = true;

    Loader(const std::uint8_t* bytes, std::size_t count) : at_(bytes), left_(count) {}

    template <class... T>
    void operator()(T&... x);
    template <class... T>
    void unhashed(T&... x) {
        (*this)(x...);
    }
    std::uint64_t word(int count) {
        if (left_ < static_cast<std::size_t>(count))
            fail("it ends too early");
        if (!fault_.empty())
            return 0;
        std::uint64_t value = 0;
        for (int i = 0; i < count; ++i)
            value |= static_cast<std::uint64_t>(at_[i]) << (8 * i);
        at_ += count;
        left_ -= static_cast<std::size_t>(count);
        return value;
    }
    /// The length of a list; at most the number of bytes left.
    std::size_t count() {
        const std::uint64_t n = word(8);
        if (n <= left_)
            return static_cast<std::size_t>(n);
        fail("a list in it is longer than the file");
        return 0;
    }
    /// Keeps the first reason.
    void fail(const std::string& why) {
        if (fault_.empty())
            fault_ = why;
    }
    [[nodiscard]] const std::string& fault() const { return fault_; }
    [[nodiscard]] std::size_t left() const { return left_; }
    [[nodiscard]] const std::uint8_t* at() const { return at_; }
    void skip(std::size_t n) {
        if (n > left_)
            return fail("it ends too early");
        at_ += n;
        left_ -= n;
    }

private:
    const std::uint8_t* at_;
    std::size_t left_;
    std::string fault_;
};

// ---- plain values ----

template <class Ar, class T>
requires(std::is_integral_v<std::remove_const_t<T>> || std::is_enum_v<std::remove_const_t<T>>) void io(Ar& ar, T& x) {
    constexpr int size = static_cast<int>(sizeof(T));
    if constexpr (Ar::kLoads) {
        const std::uint64_t value = ar.word(size);
        if (std::is_same_v<T, bool> && value > 1)
            ar.fail("a truth value in it is neither 0 nor 1");
        x = static_cast<T>(value);
    } else {
        ar.word(static_cast<std::uint64_t>(x), size);
    }
}

template <class Ar>
void io(Ar& ar, Is<double> auto& x) {
    if constexpr (Ar::kLoads)
        x = std::bit_cast<double>(ar.word(8));
    else
        ar.word(std::bit_cast<std::uint64_t>(x), 8);
}

template <class Ar>
void io(Ar& ar, Is<Eigen::Vector2d> auto& x) {
    ar(x[0], x[1]);
}

template <class Ar>
void io(Ar& ar, Is<Eigen::VectorXd> auto& x) {
    if constexpr (Ar::kLoads)
        x.setZero(static_cast<Eigen::Index>(ar.count()));
    else
        ar.word(static_cast<std::uint64_t>(x.size()), 8);
    for (Eigen::Index i = 0; i < x.size(); ++i)
        ar(x[i]);
}

template <class Ar>
void io(Ar& ar, Is<std::string> auto& x) {
    if constexpr (Ar::kLoads)
        x.resize(ar.count());
    else
        ar.word(x.size(), 8);
    for (auto& c : x)
        ar(c);
}

template <class Ar, class T, std::size_t N>
void io(Ar& ar, std::array<T, N>& x) {
    for (auto& e : x)
        ar(e);
}
template <class Ar, class T, std::size_t N>
void io(Ar& ar, const std::array<T, N>& x) {
    for (const auto& e : x)
        ar(e);
}

template <class Ar, class T>
void io(Ar& ar, const std::vector<T>& x) {
    ar.word(x.size(), 8);
    for (const T& e : x)
        ar(e);
}
template <class Ar, class T>
requires std::default_initializable<T>
void io(Ar& ar, std::vector<T>& x) {
    x.assign(ar.count(), T{});
    for (T& e : x)
        ar(e);
}

template <class Ar, class A, class B>
void io(Ar& ar, const std::pair<A, B>& x) {
    ar(x.first, x.second);
}
template <class Ar, class A, class B>
void io(Ar& ar, std::pair<A, B>& x) {
    ar(x.first, x.second);
}

template <class Ar, class T>
void io(Ar& ar, const std::deque<T>& x) {
    ar.word(x.size(), 8);
    for (const T& e : x)
        ar(e);
}
template <class Ar, class T>
void io(Ar& ar, std::deque<T>& x) {
    x.assign(ar.count(), T{});
    for (T& e : x)
        ar(e);
}

template <class Ar>
void io(Ar& ar, const contact::OutlinePoints& x) {
    ar.word(x.size(), 8);
    for (const Eigen::Vector2d& e : x)
        ar(e);
}
template <class Ar>
void io(Ar& ar, contact::OutlinePoints& x) {
    x.assign(ar.count(), Eigen::Vector2d::Zero());
    for (Eigen::Vector2d& e : x)
        ar(e);
}

template <class Ar, class T>
void io(Ar& ar, const std::optional<T>& x) {
    ar(x.has_value());
    if (x)
        ar(*x);
}
template <class Ar, class T>
void io(Ar& ar, std::optional<T>& x) {
    bool given = false;
    ar(given);
    x.reset();
    if (given)
        ar(x.emplace());
}

template <class... T>
void Saver::operator()(const T&... x) {
    (io(*this, x), ...);
}
template <class... T>
void Hasher::operator()(const T&... x) {
    (io(*this, x), ...);
}
template <class... T>
void Loader::operator()(T&... x) {
    (io(*this, x), ...);
}

// ---- files ----

/// Name and version at the start of a file.
struct FileKind {
    char name[9]; ///< eight characters
    std::uint32_t version;
};
constexpr std::size_t kHeader = 8 + 4 + 8 + 8; ///< bytes of name, version, size and checksum
/// Adds the header.
std::vector<std::uint8_t> wrap(const FileKind& kind, const std::vector<std::uint8_t>& content);
/// Offset of the content. Fails unless header, size and checksum are correct.
Result<std::size_t> unwrap(const FileKind& kind, const std::vector<std::uint8_t>& file);

} // namespace supercircle::archive
