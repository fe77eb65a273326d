#pragma once
// Grids of cases of which the quick run tries a share, and the slow run all.

#include <cstddef>

namespace supercircle::test {

/// Chooses every n-th case of nested loops. n and the length of the innermost loops should have no common factor: then
/// each value of each loop is tried.
class Share {
public:
    explicit Share(std::size_t every) : every_(every) {}
    /// Whether the next case is tried.
    bool next() { return tried_++ % every_ == 0; }

private:
    std::size_t every_, tried_ = 0;
};

} // namespace supercircle::test
