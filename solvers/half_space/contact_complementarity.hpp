// Contact of a rigid shape with a sliding half-space as a complementarity problem.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "solvers/half_space/half_space_convolution.hpp"

namespace stridor {

struct ComplementarityLimits {
  double tolerance = 1e-7;          ///< of the residual, > 0
  std::size_t max_rounds = 100;     ///< sets of contact cells that are tried, ≥ 1
  std::size_t max_directions = 60;  ///< of GMRES in a round, ≥ 1; memory grows with it
};

struct ComplementarityOutcome {
  bool converged = false;
  std::size_t rounds = 0;    ///< sets of contact cells
  std::size_t products = 0;  ///< transforms there and back, with K or its approximate inverse
  /// ‖K p − h‖ over the contact cells, root mean square, over the largest h.
  double residual = 0.0;
};

/// Solves p ≥ 0, K p − h ≥ 0, p (K p − h) = 0 on the cells of a HalfSpaceConvolution
/// (docs/theory.md, 8.3).
///
/// Primal-dual active set: with a set of contact cells given, K p = h is solved on it by GMRES;
/// cells that would have to pull leave the set, cells into which the shape would sink join it,
/// until nothing changes. K is not symmetric once there is memory, so neither conjugate gradients
/// nor splittings by its symmetric part would do. GMRES is preconditioned by apply_inverse() and,
/// while the set still changes, stopped early.
class ContactComplementarity {
 public:
  /// @param half_space outlives this object
  explicit ContactComplementarity(HalfSpaceConvolution& half_space);

  /// @param target   h on every cell, in the unit of K p; −infinity where the shape has ended
  /// @param limits   checked
  /// @param pressure in: where to start, e.g. the solution nearby; out: p. Where the limits were
  ///                 reached it is the last iterate.
  /// @throws std::invalid_argument if a size or a limit is wrong
  ComplementarityOutcome solve(std::span<const double> target, const ComplementarityLimits& limits,
                               std::span<double> pressure);

  /// K p of the last solution.
  std::span<const double> displacement() const { return displacement_; }

 private:
  using Field = std::vector<double>;
  /// Continues towards K p = h on the contact cells; updates pressure, displacement and residual.
  void approach(std::span<double> pressure, double wanted_norm,
                const ComplementarityLimits& limits);
  void restrict_to_contact(std::span<double> field) const;
  void update_residual(std::span<const double> target);
  /// Cells that have changed sides.
  struct Exchange {
    std::size_t num_left = 0;    ///< pulled
    std::size_t num_joined = 0;  ///< would overlap
  };
  /// @param sinking depth below the target from which on a cell overlaps
  Exchange exchange_cells(std::span<const double> target, double sinking,
                          std::span<double> pressure);
  void check(std::span<const double> target, const ComplementarityLimits& limits,
             std::span<const double> pressure) const;

  HalfSpaceConvolution& half_space_;
  std::vector<unsigned char> in_contact_;
  Field displacement_;
  Field residual_;
  std::size_t products_ = 0;
  // Of GMRES: orthonormal residuals, directions and K times them; kept between calls.
  std::vector<Field> basis_;
  std::vector<Field> directions_;
  std::vector<Field> images_;
};

}  // namespace stridor
