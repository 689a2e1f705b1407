// The matrix A(s) of a secular function: what contacts make of the modes.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "solvers/algebra/aligned_array.hpp"
#include "solvers/eigenvalues/pencil.hpp"
#include "solvers/eigenvalues/secular_poles.hpp"

namespace stridor {

/// A matrix bordered by modes whose poles are multiplied out, and its derivative by s.
struct BorderedMatrix {
  Eigen::MatrixXcd value, slope;
};

/// The entries of A(s) (docs/theory.md, 7.3) as weights over the denominators,
/// A_ab = δ_ab + Σ_i Σ_power s^power w_i/d_i(s), with δ only below the rows of the constraints.
class SecularWeights {
 public:
  /// Takes contacts and coupled terms of a pencil.
  /// @param poles of the same pencil
  void assign(const Pencil& pencil, const SecularPoles& poles);

  Eigen::Index num_constraints() const { return rows_.num_constraints; }
  Eigen::Index num_rows() const { return rows_.num_constraints + rows_.rank; }
  /// Powers of s in the weights of an input, from 0.
  Eigen::Index num_powers(Eigen::Index input) const {
    return (input < rows_.num_constraints ? 1 : 2) + (has_coupled_ ? 1 : 0);
  }
  /// Whether A is the one sum Σ w/d.
  bool is_scalar() const { return rows_.num_constraints == 1 && rows_.rank == 0 && !has_coupled_; }
  /// δ_ab.
  bool has_one(Eigen::Index output, Eigen::Index input) const {
    return input >= rows_.num_constraints && output == input;
  }
  AlignedArray& of(Eigen::Index output, Eigen::Index input, Eigen::Index power) {
    return weights_[static_cast<std::size_t>(output + num_rows() * (input + num_rows() * power))];
  }
  AlignedArray& only() { return weights_.front(); }  ///< where it is scalar

  /// Rows and columns that a denominator takes in a border: one of a mode, two of a pair of poles.
  static Eigen::Index border_size(const SecularPoles& poles, std::size_t i) {
    return poles.is_mode(i) ? 1 : 2;
  }
  /// Fills those of one. @param at its first
  void border(const SecularPoles& poles, std::complex<double> s, std::size_t i, Eigen::Index at,
              BorderedMatrix& matrix) const;

 private:
  void add_mode(const SecularPoles& poles, std::size_t i);
  void add_pair(const SecularPoles& poles, std::size_t i);
  void border_mode(const SecularPoles& poles, std::complex<double> s, std::size_t i,
                   Eigen::Index at, BorderedMatrix& matrix) const;
  void border_pole(const SecularPoles& poles, std::complex<double> s, Eigen::Index pole,
                   Eigen::Index at, BorderedMatrix& matrix) const;

  ModalRows rows_;  ///< of the contacts, and of coupled terms that could not be diagonalised
  bool has_coupled_ = false;
  Eigen::MatrixXcd coupled_outputs_, coupled_inputs_;  ///< rows_ on the coupled modes
  std::vector<AlignedArray> weights_;                  ///< of(); empty where there is none
};

}  // namespace stridor
