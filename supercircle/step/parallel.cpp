#include "supercircle/step/parallel.h"

#if defined(SUPERCIRCLE_ONE_THREAD) // a build without TBB; results do not depend on the number of threads

namespace supercircle::step {

parallel::For threadLoop(int) {
    return {};
}

} // namespace supercircle::step

#else

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <memory>

namespace supercircle::step {

namespace {

tbb::task_arena& arenaOf(int threads) {
    static thread_local tbb::task_arena arena;
    if (!arena.is_active() || arena.max_concurrency() != threads) {
        arena.terminate();
        arena.initialize(threads);
    }
    return arena;
}

} // namespace

parallel::For threadLoop(int threads) {
    if (threads <= 1)
        return {};
    std::shared_ptr<tbb::global_control> more; // TBB allows as many threads as there are cores unless told otherwise
    if (threads > tbb::info::default_concurrency())
        more = std::make_shared<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                     static_cast<std::size_t>(threads));
    return [threads, more](std::size_t count, const std::function<void(std::size_t)>& body) {
        arenaOf(threads).execute([&] {
            tbb::parallel_for(
                tbb::blocked_range<std::size_t>(0, count),
                [&](const tbb::blocked_range<std::size_t>& range) {
                    for (std::size_t i = range.begin(); i < range.end(); ++i)
                        body(i);
                },
                tbb::simple_partitioner());
        });
    };
}

} // namespace supercircle::step

#endif
