#pragma once
// A channel of a simulated run over time (private to replay/).

#include <cstddef>
#include <vector>

namespace supercircle::replay {

/// A channel over time with its rate. Cubic interpolation is accurate to the fourth power of the step.
struct Track {
    std::vector<double> value, rate; ///< without rates (forces, accelerations): those of parabolas through the steps

    [[nodiscard]] double at(const std::vector<double>& time, std::size_t row, double t) const {
        const double h = time[row + 1] - time[row], s = (t - time[row]) / h, r = 1.0 - s;
        if (h <= 0.0)
            return value[row + 1];
        if (rate.empty())
            return r * value[row] + s * value[row + 1] +
                   r * s * (r * bend(time, row) + s * bend(time, row + 1)) * h * h;
        return r * r * (1.0 + 2.0 * s) * value[row] + s * s * (1.0 + 2.0 * r) * value[row + 1] +
               h * (r * r * s * rate[row] - s * s * r * rate[row + 1]);
    }

private:
    /// Minus half of the second derivative at a step; 0 at the ends and beside steps that an event has cut.
    [[nodiscard]] double bend(const std::vector<double>& time, std::size_t k) const {
        if (k == 0 || k + 1 >= time.size())
            return 0.0;
        const double a = time[k] - time[k - 1], b = time[k + 1] - time[k];
        if (a < 0.9 * b || b < 0.9 * a)
            return 0.0;
        return -((value[k + 1] - value[k]) / b - (value[k] - value[k - 1]) / a) / (a + b);
    }
};

} // namespace supercircle::replay
