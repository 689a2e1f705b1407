// Displacements of a half-space under pressures on a square grid, by Fourier transforms.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "core/fft_plan.hpp"
#include "solvers/half_space/sliding_influence.hpp"

namespace stridor {

/// Displacements under pressures that slide over a viscoelastic half-space and are even in y:
///
///     u(i,j) = Σ K(i − i', j − j') p(i', j')
///
/// over the N × N cells of a square window, with K of SlidingInfluence. Only the half y > 0 is
/// stored: fields have N/2 rows of N values, row 0 next to the axis, values along x. The window is
/// padded with as many empty cells, so that the periodic sum of the transform is the plain one.
/// Along x the transform is a real Fourier transform, along y a cosine transform, which carries the
/// evenness; it is a complex Fourier transform of the rows in another order (Makhoul 1980), for
/// which FFTW has vector code. Memory grows as N².
class HalfSpaceConvolution {
 public:
  /// Makes the samples of the coefficients and the plans of FFTW, which serve every speed. The
  /// material is elastic at first.
  /// @param num_cells N, even, 2 to 4096
  /// @throws std::invalid_argument if it is not; std::bad_alloc
  explicit HalfSpaceConvolution(std::size_t num_cells);

  std::size_t num_cells() const { return influence_.num_cells(); }
  std::size_t num_values() const { return num_cells() * num_cells() / 2; }
  const SlidingInfluence& influence() const { return influence_; }

  /// Sets material and speed.
  /// @throws std::invalid_argument as SlidingInfluence::table()
  void set_creep(std::span<const SlidingCreep> creep, double cell_side);

  /// u = K p. Allocates nothing.
  /// @param pressure     N/2 × N
  /// @param displacement N/2 × N; may be `pressure`
  void apply(std::span<const double> pressure, std::span<double> displacement);

  /// An approximate inverse of K, which makes a preconditioner: division by the transform of the
  /// elastic coefficients on the padded window and by the factor of the sliding memory,
  ///
  ///     e_0 + Σ_k w_k / (1 − i k_x l_k),
  ///
  /// cut to the window. The transform of K itself would not do: on the padded window the wake of
  /// one side runs into the other, and for v τ near the size of the contact its transform passes
  /// close to 0. Otherwise as apply().
  void apply_inverse(std::span<const double> displacement, std::span<double> pressure);

 private:
  /// Takes the transform of a table; leaves it in lines_.
  void transform(const InfluenceTable& table);
  /// From the Fourier transforms along y in lines_ to the cosine transforms, times `factors`, and
  /// to what is transformed back.
  void multiply_cosine_lines(const std::vector<std::complex<double>>& factors);
  /// Number of even rows among the N/2: 0, 2, ...
  std::size_t num_even_rows() const { return (num_cells() / 2 + 1) / 2; }
  void transform_with(const std::vector<std::complex<double>>& factors,
                      std::span<const double> from, std::span<double> to);

  SlidingInfluence influence_;
  std::size_t num_lines_;  ///< N + 1 lines of the transform along x
  detail::FftwReals rows_;
  detail::FftwComplexes lines_;
  std::vector<double> elastic_symbol_;                ///< without scale
  std::vector<std::complex<double>> symbol_;          ///< with the factors of the transforms
  std::vector<std::complex<double>> inverse_symbol_;  ///< likewise
  std::vector<std::complex<double>> turns_;           ///< exp(−iπ k/(2N)), k = 0 … N/2
  detail::FftwPlan even_along_x_;
  detail::FftwPlan odd_along_x_;
  detail::FftwPlan along_y_;
  detail::FftwPlan back_along_y_;
  detail::FftwPlan even_back_along_x_;
  detail::FftwPlan odd_back_along_x_;
  detail::FftwPlan table_along_x_;
  detail::FftwPlan table_along_y_;
};

}  // namespace stridor
