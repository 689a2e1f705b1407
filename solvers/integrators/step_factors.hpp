// The factors by which motions change in a step, from its characteristic function.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

namespace stridor {

/// The step of uncoupled modes whose contacts slide with rows that stay (FrozenStep).
struct FrozenModes {
  Eigen::VectorXd keep, pull, gain, feedthrough;  ///< s, k >= 0, e and g of every mode (StepCoefficients)
  Eigen::MatrixXd gaps, forces;              ///< C and E, contacts x modes
  bool is_instantaneous = false;             ///< whether forces close the gaps at t_n, with g
  /// What forces do through the modes that a body leaves out, R_b, and its share w.
  struct LeftOut {
    Eigen::MatrixXd closed;
    double share;
  };
  std::vector<LeftOut> left_out;
  Eigen::VectorXd compliance;  ///< c, gap per force of every contact; empty where all are rigid

  /// What forces λ_n close of the gaps at once: C e Eᵀ, or C g Eᵀ + Σ w R_b, and c.
  Eigen::MatrixXd closed() const;
};

/// All factors z, as zeros of the characteristic function of the step (docs/theory.md, 3.7):
///
///   det A(z) Π D_i(z) = 0,   D_i = w² + (1 − s_i + k_i) w + k_i,   w = z − 1,
///   A = Σ C_i e_i E_i/D_i,   or   A = c + Σ C_i (g_i + e_i z/D_i) E_i + Σ_b w_b R_b z/(z − 1 + w_b)
///
/// where forces close gaps at t_{n+1}, or at t_n. In w slow motions keep their relative accuracy.
/// The factors of the gaps, which one step closes, are 0.
///
/// @param modes of which closed() is regular
/// @return nothing where the sum of the zeros found and that of their squares are not the traces of
///         the matrix of the step and of its square, or for a scheme whose forces close gaps at
///         t_{n+1} while modes are left out or contacts give way
/// Cost: of order 10 N n k² for N factors, n modes and k contacts.
std::optional<std::vector<std::complex<double>>> step_factors(const FrozenModes& modes);

}  // namespace stridor
