#pragma once
// Statistics with 90 % intervals.

#include <vector>

namespace supercircle::blind_benchmark {

struct Proportion {
    int hits = 0, of = 0;
    void count(bool hit) {
        hits += hit ? 1 : 0;
        ++of;
    }
    [[nodiscard]] double value() const { return of > 0 ? static_cast<double>(hits) / of : 0.0; }
    /// 90 % interval (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209).
    [[nodiscard]] double low() const;
    [[nodiscard]] double high() const;
};

struct Estimate {
    double value = 0.0, low = 0.0, high = 0.0; ///< with a 90 % bootstrap interval
    std::size_t of = 0;
};
Estimate median(std::vector<double> values);
Estimate mean(const std::vector<double>& values);

} // namespace supercircle::blind_benchmark
