#include "solvers/integrators/coupled_step.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/MatrixFunctions>
#include <utility>

#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/integrators/two_step_scheme.hpp"

namespace stridor {
namespace {

/// e^Z, and φ₁(Z) = ∫₀¹ e^{Zs} ds.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> exponential_and_mean(const Eigen::MatrixXd& Z) {
  const Eigen::Index n = Z.rows();
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  both.topLeftCorner(n, n) = Z;
  both.topRightCorner(n, n).setIdentity();
  const Eigen::MatrixXd exponential = both.exp();
  return {exponential.topLeftCorner(n, n), exponential.topRightCorner(n, n)};
}

/// The body without damping and circulatory terms: r̈ + 𝒢 ṙ + diag(ω²) r = 0 in (ω r, v), whose
/// matrix (0, ω; −ω, −𝒢) is skew, so that its motions iλ have orthogonal vectors.
struct ConservativeMotions {
  Eigen::VectorXd rate;         ///< λ, of either sign, rad/s
  Eigen::MatrixXcd velocities;  ///< their parts in v; ω r needs not be divided by ω

  explicit ConservativeMotions(const ModalBody& body) {
    const Eigen::Index n = body.size();
    const Eigen::MatrixXd& V = body.coupled.velocity;
    Eigen::MatrixXcd hermitian = Eigen::MatrixXcd::Zero(2 * n, 2 * n);  // i times the skew matrix
    const std::complex<double> i(0.0, 1.0);
    hermitian.topRightCorner(n, n).diagonal() = i * body.omega.cast<std::complex<double>>();
    hermitian.bottomLeftCorner(n, n) = hermitian.topRightCorner(n, n).adjoint();
    hermitian.bottomRightCorner(n, n) = -0.5 * i * (V - V.transpose()).cast<std::complex<double>>();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> solver(hermitian);
    rate = -solver.eigenvalues();
    velocities = solver.eigenvectors().bottomRows(n);
  }

  /// Re Σ u_j value_j u_jᴴ.
  Eigen::MatrixXd sum(const Eigen::VectorXcd& values) const {
    return (velocities * values.asDiagonal() * velocities.adjoint()).real();
  }
};

/// What gyroscopic terms make of G and of J. With a = h A of the conservative body, and g(a) the
/// even function by which e of exact_propagation() exceeds the pure impulse, J = h g(a) (0, 1):
/// then G = Gᵀ + ½ J_r keeps the symplectic form.
struct GyroscopicPart {
  Eigen::MatrixXd feedthrough;   ///< added to diag(g)
  Eigen::MatrixXd impulse;  ///< J_r, skew: r just after the impulse, per force

  GyroscopicPart(const ModalBody& body, const ConservativeMotions& motions, double h,
                 double added) {
    Eigen::VectorXcd symmetric(motions.rate.size());
    Eigen::VectorXcd skew(motions.rate.size());
    for (Eigen::Index j = 0; j < motions.rate.size(); ++j) {
      const double rate = std::abs(motions.rate(j));
      const StepCoefficients c = exact_propagation(rate, 0.0, h, added);
      const double x = h * rate;
      // (1 − g)/x², by which 1 − g(a) = a² γ; 0/0 without stiffness, where it is δ.
      constexpr double smallest = 1e-3;
      const double g = x > smallest ? c.gain / (h * h) * x / std::sin(x) : 1.0;
      const double gamma = x > smallest ? (1.0 - g) / (x * x) : added;
      symmetric(j) = c.feedthrough;
      skew(j) = std::complex<double>(0.0, h * h * h * motions.rate(j) * gamma);
    }
    impulse = motions.sum(skew);
    feedthrough = motions.sum(symmetric) + 0.5 * impulse;
    for (Eigen::Index i = 0; i < body.size(); ++i)
      feedthrough(i, i) -= exact_propagation(body.omega(i), 0.0, h, added).feedthrough;
  }
};

void require_resolved(const Eigen::MatrixXd& turn, const ConservativeMotions& conservative,
                      double h, const std::string& name) {
  double fastest = h * conservative.rate.cwiseAbs().maxCoeff();
  for (const std::complex<double>& root : matrix_eigenvalues(turn))
    fastest = std::max(fastest, std::abs(root));
  constexpr double largest = CoupledStep::largest_turn;
  if (fastest <= largest) return;
  throw ConfigError(
      Refusal::step_too_large, "time.step",
      fmt::format("the fastest free motion of '{}', whose modes are coupled, has |s| = {:.4g} "
                  "1/s; with a step of {:.4g} s |s| h is {:.3g}, and {:g} is the most that exact "
                  "propagation takes; take a step of {:.3g} s or less",
                  name, fastest / h, h, fastest, largest, largest * h / fastest));
}

}  // namespace

Eigen::MatrixXd CoupledStep::alternating() const {
  const Eigen::Index n = position.rows();
  const Eigen::MatrixXd one_and_free = free + Eigen::MatrixXd::Identity(2 * n, 2 * n);
  return one_and_free.partialPivLu().solve(by_force).topRows(n);
}

CoupledStep make_coupled_step(const ModalBody& body, double step, std::optional<double> added,
                              double alpha, const std::string& name) {
  const Eigen::Index n = body.size();
  const double h = step;
  CoupledStep made;
  Eigen::MatrixXd V = body.coupled.velocity;
  V.diagonal().array() += alpha + body.damping.beta * body.omega.array().square();
  made.position = body.coupled.position;
  made.position.diagonal() += body.omega.array().square().matrix();

  // Velocities are multiplied by h, so that they and displacements are of one size.
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  turn.topRightCorner(n, n).setIdentity();
  turn.bottomLeftCorner(n, n) = -h * h * made.position;
  turn.bottomRightCorner(n, n) = -h * V;
  const ConservativeMotions conservative(body);
  require_resolved(turn, conservative, h, name);

  const auto [free, mean] = exponential_and_mean(turn);
  const Eigen::MatrixXd psi = mean.partialPivLu().solve(free);  // φ₁(−Z)⁻¹, as φ₁(−Z) = e^−Z φ₁(Z)
  const Eigen::PartialPivLU<Eigen::MatrixXd> K(h * V * psi.topRightCorner(n, n) +
                                               psi.bottomRightCorner(n, n));
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(2 * n);
  scale.tail(n).setConstant(1.0 / h);
  made.free = scale.asDiagonal() * free * scale.cwiseInverse().asDiagonal();
  made.by_constant = h * h * mean.topRightCorner(n, n);
  made.by_impulse = made.free.rightCols(n) * (h * K.inverse());

  made.feedthrough = Eigen::MatrixXd::Zero(n, n);
  made.by_force = made.by_impulse;
  if (!added) return made;
  const double delta = std::min(*added, CoupledStep::largest_added);
  const GyroscopicPart gyroscopic(body, conservative, h, delta);
  made.feedthrough = gyroscopic.feedthrough;
  const Eigen::VectorXd damping = body.mode_damping(alpha);
  for (Eigen::Index i = 0; i < n; ++i)
    made.feedthrough(i, i) += exact_propagation(body.omega(i), damping(i), h, delta).feedthrough;

  // J_v such that G and J together hold what the force asks for at rest, Q (r + G f) = f.
  const Eigen::MatrixXd& J = gyroscopic.impulse;
  const Eigen::MatrixXd held = (h * V * psi.topLeftCorner(n, n) + psi.bottomLeftCorner(n, n)) * J;
  const Eigen::MatrixXd left =
      h * h * (Eigen::MatrixXd::Identity(n, n) - made.position * made.feedthrough);
  Eigen::MatrixXd impulse(2 * n, n);
  impulse.topRows(n) = J;
  impulse.bottomRows(n) = K.solve(left - held) / h;
  made.by_force = made.free * impulse;
  return made;
}

}  // namespace stridor
