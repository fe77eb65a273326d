#pragma once
// The loop over threads that step/ runs its own stages with and hands down to contact/ and coulomb/.

#include "supercircle/support/parallel.h"

namespace supercircle::step {

/// A loop over up to `threads` threads (TBB); empty for one. Each turn is computed whole by one thread, so the digits
/// do not depend on the number.
parallel::For threadLoop(int threads);

/// For work on rods, some microseconds each: few rods are not worth waking another thread.
template <class Work>
void forEachRod(const parallel::For& loop, std::size_t count, Work&& work) {
    parallel::forEach(loop, count, count < 8 ? 8 : 4, work);
}

} // namespace supercircle::step
