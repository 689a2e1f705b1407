#include "app/stability/lowest_eigenvalues.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/stability/eigenvalue_report.hpp"
#include "core/blas.hpp"
#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"

namespace stridor {

LowestEigenvalues find_lowest(const Pencil& pencil, EigenvalueMethod method,
                              const SpectrumWindow& window) {
  const BlasGuard guard;
  LowestEigenvalues found;
  if (method == EigenvalueMethod::secular && !is_dense_cheaper(pencil)) {
    try {
      found.eigenvalues = secular_eigenvalues(pencil, window);
      // Pairs that lie close together leave more of the equations than others: of a small system
      // all eigenvalues cost no more than a search.
      constexpr Eigen::Index small = 200;
      const bool is_sure =
          std::none_of(found.eigenvalues.begin(), found.eigenvalues.end(), is_doubtful);
      if (is_sure || pencil.num_eigenvalues() > small) return found;
    } catch (const NumericalError& error) {
      if (pencil.num_eigenvalues() > most_dense) {
        throw NumericalError(
            Refusal::eigenvalues_incomplete,
            fmt::format("{} (--method dense; taken without being asked for up to {} eigenvalues, "
                        "here there are "
                        "{}), or keep fewer modes (time.retain)",
                        error.what(), most_dense, pencil.num_eigenvalues()));
      }
      found.remark = fmt::format(
          "the search for zeros of the secular function did not converge: all {} eigenvalues by "
          "the dense method, as for any up to {}; fewer modes (time.retain) are faster",
          pencil.num_eigenvalues(), most_dense);
    }
  }
  if (found.remark.empty() && method == EigenvalueMethod::secular &&
      pencil.num_eigenvalues() > most_dense) {
    found.remark = fmt::format(
        "contacts join most of the modes: all {} eigenvalues by the dense method; let interfaces of "
        "meshes move in fewer modes (interface.modes), which is faster",
        pencil.num_eigenvalues());
  }
  found.method = EigenvalueMethod::dense;
  found.eigenvalues = dense_eigenvalues(pencil);
  keep_window(found.eigenvalues, window);
  return found;
}

std::vector<Eigenvalue> lowest_eigenvalues(const Pencil& pencil, EigenvalueMethod method,
                                           const SpectrumWindow& window) {
  return find_lowest(pencil, method, window).eigenvalues;
}

void keep_window(std::vector<Eigenvalue>& all, const SpectrumWindow& window) {
  const auto first = std::find_if(all.begin(), all.end(),
                                  [](const Eigenvalue& one) { return one.s.imag() > 0.0; });
  auto last = std::find_if(
      first, all.end(), [&](const Eigenvalue& one) { return one.frequency() > window.frequency; });
  if (window.count)
    last = std::min(last, first + std::min<std::ptrdiff_t>(*window.count, last - first));
  all.erase(last, all.end());
}

bool is_growing(const Eigenvalue& eigenvalue) {
  constexpr double rounding = 1e-10;
  return eigenvalue.growth() > rounding * std::abs(eigenvalue.s);
}

}  // namespace stridor
