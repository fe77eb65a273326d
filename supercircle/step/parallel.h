#pragma once
// A loop over independent items. The items are independent and each is computed whole by one thread, so the digits do
// not depend on the number of threads.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <utility>

namespace supercircle::step {

template <class Body>
void parallelFor(int count, int threads, Body&& body) {
    if (threads <= 1 || count < 8) {
        for (int i = 0; i < count; ++i)
            body(static_cast<std::size_t>(i));
        return;
    }
    static thread_local tbb::task_arena arena;
    if (!arena.is_active() || arena.max_concurrency() != threads) {
        arena.terminate();
        arena.initialize(threads);
    }
    arena.execute([&] {
        tbb::parallel_for(tbb::blocked_range<int>(0, count, 4), [&](const tbb::blocked_range<int>& range) {
            for (int i = range.begin(); i < range.end(); ++i)
                body(static_cast<std::size_t>(i));
        });
    });
}

} // namespace supercircle::step
