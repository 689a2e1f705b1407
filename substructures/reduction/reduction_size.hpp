// How large the reduction of a body is, before anything is allocated for it.
#pragma once

#include <string>

namespace stridor {

/// A body that Craig-Bampton reduces.
struct ReductionSize {
  double unknowns = 0.0;        ///< inside, without those of the interface
  double interface = 0.0;       ///< unknowns kept
  double watched = 0.0;         ///< rows of displacements that are wanted
  double modes = 0.0;           ///< fixed-interface modes
  double matrix_entries = 0.0;  ///< of mass and stiffness
  double factor_entries = 0.0;  ///< of the Cholesky factor of the stiffness inside
  double assembly_bytes = 0.0;  ///< while the matrices are assembled
};

/// Bytes of a real number, and of one of a sparse matrix with its row.
inline constexpr double dense_entry_bytes = 8.0;
inline constexpr double sparse_entry_bytes = 12.0;

/// The key of a body that makes it large, and what to do about it.
struct SizeKey {
  std::string key;  ///< below that of the body, e.g. ".mesh.along"
  std::string remedy;
};

}  // namespace stridor
