#pragma once
// The experiments, one function each, and what several of them share.

#include "plugin/lab/validation/play.h"

namespace supercircle::validation {

void boundary(const Settings& settings, Experiment& e);        ///< T1
void shellOnCylinder(const Settings& settings, Experiment& e); ///< T2, tips sliding
void stuckShell(const Settings& settings, Experiment& e);      ///< T2, Type II: tips stuck, coiling, unfolding
void twoShells(const Settings& settings, Experiment& e);       ///< T3
void underGravity(const Settings& settings, Experiment& e);    ///< T4
void betweenPlates(const Settings& settings, Experiment& e);   ///< T5
void archesAndStruts(const Settings& settings, Experiment& e); ///< T6
void pinning(const Settings& settings, Experiment& e);         ///< T7
void closedForms(const Settings& settings, Experiment& e);     ///< T8
void capstan(const Settings& settings, Experiment& e);         ///< T8, a stiff rope
void grip(const Settings& settings, Experiment& e);            ///< T9

} // namespace supercircle::validation
