// The lowest eigenvalues of a pencil, by the method asked for or the one that finds them.
#pragma once

#include <string>
#include <vector>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/pencil.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"

namespace stridor {

enum class EigenvalueMethod { secular, dense };

/// Real eigenvalues, then those of a window with positive imaginary part, lowest first; those there
/// are where there are fewer.
/// @throws NumericalError if they cannot be found
std::vector<Eigenvalue> lowest_eigenvalues(const Pencil& pencil, EigenvalueMethod method,
                                           const SpectrumWindow& window);

/// The same, and by which method they were found.
struct LowestEigenvalues {
  std::vector<Eigenvalue> eigenvalues;
  EigenvalueMethod method = EigenvalueMethod::secular;
  /// Why it is not the method asked for; empty where it is.
  std::string remark;

  const char* method_name() const {
    return method == EigenvalueMethod::dense ? "dense" : "secular";
  }
};

/// All eigenvalues are computed by the dense method where that is cheaper, or where the search for
/// zeros of the secular function does not converge and there are no more than 2,000.
/// @throws NumericalError if there are more, or as dense_eigenvalues()
LowestEigenvalues find_lowest(const Pencil& pencil, EigenvalueMethod method,
                              const SpectrumWindow& window);

/// Leaves real eigenvalues, and those of a window with positive imaginary part.
/// @param all ascending Im s
void keep_window(std::vector<Eigenvalue>& all, const SpectrumWindow& window);

/// Whether a motion grows: Re s > 0 by more than rounding, 1e-10 |s|.
bool is_growing(const Eigenvalue& eigenvalue);

}  // namespace stridor
