#pragma once
// The border: what every call of the C interface is wrapped in. Inside, a call refuses by throwing a Refusal; outside,
// only a status, a count, NaN, zero or null is seen, with a sentence for sc_error().

#include "bridge/c/include/supercircle.h"
#include "supercircle/support/result.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <type_traits>
#include <utility>

namespace supercircle::c {

/// Why a call is refused; ends it.
struct Refusal : std::exception {
    Refusal(sc_status s, std::string w) : status(s), why(std::move(w)) {}
    [[nodiscard]] const char* what() const noexcept override { return why.c_str(); }
    sc_status status;
    std::string why;
};

/// An assertion of the library that does not hold: the failure handler throws it.
struct AssertionFailed : std::exception {
    explicit AssertionFailed(std::string w) : why(std::move(w)) {}
    [[nodiscard]] const char* what() const noexcept override { return why.c_str(); }
    std::string why;
};

/// Runs `work`, keeps the sentence of a refusal for sc_error(), and returns its status. No exception leaves it.
sc_status shield(void (*work)(void*), void* context) noexcept;
template <class F>
sc_status shielded(F&& work) noexcept {
    return shield([](void* context) { (*static_cast<std::remove_reference_t<F>*>(context))(); }, &work);
}

/// The sentence of this thread's last refusal; empty after a call that was done.
const char* lastError() noexcept;
sc_status lastStatus() noexcept;
/// Keeps a text until this thread has got four more.
const char* keep(std::string text);

/// A call that returns `otherwise` when it is refused.
template <class R, class F>
R valued(R otherwise, F&& work) noexcept {
    R out = otherwise;
    return shielded([&] { out = work(); }) == SC_OK ? out : otherwise;
}
/// A call that returns a count, or minus a status.
template <class F>
int32_t counted(F&& work) noexcept {
    int32_t out = 0;
    const sc_status status = shielded([&] { out = work(); });
    return status == SC_OK ? out : -status;
}
/// A call that returns a text, or null.
template <class F>
const char* text(F&& work) noexcept {
    return valued<const char*>(nullptr, [&] { return keep(work()); });
}

[[noreturn]] void refuse(sc_status status, std::string why);
/// Refuses unless the library's answer is a value. `status` is the kind of its failures.
template <class T>
const T& done(const Result<T>& answer, sc_status status = SC_BAD_INPUT) {
    if (!answer)
        refuse(status, answer.error());
    return *answer;
}

template <class T>
T& given(T* pointer, const char* what) {
    if (pointer == nullptr)
        refuse(SC_BAD_INPUT, std::string(what) + " is null");
    return *pointer;
}
void requireFinite(double number, const char* what);
void requireFinite(sc_point point, const char* what);
/// 16 bits of an unsigned word.
std::uint16_t bits16(std::uint32_t word, const char* what);
std::int16_t group16(std::int32_t word);
/// `kind` of an enum with `count` values from 0.
void requireChoice(std::int32_t kind, std::int32_t count, const char* what);
/// A text that may not be null; at most 64 MiB.
std::string textOf(const char* text, std::int32_t bytes, const char* what);
std::string nameOf(const char* text, const char* what);
/// Checks the buffer of a call that writes up to `capacity` items.
template <class T>
void requireBuffer(const T* out, std::int32_t capacity) {
    if (capacity < 0 || (capacity > 0 && out == nullptr))
        refuse(SC_BAD_INPUT, "the buffer is null or its capacity negative; capacity 0 asks for the number of items");
}
/// Copies up to `capacity` items; returns how many there are.
template <class From, class To, class F>
std::int32_t copyOut(const From& items, To* out, std::int32_t capacity, F&& convert) {
    std::int32_t n = 0;
    for (const auto& item : items) {
        if (n < capacity)
            out[n] = convert(item);
        ++n;
    }
    return n;
}

/// A definition of this or an earlier version: `first` is the size of version 1.
template <class T>
T versioned(const T* in, void (*init)(T*), std::size_t first, const char* initName) {
    T out;
    init(&out);
    std::int32_t size = 0;
    std::memcpy(&size, &given(in, "the definition"), sizeof size);
    if (size > static_cast<std::int32_t>(sizeof(T)) && size < 65536)
        refuse(SC_WRONG_VERSION, "the definition has " + std::to_string(size) + " bytes, this library knows " +
                                     std::to_string(sizeof(T)) + ": install the newer library");
    if (size < static_cast<std::int32_t>(first) || size > static_cast<std::int32_t>(sizeof(T)))
        refuse(SC_BAD_INPUT, std::string("the definition's size is not set; call ") + initName + " first");
    std::memcpy(&out, in, static_cast<std::size_t>(size));
    return out;
}

} // namespace supercircle::c
