#pragma once
// Loops whose turns are independent, for folders that know no threads. Whoever calls them may hand in a loop over
// several threads; the digits do not depend on it, because every turn writes into its own place and the places are read
// in order.

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace supercircle::parallel {

/// Calls body(0) .. body(count - 1), in any order, at the same time if it likes, and returns when all are done.
/// An empty one means: one after the other.
using For = std::function<void(std::size_t count, const std::function<void(std::size_t)>& body)>;

/// How many chunks forChunks makes: one without threads.
inline std::size_t chunkCount(const For& loop, std::size_t items, std::size_t grain) {
    return loop ? std::max<std::size_t>(1, (items + grain - 1) / grain) : 1;
}

/// Cuts [0, items) into chunks of `grain` and calls work(chunk, begin, end) for each. Of several exceptions the first
/// chunk's is thrown, as a plain loop would.
template <class Work>
void forChunks(const For& loop, std::size_t items, std::size_t grain, Work&& work) {
    const std::size_t chunks = chunkCount(loop, items, grain);
    if (chunks < 2) {
        work(std::size_t{0}, std::size_t{0}, items);
        return;
    }
    std::vector<std::exception_ptr> failed(chunks);
    loop(chunks, [&](std::size_t c) {
        try {
            work(c, c * grain, std::min(items, (c + 1) * grain));
        } catch (...) {
            failed[c] = std::current_exception();
        }
    });
    for (const std::exception_ptr& f : failed)
        if (f)
            std::rethrow_exception(f);
}

/// The same for each item.
template <class Work>
void forEach(const For& loop, std::size_t items, std::size_t grain, Work&& work) {
    forChunks(loop, items, grain, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            work(i);
    });
}

/// Work spaces that are kept: as many as were ever in use at once. Which one a turn gets must not matter.
template <class Space>
class Pool {
public:
    /// A work space on loan to one turn of a loop.
    class Loan {
    public:
        explicit Loan(Pool& pool) : pool_(pool), space_(pool.take()) {}
        ~Loan() { pool_.give(space_); }
        Loan(const Loan&) = delete;
        Loan& operator=(const Loan&) = delete;
        Space& operator*() const { return *space_; }
        Space* operator->() const { return space_; }

    private:
        Pool& pool_;
        Space* space_;
    };

private:
    Space* take() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) {
            all_.push_back(std::make_unique<Space>());
            free_.reserve(all_.size());
            return all_.back().get();
        }
        Space* space = free_.back();
        free_.pop_back();
        return space;
    }
    void give(Space* space) {
        const std::lock_guard lock(mutex_);
        free_.push_back(space);
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<Space>> all_;
    std::vector<Space*> free_;
};

} // namespace supercircle::parallel
