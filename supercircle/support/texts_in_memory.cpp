#include "supercircle/support/texts_in_memory.h"

#include <utility>

namespace supercircle {

namespace {

thread_local std::shared_ptr<const TextsInMemory::Texts> readable;

} // namespace

TextsInMemory::TextsInMemory(std::shared_ptr<const Texts> texts) : before_(std::exchange(readable, std::move(texts))) {}

TextsInMemory::~TextsInMemory() {
    readable = std::move(before_);
}

const std::string* TextsInMemory::find(const std::string& path) {
    if (!readable)
        return nullptr;
    const auto found = readable->find(path);
    return found != readable->end() ? &found->second : nullptr;
}

std::shared_ptr<const TextsInMemory::Texts> TextsInMemory::current() {
    return readable;
}

} // namespace supercircle
