// Single bodies and the ways to march them in modes.
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <optional>
#include <span>

#include "solvers/integrators/modal_recurrence.hpp"

namespace stridor::test {

/// A chain of three masses between springs, damped in proportion; row r is mass r.
inline ReducedBody chain(double alpha, double beta) {
  ReducedBody body;
  body.mass = Eigen::Vector3d(1.0, 2.0, 0.5).asDiagonal();
  body.stiffness = Eigen::Matrix3d{{300, -100, 0}, {-100, 300, -200}, {0, -200, 200}};
  body.damping.alpha = alpha;
  body.damping.beta = beta;
  body.rows = Eigen::Matrix3d::Identity();
  return body;
}

inline ReducedBody single_mass(double mass, double stiffness, double alpha, double beta) {
  ReducedBody body;
  body.mass = Eigen::MatrixXd::Constant(1, 1, mass);
  body.stiffness = Eigen::MatrixXd::Constant(1, 1, stiffness);
  body.damping.alpha = alpha;
  body.damping.beta = beta;
  body.rows = Eigen::MatrixXd::Identity(1, 1);
  return body;
}

/// δ of the exact forms.
inline constexpr double exact_delta = 0.02;

/// Modes marched by a scheme; those above a cut-off truncated to their residual flexibility.
template <Integrator scheme>
std::unique_ptr<Propagator> make_modal_form(const ReducedBody& body,
                                            const Eigen::MatrixXd& patterns, double step, int ports,
                                            std::span<const double> loads, double cutoff = 1e300) {
  const ModalBody modal = with_static_residual(make_modal(body), cutoff);
  // Patterns are given in reduced coordinates, ΦᵀMΦ = I.
  const Eigen::MatrixXd forces = body.rows.transpose().inverse() * patterns;
  return std::make_unique<ModalRecurrence>(
      modal, modal.shapes.transpose() * patterns, scheme, step,
      scheme == Integrator::exact ? std::optional(exact_delta) : std::nullopt, ports,
      body.damping.alpha_at(0.0), loads,
      Propagator::Residual{modal.residual,
                           modal.residual.flexibility.size() > 0
                               ? Eigen::MatrixXd(modal.residual.flexibility * forces)
                               : Eigen::MatrixXd(),
                           modal.residual.shapes.size() > 0
                               ? Eigen::MatrixXd(modal.residual.shapes * forces)
                               : Eigen::MatrixXd(),
                           step});
}

struct ExactForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int ports, std::span<const double> loads) {
    return make_modal_form<Integrator::exact>(body, patterns, step, ports, loads);
  }
};
/// The highest of the three modes of chain(), 24 rad/s, is truncated.
struct ResidualForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int ports, std::span<const double> loads) {
    return make_modal_form<Integrator::exact>(body, patterns, step, ports, loads, 20.0);
  }
};

inline const Eigen::MatrixXd no_patterns = Eigen::MatrixXd(1, 0);

/// Error at t = 1 of u'' + c u' + k u = F(t) with the solution u = t³ e^{-t}, which starts at rest
/// with u'' = 0, so that u_0 = u_{-1} = 0 is right to third order.
template <class Form>
double error_at_one(double alpha, double beta, int num_steps) {
  constexpr double stiffness = 40.0;
  const double c = alpha + beta * stiffness;
  const double step = 1.0 / num_steps;
  const auto force = [&](double t) {
    const double u = t * t * t;
    const double v = 3 * t * t - t * t * t;
    const double a = 6 * t - 6 * t * t + t * t * t;
    return std::exp(-t) * (a + c * v + stiffness * u);
  };
  const double start[] = {0.0};
  const auto body = Form::make(single_mass(1.0, stiffness, alpha, beta),
                               Eigen::MatrixXd::Identity(1, 1), step, 0, start);
  for (int n = 1; n <= num_steps; ++n) {
    const double load[] = {force(n * step)};
    body->set_loads(load);
    body->advance(nullptr);
  }
  body->settle(nullptr);
  return std::abs(body->displacement(0) - std::exp(-1.0));
}

}  // namespace stridor::test
