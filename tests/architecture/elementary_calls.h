#pragma once
// Finds calls of functions whose last bits depend on the machine: elementary functions of C and C++ libraries, Eigen's
// and muParser's ways to them, distributions of random numbers (decision 0186).

#include <string>
#include <vector>

namespace supercircle::architecture {

/// What a line of code calls, empty if it calls none. Comments and strings do not count.
/// @param own the line is of the elementary functions themselves, which call each other without a namespace
std::string machineDependentCall(const std::string& line, bool own);

/// True for the files whose numbers enter results: the core, bridges, the public calls, scenes, recordings, laboratory
/// and identification.
bool decidesNumbers(const std::string& file);

} // namespace supercircle::architecture
