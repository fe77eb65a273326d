#pragma once
// What the readings of a run that was not made are worth: what a recording of it would be, in the same errors, with
// the same rows left out (misfit.h). Until they were, rows beside a touch of the floor, which no fit looks at, were to
// tell a machine that gives from a contact that gives, one deflection on a strip, by seven deviations in six cycles.

#include "plugin/diagnosis/data.h"
#include "plugin/diagnosis/misfit.h"
#include "plugin/diagnosis/model.h"
#include "plugin/diagnosis/noise.h"

#include <Eigen/Core>
#include <cstddef>

namespace supercircle::diagnosis {

class Sight {
public:
    /// @param truth the run as it would be recorded, without noise; at least 8 readings
    /// @param zeroWindow as Data::zeroWindow, s
    /// @param repeats what simulations are off by is the same in all of them
    Sight(const Design& design, const DesignResponse& truth, const Noise& noise, double zeroWindow,
          std::size_t repeats);
    Sight(const Sight&) = delete;
    Sight& operator=(const Sight&) = delete;

    /// a minus b in noise units, whitened, one repeat of them; what either has of its own and what a jump hides is left
    /// out.
    [[nodiscard]] Eigen::VectorXd apart(const DesignResponse& a, const DesignResponse& b) const;

private:
    Data data_;
    Misfit misfit_; ///< of data_
};

} // namespace supercircle::diagnosis
