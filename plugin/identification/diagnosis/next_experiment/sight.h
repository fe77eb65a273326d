#pragma once
// What the readings of a run that was not made are worth: what a recording of it would be, compared as recordings are
// (misfit.h), with the same rows left out. Until they were, rows beside a touch of the floor, which no fit looks at,
// were to tell a machine that gives from a contact that gives, one deflection on a strip, by seven deviations in six
// cycles.
//
// Two things are not as they would be. A jump that one of two simulations has and the other has not says nothing by
// itself, for near the size from which on it is one that hangs on little (as far off as one may be, as in a recording,
// the touches of that strip told the two apart in two cycles); a rival that does not snap reads something else behind.
// What a simulation is off by for its finite elements is not known, because a run that nobody made is simulated once
// and coarsely: what is foretold of repeats is too much where that is most of a simulation's error, on strips.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/misfit.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/diagnosis/noise.h"

#include <Eigen/Core>
#include <cstddef>
#include <optional>

namespace supercircle::diagnosis {

class Sight {
public:
    /// @param truth the run as it would be recorded, without noise; at least 8 readings
    /// @param noise of the sensors; a camera that was not there yet has the usual one
    /// @param zeroWindow as Data::zeroWindow, s
    /// @param repeats what simulations are off by is the same in all of them
    Sight(const Design& design, const DesignResponse& truth, const Noise& noise, double zeroWindow,
          std::size_t repeats);
    Sight(const Sight&) = delete;
    Sight& operator=(const Sight&) = delete;

    /// a minus b in noise units, whitened, of one repeat. Empty: they cannot be compared.
    [[nodiscard]] std::optional<Eigen::VectorXd> apart(const DesignResponse& a, const DesignResponse& b) const;

private:
    Data data_;
    Misfit misfit_; ///< of data_
};

} // namespace supercircle::diagnosis
