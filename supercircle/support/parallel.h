#pragma once
// Loops with independent iterations, for modules that own no threads. The caller may pass a loop that uses several
// threads. Results are bitwise identical on any number of threads: every iteration writes to its own slot, and the
// slots are read in order.

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace supercircle::parallel {

/// Calls body(0) .. body(count - 1), in any order and possibly at the same time. Returns when all are done.
/// An empty function means one after the other.
using For = std::function<void(std::size_t count, const std::function<void(std::size_t)>& body)>;

/// How many chunks forChunks makes: one without threads.
inline std::size_t chunkCount(const For& loop, std::size_t items, std::size_t grain) {
    return loop ? std::max<std::size_t>(1, (items + grain - 1) / grain) : 1;
}

/// Cuts [0, items) into chunks of `grain` and calls work(chunk, begin, end) for each. If several chunks
/// throw, the exception of the first chunk is passed on, as by a plain loop.
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

/// Reusable workspaces, as many as were ever in use at once. Results must not depend on which one an iteration gets.
template <class Space>
class Pool {
public:
    /// Holds one workspace during one iteration of a loop.
    class Lease {
    public:
        explicit Lease(Pool& pool) : pool_(pool), space_(pool.acquire()) {}
        ~Lease() { pool_.release(space_); }
        Lease(const Lease&) = delete;
        Lease& operator=(const Lease&) = delete;
        Space& operator*() const { return *space_; }
        Space* operator->() const { return space_; }

    private:
        Pool& pool_;
        Space* space_;
    };

private:
    Space* acquire() {
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
    void release(Space* space) {
        const std::lock_guard lock(mutex_);
        free_.push_back(space);
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<Space>> all_;
    std::vector<Space*> free_;
};

} // namespace supercircle::parallel
