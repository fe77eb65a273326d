#pragma once
// Calls of the C interface with arguments made of random bytes: null pointers, stale and foreign handles, numbers that
// are none, texts that are no JSON, and often enough something that makes sense.

#include "bridge/c/include/supercircle.h"
#include "tests/fuzz/byte_source.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace supercircle::fuzz {

inline constexpr int kBuffer = 64; ///< items; counts and capacities are at most as large
inline constexpr int kOdd = 10;    ///< of 256 numbers are extreme or not finite

enum class Kind { World, Shell, Body, Hold, Joint, MouseJoint, Force, Zone, Scene, Count };

class Caller {
public:
    explicit Caller(ByteSource& bytes) : bytes_(bytes) {}

    /// One call with random arguments; checks what it says.
    template <class R, class... A>
    void call(const char* name, R (*f)(A...)) {
        std::tuple<Argument<A>...> arguments{Argument<A>(*this)...};
        ++calls;
        remember(name);
        if constexpr (std::is_void_v<R>) {
            std::apply([&](auto&... a) { f(a.value...); }, arguments);
        } else {
            const R result = std::apply([&](auto&... a) { return f(a.value...); }, arguments);
            check(name, result);
        }
        if (*sc_error() != 0)
            remember("refused");
        else
            std::apply([](auto&... a) { (a.collect(), ...); }, arguments);
    }

    std::uint64_t handle(Kind kind);
    void keep(Kind kind, std::uint64_t id);
    std::vector<std::uint64_t>& pool(Kind kind) { return pools_[static_cast<std::size_t>(kind)]; }

    ByteSource& bytes() { return bytes_; }
    double number();
    const char* text();

    std::uint64_t calls = 0, refused = 0;
    std::string violation;
    std::string history; ///< names of the last calls
    void remember(const std::string& call);

    void fill(sc_world_def& d);
    void fill(sc_shell_def& d);
    void fill(sc_body_def& d);
    void fill(sc_joint_def& d);
    void fill(sc_mouse_joint_def& d);
    void fill(sc_material& d);
    void fill(sc_target& d);
    void fill(sc_filter& d);
    void fill(sc_sleep& d);
    void fill(sc_recovery& d);
    void fill(sc_event_settings& d);
    void fill(sc_view& d);
    void fill(double& d);
    void fill(sc_point& p);
    template <class T>
    void fill(T& other) { // a result: whatever stands there
        std::array<std::uint8_t, sizeof(T)> raw{};
        for (std::uint8_t& b : raw)
            b = bytes_.byte();
        std::memcpy(&other, raw.data(), sizeof(T));
    }

private:
    void check(const char* name, std::int64_t result, bool isCount);
    void check(const char* name, std::int32_t result) { check(name, result, true); }
    template <class R>
    void check(const char* name, const R& /*result*/) {
        check(name, 0, false);
    }

    template <class T>
    struct Argument {
        explicit Argument(Caller& c) { c.fill(value); }
        void collect() {}
        T value{};
    };
    template <class T>
    struct Argument<T*> {
        explicit Argument(Caller& c) : caller(c), buffer(kBuffer) {
            c.fill(buffer.front());
            if constexpr (std::is_same_v<T, const sc_point>) // corners of a polygon
                for (std::size_t i = 1; i < 4; ++i)
                    c.fill(buffer[i]);
            value = c.bytes().chance(12) ? nullptr : buffer.data();
        }
        void collect() {
            if constexpr (!std::is_const_v<T>)
                if (value != nullptr)
                    caller.collected(buffer.front());
        }
        Caller& caller;
        std::vector<std::remove_const_t<T>> buffer;
        T* value = nullptr;
    };

    void collected(const sc_world& h) { keep(Kind::World, h.id); }
    void collected(const sc_shell& h) { keep(Kind::Shell, h.id); }
    void collected(const sc_body& h) { keep(Kind::Body, h.id); }
    void collected(const sc_hold& h) { keep(Kind::Hold, h.id); }
    void collected(const sc_joint& h) { keep(Kind::Joint, h.id); }
    void collected(const sc_mouse_joint& h) { keep(Kind::MouseJoint, h.id); }
    void collected(const sc_force& h) { keep(Kind::Force, h.id); }
    void collected(const sc_zone& h) { keep(Kind::Zone, h.id); }
    void collected(const sc_scene& h) { keep(Kind::Scene, h.id); }
    template <class T>
    void collected(const T&) {}

    ByteSource& bytes_;
    std::array<std::vector<std::uint64_t>, static_cast<std::size_t>(Kind::Count)> pools_;
};

template <>
inline void Caller::fill(sc_world& h) {
    h.id = handle(Kind::World);
}
template <>
inline void Caller::fill(sc_shell& h) {
    h.id = handle(Kind::Shell);
}
template <>
inline void Caller::fill(sc_body& h) {
    h.id = handle(Kind::Body);
}
template <>
inline void Caller::fill(sc_hold& h) {
    h.id = handle(Kind::Hold);
}
template <>
inline void Caller::fill(sc_joint& h) {
    h.id = handle(Kind::Joint);
}
template <>
inline void Caller::fill(sc_mouse_joint& h) {
    h.id = handle(Kind::MouseJoint);
}
template <>
inline void Caller::fill(sc_force& h) {
    h.id = handle(Kind::Force);
}
template <>
inline void Caller::fill(sc_zone& h) {
    h.id = handle(Kind::Zone);
}
template <>
inline void Caller::fill(sc_scene& h) {
    h.id = handle(Kind::Scene);
}
template <>
inline void Caller::fill(std::int32_t& n) {
    static constexpr std::array<std::int32_t, 10> kSome{-1, 0, 1, 2, 3, 16, 40, kBuffer, -2, -2147483647 - 1};
    n = kSome[bytes_.below(bytes_.chance(kOdd) ? 10 : 8)];
}
template <>
inline void Caller::fill(std::uint32_t& n) {
    n = bytes_.chance(kOdd) ? 0xffffffffU : bytes_.chance(128) ? 0xffffU : bytes_.below(4);
}
template <>
inline void Caller::fill(std::uint64_t& n) {
    n = bytes_.below(65536) * (bytes_.chance(kOdd) ? 0x1000000000001ULL : 1);
}
/// Texts stay in their place and are longer than any number of bytes that is asked for.
template <>
struct Caller::Argument<const char*> {
    explicit Argument(Caller& c) : value(c.bytes().chance(12) ? nullptr : c.text()) {}
    void collect() {}
    const char* value;
};

} // namespace supercircle::fuzz
