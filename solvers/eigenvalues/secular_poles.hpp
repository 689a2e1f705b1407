// The poles of a secular function: the modes of its bodies without contacts.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <complex>
#include <vector>

#include "solvers/algebra/aligned_array.hpp"
#include "solvers/eigenvalues/coupled_modes.hpp"
#include "solvers/eigenvalues/pencil.hpp"
#include "solvers/eigenvalues/secular_kernel.hpp"

namespace stridor {

/// The denominators d_i = s² + c_i s + ω_i² of a secular function (docs/theory.md, 7.3) in
/// ascending ω: modes of the pencil, and for those that terms of their body couple, pairs of
/// complex modes. Of a pair ω² is the product of its two poles, and −c their sum.
class SecularPoles {
 public:
  /// Takes the modes of a pencil. @returns whether they are others than before
  bool assign(const Pencil& pencil);

  /// Modes of the pencil.
  Eigen::Index num_modes() const { return num_modes_; }
  /// Denominators, as many as modes, or fewer where pairs of poles are of coupled modes.
  std::size_t size() const { return order_.size(); }
  std::size_t padded_size() const { return padded_; }
  SecularModes table() const { return {omega_.data(), damping_.data(), padded_}; }

  bool has_coupled() const { return coupled_.num_pairs() > 0; }
  const CoupledModes& coupled() const { return coupled_; }
  bool is_mode(std::size_t i) const { return order_[i] < num_modes_; }
  /// The mode of the pencil that a denominator is of.
  Eigen::Index mode(std::size_t i) const { return order_[i]; }
  /// The first pole in coupled() of one that is not of a mode; the other comes next.
  Eigen::Index coupled_pole(std::size_t i) const { return 2 * (order_[i] - num_modes_); }

  /// The zeros of a denominator: that with the larger imaginary part, or the right one of two real
  /// ones, first.
  std::array<std::complex<double>, 2> of(std::size_t i) const;
  std::complex<double> denominator(std::size_t i, std::complex<double> s) const {
    const double x = s.real();
    const double y = s.imag();
    return {(omega_[i] - y) * (omega_[i] + y) + x * (damping_[i] + x), y * (damping_[i] + 2.0 * x)};
  }
  std::complex<double> denominator_slope(std::size_t i, std::complex<double> s) const {
    return 2.0 * s + damping_[i];
  }
  /// Distance of a number from the nearest pole.
  double distance_from(std::complex<double> s) const;
  /// The one with the smallest |d|.
  int nearest(std::complex<double> s) const;
  /// Others whose poles nearly coincide with those of one.
  const std::vector<int>& cluster(std::size_t i) const { return clusters_[i]; }

  /// Height of a number over the sides of the wedge |Im s| < |Re s| in which growth or decay is
  /// faster than vibration: |Im s| − |Re s|, 1/s.
  static double height_of(std::complex<double> s) {
    return std::abs(s.imag()) - std::abs(s.real());
  }
  /// Heights of the poles, 0 for those within the wedge: by denominator, and ascending.
  const std::vector<double>& heights() const { return heights_; }
  const std::vector<double>& sorted_heights() const { return sorted_heights_; }

  /// A length beyond every pole, 1/s.
  double extent() const { return extent_; }
  /// Of those that are not zero; extent() where all are.
  double smallest() const { return smallest_; }

 private:
  /// Coupled terms of bodies as in a pencil, to see whether they change.
  struct BodyTerms {
    Eigen::MatrixXd ports, stiffness, damping;
    bool operator==(const BodyTerms& other) const;
  };
  static BodyTerms body_terms(const Pencil& pencil);
  /// Sets up the quantities that depend on the poles, in the order of order_.
  void sort(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping);
  void find_clusters();

  Eigen::VectorXd given_omega_, given_damping_;  ///< as in the pencil, to see whether they change
  BodyTerms given_terms_;
  CoupledModes coupled_;  ///< of the bodies with coupled terms
  /// In ascending ω: modes of the pencil, and n + j for pair j of the coupled modes.
  std::vector<Eigen::Index> order_;
  Eigen::Index num_modes_ = 0;
  std::size_t padded_ = 0;
  AlignedArray omega_, damping_;
  std::vector<std::vector<int>> clusters_;
  std::vector<double> heights_, sorted_heights_;
  double extent_ = 0.0;
  double smallest_ = 0.0;
};

}  // namespace stridor
