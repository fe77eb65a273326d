#include "bridge/c/guard.h"

#include "bridge/c/json.h"

#include <array>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

namespace supercircle::c {

namespace {

constexpr int kDeepest = 100;                               ///< nesting of JSON, as the scene loader
constexpr std::size_t kLongestText = std::size_t{64} << 20; ///< bytes, as the scene loader

struct Texts {
    std::string error;
    sc_status status = SC_OK;
    bool errorLost = false;          ///< there was no memory for it
    std::array<std::string, 4> kept; ///< the last ones
    std::size_t next = 0;
};
thread_local Texts texts;

void remember(std::string_view why) noexcept {
    try {
        texts.error = why;
    } catch (...) {
        texts.error.clear();
        texts.errorLost = true;
    }
}

} // namespace

namespace {

sc_status statusOf(void (*work)(void*), void* context) noexcept {
    try {
        work(context);
        return SC_OK;
    } catch (const Refusal& e) {
        remember(e.why.empty() ? "the call was refused" : std::string_view(e.why));
        return e.status;
    } catch (const std::bad_alloc&) {
        remember("out of memory");
        return SC_NO_MEMORY;
    } catch (const std::length_error&) {
        remember("out of memory");
        return SC_NO_MEMORY;
    } catch (const std::exception& e) {
        remember(e.what());
        return SC_FAILED;
    } catch (...) {
        remember("an unknown exception");
        return SC_FAILED;
    }
}

} // namespace

sc_status shield(void (*work)(void*), void* context) noexcept {
    texts.error.clear();
    texts.errorLost = false;
    const sc_status status = statusOf(work, context);
    texts.status = status; // not before: work may call back
    return status;
}

sc_status lastStatus() noexcept {
    return texts.status;
}

const char* lastError() noexcept {
    return texts.errorLost ? "out of memory" : texts.error.c_str();
}

const char* keep(std::string text) {
    std::string& kept = texts.kept[texts.next];
    texts.next = (texts.next + 1) % texts.kept.size();
    kept = std::move(text);
    return kept.c_str();
}

void refuse(sc_status status, std::string why) {
    throw Refusal(status, std::move(why));
}

void requireFinite(double number, const char* what) {
    if (!std::isfinite(number))
        refuse(SC_BAD_INPUT, std::string(what) + " is not a finite number");
}

void requireFinite(sc_point point, const char* what) {
    requireFinite(point.x, what);
    requireFinite(point.y, what);
}

std::uint16_t bits16(std::uint32_t word, const char* what) {
    if (word > 0xffffU)
        refuse(SC_BAD_INPUT, std::string(what) + " has more than 16 bits");
    return static_cast<std::uint16_t>(word);
}

std::int16_t group16(std::int32_t word) {
    if (word < -32768 || word > 32767)
        refuse(SC_BAD_INPUT, "the group has more than 16 bits");
    return static_cast<std::int16_t>(word);
}

void requireChoice(std::int32_t kind, std::int32_t count, const char* what) {
    if (kind < 0 || kind >= count)
        refuse(SC_BAD_INPUT, std::string(what) + " is " + std::to_string(kind) + ", not one of the " +
                                 std::to_string(count) + " constants");
}

std::string textOf(const char* text, std::int32_t bytes, const char* what) {
    const char& first = given(text, what);
    const std::size_t length = bytes >= 0 ? static_cast<std::size_t>(bytes) : std::strlen(&first);
    if (bytes < -1 || length > kLongestText)
        refuse(SC_BAD_INPUT, std::string("the length of ") + what + " is below -1 or above 64 MiB");
    return {text, length};
}

namespace {

/// What walks over the values of a JSON text calls itself.
void requireShallow(const std::string& json) {
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (c == '"')
            quoted = !quoted;
        else if (quoted && c == '\\')
            ++i;
        else if (!quoted)
            depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
        if (depth > kDeepest)
            refuse(SC_BAD_INPUT, "the JSON text is nested more than 100 deep");
    }
}

} // namespace

Json parsed(const char* text, const char* what) {
    const std::string json = textOf(text, -1, what);
    requireShallow(json);
    try {
        return Json::parse(json);
    } catch (const Json::exception& e) {
        refuse(SC_BAD_INPUT, std::string(what) + ": not JSON: " + e.what());
    }
}

std::string written(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string nameOf(const char* text, const char* what) {
    return textOf(text, -1, what);
}

} // namespace supercircle::c
