#include "solvers/prompt_surplus.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <vector>

#include "solvers/contact_path.hpp"
#include "solvers/modal_recurrence.hpp"

namespace stridor {
namespace {

/// What a point of a body does per force on it: at once, in the next step, and at once by surplus.
struct PointAnswer {
  Eigen::Matrix2d prompt = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d next = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d surplus = Eigen::Matrix2d::Zero();       ///< per δ, to `prompt`
  Eigen::Matrix2d surplus_next = Eigen::Matrix2d::Zero();  ///< likewise, taken from `next`

  PointAnswer& operator+=(const PointAnswer& other) {
    prompt += other.prompt;
    next += other.next;
    surplus += other.surplus;
    surplus_next += other.surplus_next;
    return *this;
  }
};

/// Coefficients of all modes of a body as it is marched without surplus.
std::vector<StepCoefficients> coefficients_of(const ModalBody& body, const TimeParameters& time) {
  std::vector<StepCoefficients> coefficients;
  const Eigen::VectorXd damping = body.mode_damping(body.damping.alpha);
  for (Eigen::Index i = 0; i < body.size(); ++i) {
    coefficients.push_back(
        step_coefficients(time.integrator, body.omega(i), damping(i), time.step, 0.0));
  }
  return coefficients;
}

PointAnswer answer_of(const ModalBody& body, const std::vector<StepCoefficients>& coefficients,
                      const WeightedRows& point, double step) {
  const Eigen::MatrixXd entries = rows_of(body.rows, point);
  PointAnswer sum;
  for (Eigen::Index i = 0; i < body.size(); ++i) {
    const StepCoefficients& c = coefficients[static_cast<std::size_t>(i)];
    const Eigen::Matrix2d square = entries.col(i) * entries.col(i).transpose();
    // Of an oscillation that changes sign with every step, e/((1 + r₁)(1 + r₂)) per force; a
    // quarter of e for a free mass without damping.
    const double alternating = 4.0 / (2.0 + 2.0 * c.keep - c.pull);
    sum.prompt += c.prompt * square;
    sum.next += alternating * c.gain * square;
    sum.surplus += c.answer() * square;
    sum.surplus_next += alternating * c.pull * c.answer() * square;
  }
  const Eigen::MatrixXd& residual = body.residual.flexibility;
  if (residual.size() > 0) {
    // Of a force that changes its sign with every step, w/(2 − w).
    const double share = step / (step + 2.0 * body.residual.beta);
    sum.prompt += share * rows_of(rows_of(residual, point).transpose(), point);
  }
  return sum;
}

/// Least δ with which q (P + δ S) − (W − δ V) is positive semidefinite.
double least_surplus(const PointAnswer& at, double limit) {
  const Eigen::Matrix2d lacking = at.next - limit * at.prompt;
  Eigen::Matrix2d gained = limit * at.surplus + at.surplus_next;
  // A point that cannot move in one direction gains nothing there, and lacks nothing.
  gained += 1e-12 * gained.trace() * Eigen::Matrix2d::Identity();
  if (!(gained.trace() > 0.0)) return 0.0;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> pair(
      0.5 * (lacking + lacking.transpose()), 0.5 * (gained + gained.transpose()),
      Eigen::EigenvaluesOnly);
  return std::max(0.0, pair.eigenvalues().maxCoeff());
}

/// Least δ with which every mode by itself has q g ≥ e/(1 + r₁)(1 + r₂), which no contact can ask
/// more than. With exact propagation at most 1/q − 1/12.
double surplus_of_every_mode(const System& system, const TimeParameters& time, double limit) {
  double surplus = 0.0;
  for (const SystemBody& body : system.bodies) {
    for (const StepCoefficients& c : coefficients_of(body.modal, time)) {
      const double alternating = 0.25 * (2.0 + 2.0 * c.keep - c.pull);
      const double lacking = c.gain - limit * c.prompt * alternating;
      const double gained = c.answer() * (limit * alternating + c.pull);
      if (gained > 0.0) surplus = std::max(surplus, lacking / gained);
    }
  }
  return surplus;
}

}  // namespace

std::optional<double> prompt_surplus(const System& system, const TimeParameters& time) {
  if (time.integrator == Integrator::central_difference && !time.retain) return std::nullopt;
  // A force law acts by where the body is at the beginning of a step.
  if (std::any_of(system.contacts.begin(), system.contacts.end(),
                  [](const ContactPoint& contact) { return contact.substrate.has_value(); })) {
    return std::nullopt;
  }
  // Stable are ratios up to 4. Friction, damping and what changes along the path want some room.
  constexpr double limit = 3.6;
  const double enough = surplus_of_every_mode(system, time, limit);
  if (system.contacts.size() != 1) return system.contacts.empty() ? 0.0 : enough;
  const ContactPoint& contact = system.contacts.front();
  const auto body = [&](int index) -> const ModalBody& {
    return system.bodies[static_cast<std::size_t>(index)].modal;
  };
  const ModalBody& slave = body(contact.slave_body);
  const ModalBody& master = body(system.surface_of(contact).body);
  const PointAnswer of_slave =
      answer_of(slave, coefficients_of(slave, time), {{contact.slave_rows}, {1.0}}, time.step);
  const std::vector<StepCoefficients> coefficients = coefficients_of(master, time);
  double surplus = 0.0;
  for (const WeightedRows& place : path_of(system, contact, time.end)) {
    PointAnswer both = of_slave;
    both += answer_of(master, coefficients, place, time.step);
    surplus = std::max(surplus, least_surplus(both, limit));
  }
  return std::min(surplus, enough);
}

}  // namespace stridor
