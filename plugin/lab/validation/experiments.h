#pragma once
// The experiments, one function each, and what several of them share.

#include "plugin/lab/validation/simulation.h"

namespace supercircle::validation {

constexpr double kR = 0.0192;  ///< m, radius of the shells and cylinders, of their centre lines
constexpr double kThin = 2e-5; ///< m: a thickness of a thousandth of it, where comparisons are with rods without one

void snapBoundary(const ValidationSettings& settings, ValidationExperiment& e);
void shellOnCylinder(const ValidationSettings& settings, ValidationExperiment& e); ///< tips slide
void shellOnCylinderStuck(const ValidationSettings& settings,
                          ValidationExperiment& e); ///< Type II: stick, coil, unfold
void twoShells(const ValidationSettings& settings, ValidationExperiment& e);
void gravitySag(const ValidationSettings& settings, ValidationExperiment& e);
void plates(const ValidationSettings& settings, ValidationExperiment& e);
void statics(const ValidationSettings& settings, ValidationExperiment& e); ///< arches and struts
void pinning(const ValidationSettings& settings, ValidationExperiment& e);
void closedForms(const ValidationSettings& settings, ValidationExperiment& e);
void capstan(const ValidationSettings& settings, ValidationExperiment& e); ///< a stiff rope
void grip(const ValidationSettings& settings, ValidationExperiment& e);

} // namespace supercircle::validation
