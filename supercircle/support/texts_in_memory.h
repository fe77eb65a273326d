#pragma once
// Files that a program brings in its memory: a page has no others.

#include <map>
#include <memory>
#include <string>

namespace supercircle {

/// While it lives, what this thread reads by one of these paths is the text here; other paths are files as ever.
class TextsInMemory {
public:
    using Texts = std::map<std::string, std::string>; ///< path to content

    explicit TextsInMemory(std::shared_ptr<const Texts> texts);
    ~TextsInMemory();
    TextsInMemory(const TextsInMemory&) = delete;
    TextsInMemory& operator=(const TextsInMemory&) = delete;

    /// The text at that path as it was given; null: there is none.
    [[nodiscard]] static const std::string* find(const std::string& path);
    /// What this thread reads from, for a thread that works for it; may be null.
    [[nodiscard]] static std::shared_ptr<const Texts> current();

private:
    std::shared_ptr<const Texts> before_;
};

} // namespace supercircle
