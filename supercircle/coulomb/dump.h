#pragma once
// FCP2D files: one contact problem as recorded from a simulation, for benchmarks and bug reports.
//
// Little endian: "FCP2D\0\0\1"; int32 nb, nc, has_r0, has_kinds; double dt.
// Per body: int32 n, double A[n*n] by columns, vfree[n].
// Per contact: int32 a, int32 b (-1 = fixed), double mu, w[2], Ha[2*na], Hb[2*nb] (2 x n by columns, row 0 normal, row
// 1 tangent; none for -1). If has_r0: double r0[2*nc]. If has_kinds: int32 kind[nc], 0 unilateral, 1 bilateral (mu is
// then 0 or infinite). has_kinds is 0 if no contact is bilateral; such files conform to the first edition of the
// format.

#include "supercircle/coulomb/problem.h"

#include <string>
#include <string_view>

namespace supercircle::coulomb {

/// Writes the FCP2D image of `problem` (contact ids are not stored). Returns an empty string, or what went wrong.
[[nodiscard]] std::string encode(const Problem& problem, std::string& bytes);

/// Reads an FCP2D image. Returns an empty string, or a sentence with the byte offset; `problem` is then unchanged.
/// Every count is checked against the bytes left, and the result by `validate`.
[[nodiscard]] std::string decode(std::string_view bytes, Problem& problem);

/// The same for a file.
[[nodiscard]] std::string writeDump(const std::string& path, const Problem& problem);
[[nodiscard]] std::string readDump(const std::string& path, Problem& problem);

} // namespace supercircle::coulomb
