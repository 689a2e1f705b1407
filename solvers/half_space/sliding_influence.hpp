// Influence coefficients of a sliding linear viscoelastic half-space.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stridor {

/// One creep time of a material, as it acts in steady sliding.
struct SlidingCreep {
  double share = 0.0;   ///< w_k = (part of the creep compliance 1/E_0 − 1/E_∞) · E_0, > 0
  double length = 0.0;  ///< v τ_k, m; negative where the indenter slides towards −x
};

/// Displacement at the centre of one cell under unit pressure on another, in units of
/// (side of a cell)/(π E_0*), for a half-space over which the pressure slides
/// (docs/theory.md, 7.2):
///
///     K(i,j) = e_0 L(i,j) + Σ_k w_k I_k(i,j),   e_0 = 1 − Σ_k w_k,
///     I_k − l_k ∂I_k/∂x = L,   l_k = v τ_k / (side of a cell)
///
/// L is Love's displacement under a uniformly loaded square. I_k sums the memory of the pressure.
/// The memory of a point comes from ahead of it, so the equation is marched from large x down.
///
/// (i, j) is the offset of the observed cell from the loaded one, i along the sliding direction.
struct InfluenceTable {
  std::size_t num_cells = 0;  ///< N
  /// Row j = 0 … N of 2N entries, for i = 0 … N − 1, −N … −1; even in j.
  std::vector<double> values;

  /// @param i −N … N − 1
  /// @param j −N … N
  double at(int i, int j) const {
    const auto n = static_cast<std::size_t>(2 * num_cells);
    const auto column = static_cast<std::size_t>(i >= 0 ? i : i + static_cast<int>(n));
    return values[static_cast<std::size_t>(j >= 0 ? j : -j) * n + column];
  }
};

/// Displacement by a square of side 1 with uniform pressure 1, times π E*: ∫∫ dξ dη / r over the
/// square, at (x, y) from its centre. Love's closed form near the square, Gauss points where that
/// would cancel.
double love_square(double x, double y);

/// Makes influence tables of one grid size.
///
/// The samples of L along the way of the march do not depend on the speed. They are taken once, so
/// that a table for another speed costs a weighted sum of them. Between samples L is a polynomial
/// whose product with the fading memory exp(−z) is integrated exactly; hence every speed is
/// allowed, also those at which the memory fades within a fraction of a cell. Relative error below
/// 1e-8.
class SlidingInfluence {
 public:
  /// @param num_cells N, cells a side, 2 to 4096
  /// @throws std::invalid_argument if it is not
  explicit SlidingInfluence(std::size_t num_cells);

  std::size_t num_cells() const { return num_cells_; }

  /// @param creep     shares and lengths v τ_k; shares > 0, their sum < 1; all lengths of one sign
  /// @param cell_side m, > 0
  /// @throws std::invalid_argument if they are not
  InfluenceTable table(std::span<const SlidingCreep> creep, double cell_side) const;

 private:
  /// A way between two neighbouring columns, cut into panels with samples of L in each.
  struct March {
    std::vector<double> panel_ends;  ///< within [0, 1], ascending from 0
    std::size_t num_nodes = 0;       ///< of a panel
    std::size_t num_samples() const { return (panel_ends.size() - 1) * num_nodes; }
  };
  /// Columns first … last of a row that are marched alike.
  struct Stretch {
    int first = 0;
    int last = 0;
    std::size_t march = 0;    ///< in marches_
    std::size_t samples = 0;  ///< of the first column, in samples_
  };

  void add_memory(const SlidingCreep& creep, double cell_side, InfluenceTable& table) const;

  std::size_t num_cells_;
  std::vector<March> marches_;
  std::vector<std::vector<Stretch>> stretches_;  ///< of every row
  std::vector<double> samples_;
  std::vector<double> love_;  ///< as InfluenceTable::values
};

}  // namespace stridor
