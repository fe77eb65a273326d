#pragma once
// Makes the core's rod from a ShellDef.

#include "plugin/api/include/supercircle/definitions.hpp"
#include "supercircle/rod/model.h"

#include <Eigen/Core>
#include <string>

namespace supercircle {

/// The input of the core for a rod.
struct RodFromDefinition {
    rod::RodDefinition definition;
    Eigen::VectorXd q; ///< layout of rod::RodModel
    Eigen::VectorXd v;
};

/// Arc length of a definition, m.
double shellLength(const ShellDef& d);

/// Fills `out`; empty string, or what is wrong with the definition.
std::string fromDefinition(const ShellDef& d, RodFromDefinition& out);

} // namespace supercircle
