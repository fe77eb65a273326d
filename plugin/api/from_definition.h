#pragma once
// Makes the core's rod from a ShellDef.

#include "plugin/api/include/supercircle/definitions.hpp"
#include "supercircle/rod/model.h"
#include "supercircle/support/result.h"

#include <Eigen/Core>

namespace supercircle {

/// The input of the core for a rod.
struct RodFromDefinition {
    rod::RodDefinition definition;
    Eigen::VectorXd q; ///< layout of rod::RodModel
    Eigen::VectorXd v;
};

/// Arc length of a definition, m.
double shellLength(const ShellDef& d);

/// Fails with what is wrong with the definition.
Result<RodFromDefinition> fromDefinition(const ShellDef& d);

} // namespace supercircle
