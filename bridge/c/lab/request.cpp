#include "bridge/c/lab/request.h"

#include "bridge/box2d/lab_world.h"
#include "plugin/scene/loader/document.h"
#include "plugin/scene/loader/loader.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <thread>

namespace supercircle::c {

namespace {

constexpr std::chrono::milliseconds kPoll{100}; ///< between two calls of the caller's `progress`

/// Bytes of a text in base64 (RFC 4648, with padding).
std::string decoded(const std::string& text, const std::string& path) {
    static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t padding = text.size() - std::min(text.size(), text.find_last_not_of('=') + 1);
    std::string out;
    std::uint32_t bits = 0;
    int count = 0;
    for (std::size_t i = 0; i + padding < text.size(); ++i) {
        const std::size_t digit = kDigits.find(text[i]);
        if (digit == std::string_view::npos)
            refuse(SC_BAD_INPUT,
                   "\"content\" of the request: " + path + " is no base64 at character " + std::to_string(i + 1));
        bits = (bits << 6) | static_cast<std::uint32_t>(digit);
        count += 6;
        if (count >= 8) {
            count -= 8;
            out += static_cast<char>((bits >> count) & 0xffU);
        }
    }
    if (text.size() % 4 != 0 || padding > 2)
        refuse(SC_BAD_INPUT,
               "\"content\" of the request: " + path + " is no base64: it does not end in groups of four");
    return out;
}

} // namespace

Request::Request(const char* text, std::vector<std::string> keys) {
    json_ = parsed(text, "the request");
    if (!json_.is_object())
        refuse(SC_BAD_INPUT, "the request is not a JSON object");
    for (const auto& [key, value] : json_.items())
        if (std::find(keys.begin(), keys.end(), key) == keys.end())
            refuse(SC_BAD_INPUT, "the request has an unknown key \"" + key + "\"" + didYouMean(key, keys));
}

const Json* Request::find(const char* key, const char* type, bool (Json::*is)() const noexcept) const {
    const auto found = json_.find(key);
    if (found == json_.end() || found->is_null())
        return nullptr;
    if (!((*found).*is)())
        refuse(SC_BAD_INPUT, std::string("\"") + key + "\" of the request is not " + type);
    return &*found;
}

std::string Request::text(const char* key, const std::string& otherwise) const {
    const Json* v = find(key, "a text", &Json::is_string);
    return v != nullptr ? v->get<std::string>() : otherwise;
}

double Request::number(const char* key, double otherwise) const {
    const Json* v = find(key, "a number", &Json::is_number);
    return v != nullptr ? v->get<double>() : otherwise;
}

std::int64_t Request::integer(const char* key, std::int64_t otherwise, std::int64_t low, std::int64_t high) const {
    const double value = number(key, static_cast<double>(otherwise));
    if (!(value >= static_cast<double>(low) && value <= static_cast<double>(high) && std::floor(value) == value))
        refuse(SC_BAD_INPUT, std::string("\"") + key + "\" of the request must be a whole number from " +
                                 std::to_string(low) + " to " + std::to_string(high));
    return static_cast<std::int64_t>(value);
}

bool Request::flag(const char* key, bool otherwise) const {
    const Json* v = find(key, "true or false", &Json::is_boolean);
    return v != nullptr ? v->get<bool>() : otherwise;
}

std::vector<std::string> Request::texts(const char* key) const {
    std::vector<std::string> out;
    const Json* list = find(key, "a list of texts", &Json::is_array);
    for (const Json& v : list != nullptr ? *list : Json::array()) {
        if (!v.is_string())
            refuse(SC_BAD_INPUT, std::string("\"") + key + "\" of the request is not a list of texts");
        out.push_back(v.get<std::string>());
    }
    return out;
}

std::vector<std::pair<std::string, double>> Request::numbers(const char* key) const {
    std::vector<std::pair<std::string, double>> out;
    const Json* object = find(key, "an object of numbers", &Json::is_object);
    if (object == nullptr)
        return out;
    for (const auto& [name, value] : object->items()) {
        if (!value.is_number())
            refuse(SC_BAD_INPUT, std::string("\"") + key + "\" of the request: " + name + " is not a number");
        out.emplace_back(name, value.get<double>());
    }
    return out;
}

std::string Request::document(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end() || found->is_null())
        return {};
    if (found->is_string())
        return found->get<std::string>();
    if (found->is_object())
        return written(*found, 2);
    refuse(SC_BAD_INPUT, std::string("\"") + key + "\" of the request is neither an object nor a text");
}

std::shared_ptr<const TextsInMemory::Texts> Request::content() const {
    const Json* object = find("content", "an object of texts by path", &Json::is_object);
    if (object == nullptr)
        return nullptr;
    auto texts = std::make_shared<TextsInMemory::Texts>();
    for (const auto& [path, value] : object->items()) {
        const auto bytes = value.is_object() && value.size() == 1 ? value.find("base64") : value.end();
        if (value.is_string())
            (*texts)[path] = value.get<std::string>();
        else if (value.is_object() && bytes != value.end() && bytes->is_string())
            (*texts)[path] = decoded(bytes->get_ref<const std::string&>(), path);
        else
            refuse(SC_BAD_INPUT, "\"content\" of the request: " + path + " is neither a text nor {\"base64\": text}");
    }
    return texts;
}

void Watch::tell(double fraction, std::string stage) {
    {
        const std::lock_guard lock(lock_);
        fraction_ = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
        stage_ = std::move(stage);
    }
    if (told_)
        told_();
}

std::string watched(sc_lab_progress progress, void* context, const std::function<Json(Watch&)>& work) {
    Watch watch;
    Json result;
#if defined(SUPERCIRCLE_ONE_THREAD)
    if (progress != nullptr)
        watch.told_ = [&, last = std::chrono::steady_clock::time_point{}]() mutable {
            const auto now = std::chrono::steady_clock::now();
            if (now - last < kPoll)
                return;
            last = now;
            if (progress(context, watch.fraction_, watch.stage_.c_str()) != 0)
                watch.cancelled_ = true;
        };
    result = work(watch);
#else
    if (progress == nullptr) {
        result = work(watch);
    } else {
        const auto texts = TextsInMemory::current();
        std::exception_ptr failure;
        std::mutex lock;
        std::condition_variable changed;
        bool over = false;
        std::thread worker([&] {
            const TextsInMemory same(texts);
            try {
                result = work(watch);
            } catch (...) {
                failure = std::current_exception();
            }
            const std::lock_guard guard(lock);
            over = true;
            changed.notify_one();
        });
        for (std::unique_lock guard(lock); !changed.wait_for(guard, kPoll, [&] { return over; });) {
            guard.unlock();
            double fraction = 0.0;
            std::string stage;
            {
                const std::lock_guard told(watch.lock_);
                fraction = watch.fraction_;
                stage = watch.stage_;
            }
            if (!watch.cancelled_ && progress(context, fraction, stage.c_str()) != 0)
                watch.cancelled_ = true;
            guard.lock();
        }
        worker.join();
        if (failure)
            std::rethrow_exception(failure);
    }
#endif
    return written(result);
}

const char* answer(const std::function<std::string()>& call) noexcept {
    return text(call);
}

std::pair<std::string, std::string> sceneText(const Request& request) {
    const std::string text = request.document("scene"), file = request.text("file");
    if (!text.empty())
        return {text, file.empty() ? "scene" : file};
    if (file.empty())
        refuse(SC_BAD_INPUT, "the request needs a \"scene\" (an object or a text) or a \"file\"");
    std::vector<scene::Problem> problems;
    auto read = scene::readFile(file, problems);
    if (!read)
        refuse(SC_BAD_INPUT, scene::errorText(problems));
    return {*std::move(read), file};
}

Input startable(const std::string& text, const std::string& file,
                const std::vector<std::pair<std::string, double>>& parameters) {
    std::vector<scene::Override> overrides;
    for (const auto& [name, value] : parameters)
        overrides.push_back({name, value});
    std::vector<scene::Problem> problems;
    auto loaded = scene::loadText(text, file, overrides, problems);
    if (!loaded)
        refuse(SC_BAD_INPUT, loaded.error());
    std::string why;
    std::shared_ptr<step::HostWorld> host = bridge::makeWorld(loaded->rigid, why);
    if (!host)
        refuse(SC_BAD_INPUT, file + ": " + why);
    Input out{*std::move(loaded), std::move(host), {}};
    for (const scene::Problem& p : problems)
        out.notes.push_back(p.toString());
    return out;
}

Json numberJson(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json numbersJson(const std::vector<double>& values) {
    Json out = Json::array();
    for (const double v : values)
        out.push_back(numberJson(v));
    return out;
}

} // namespace supercircle::c

int32_t sc_lab_api_version(void) {
    return SC_API_VERSION;
}

const char* sc_lab_error(void) {
    return supercircle::c::lastError();
}

sc_status sc_lab_status(void) {
    return supercircle::c::lastStatus();
}
