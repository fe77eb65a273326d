#pragma once
// What all calls of the laboratory share: a request whose keys are checked, and work that is watched and cancelled.

#include "bridge/c/guard.h"
#include "bridge/c/include/supercircle_lab.h"
#include "bridge/c/json.h"
#include "plugin/scene/loader/scene.h"
#include "supercircle/step/port.h"
#include "supercircle/support/texts_in_memory.h"

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::c {

/// A JSON object with known keys. Every reading call refuses what has another type.
class Request {
public:
    /// Refuses a text that is no object, and unknown keys with the nearest known one.
    Request(const char* text, std::vector<std::string> keys);

    [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }
    [[nodiscard]] std::string text(const char* key, const std::string& otherwise = {}) const;
    [[nodiscard]] double number(const char* key, double otherwise) const;
    [[nodiscard]] std::int64_t integer(const char* key, std::int64_t otherwise, std::int64_t low,
                                       std::int64_t high) const;
    [[nodiscard]] bool flag(const char* key, bool otherwise) const;
    [[nodiscard]] std::vector<std::string> texts(const char* key) const;
    /// {"name": number}
    [[nodiscard]] std::vector<std::pair<std::string, double>> numbers(const char* key) const;
    /// A JSON text, or an object as one; empty if absent.
    [[nodiscard]] std::string document(const char* key) const;
    /// "content": texts by path, or {"base64": "..."} for bytes; null if absent.
    [[nodiscard]] std::shared_ptr<const TextsInMemory::Texts> content() const;

private:
    [[nodiscard]] const Json* find(const char* key, const char* type, bool (Json::*is)() const noexcept) const;
    Json json_;
};

/// The work's side of progress and cancelling.
class Watch {
public:
    [[nodiscard]] const std::atomic<bool>& cancelled() const { return cancelled_; }
    /// From any thread.
    void tell(double fraction, std::string stage);

private:
    friend std::string watched(sc_lab_progress, void*, const std::function<Json(Watch&)>&);
    std::atomic<bool> cancelled_{false};
    std::mutex lock_;
    double fraction_ = 0.0;
    std::string stage_;
    std::function<void()> told_; ///< called after each tell(), where there are no threads
};

/// Does the work, in a thread of its own if somebody watches; without threads, `progress` is called by the work itself.
/// Its exceptions come out here.
std::string watched(sc_lab_progress progress, void* context, const std::function<Json(Watch&)>& work);

/// A call of the laboratory.
const char* answer(const std::function<std::string()>& call) noexcept;

/// A scene that can be started.
struct Input {
    scene::Scene scene;
    std::shared_ptr<step::HostWorld> host;
    std::vector<std::string> notes;
};
/// "scene" (an object or a text; "file" names it) or the file "file". Refuses with all problems.
std::pair<std::string, std::string> sceneText(const Request& request);
Input startable(const std::string& text, const std::string& file,
                const std::vector<std::pair<std::string, double>>& parameters);

/// Finite numbers as they are, others as null.
Json numberJson(double value);
Json numbersJson(const std::vector<double>& values);

} // namespace supercircle::c
