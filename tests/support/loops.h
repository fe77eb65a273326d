#pragma once
// Loops for parallel::For that reveal a dependence on the order or on the thread of an iteration.

#include "supercircle/support/parallel.h"

#include <atomic>
#include <thread>
#include <vector>

namespace supercircle::test {

/// Last iteration first.
inline parallel::For backwards() {
    return [](std::size_t count, const std::function<void(std::size_t)>& body) {
        for (std::size_t i = count; i-- > 0;)
            body(i);
    };
}

/// The iterations are distributed over `number` new threads.
inline parallel::For threads(int number) {
    return [number](std::size_t count, const std::function<void(std::size_t)>& body) {
        std::atomic<std::size_t> next{0};
        std::vector<std::thread> all;
        for (int k = 0; k < number; ++k)
            all.emplace_back([&] {
                for (std::size_t i = next++; i < count; i = next++)
                    body(i);
            });
        for (std::thread& t : all)
            t.join();
    };
}

} // namespace supercircle::test
