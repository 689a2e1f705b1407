#include "solvers/integrators/coupled_propagator.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"
#include "solvers/algebra/vector_views.hpp"

namespace stridor {
void require_exact(const std::string& body, const TimeParameters& time) {
  if (time.integrator == Integrator::exact) return;
  throw ConfigError(Refusal::contradiction, "time.integrator",
                    fmt::format("must be exact: the modes of '{}' are coupled by gyroscopic or "
                                "circulatory terms or by damping",
                                body));
}

CoupledPropagator::CoupledPropagator(const ModalBody& body, const Eigen::MatrixXd& patterns,
                                     double step, std::optional<double> added, int num_ports,
                                     double alpha, std::span<const double> loads,
                                     const std::string& name)
    : Propagator(num_ports, added.has_value(), Residual{}),
      body_(body),
      name_(name),
      row_table_(body.rows.transpose()),
      patterns_(patterns),
      step_(step),
      added_(added),
      alpha_(alpha),
      load_(Eigen::VectorXd::Zero(body.size())),
      state_(Eigen::VectorXd::Zero(2 * body.size())),
      next_(state_) {
  renew();
  set_loads(loads);
  start();
}

void CoupledPropagator::renew() {
  by_step_ = make_coupled_step(body_, step_, added_, alpha_, name_);
  row_gains_ = by_step_.by_force * row_table_;
  constant_gains_ = by_step_.by_constant * row_table_;
  if (has_feedthrough()) feedthrough_gains_ = by_step_.feedthrough * row_table_;
  by_velocity_.compute(by_step_.free.topRightCorner(body_.size(), body_.size()));
  load_impulse_ = by_step_.by_impulse * load_;
  is_renewal_due_ = false;
}

void CoupledPropagator::set_mass_damping(double alpha) {
  if (alpha == alpha_) return;
  alpha_ = alpha;
  is_renewal_due_ = true;  // the forces at t_n still act as the prediction from t_n supposes
}

void CoupledPropagator::set_body_loads(std::span<const double> amplitudes) {
  if (amplitudes.empty()) return;
  load_ = patterns_ * as_vector(amplitudes);
  load_impulse_ = by_step_.by_impulse * load_;
}

void CoupledPropagator::predict() {
  next_.noalias() = by_step_.free * state_;
  next_ += load_impulse_;
}

void CoupledPropagator::advance_body(const double* forces, double* predicted) {
  state_.swap(next_);  // predict() writes the other anew
  for (int port = 0; port < num_ports(); ++port) state_ += forces[port] * row_gains_.col(row(port));
  if (is_renewal_due_) {
    renew();
    renew_compliances();
  }
  predict();
  const Eigen::VectorXd& seen = has_feedthrough() ? state_ : next_;
  for (int port = 0; port < num_ports(); ++port)
    predicted[port] = row_table_.col(row(port)).dot(seen.head(body_.size()));
}

double CoupledPropagator::body_displacement(int row) const {
  return row_table_.col(row).dot(state_.head(body_.size()));
}

double CoupledPropagator::ahead_displacement(int row) const {
  return row_table_.col(row).dot(next_.head(body_.size()));
}

double CoupledPropagator::predicted_displacement(int row) const {
  return has_feedthrough() && !is_starting() ? body_displacement(row) : ahead_displacement(row);
}

double CoupledPropagator::row_compliance(int row_a, int row_b) const {
  const auto a = row_table_.col(row_a);
  if (is_starting()) return a.dot(constant_gains_.col(row_b));
  if (has_feedthrough()) return a.dot(feedthrough_gains_.col(row_b));
  return a.dot(row_gains_.col(row_b).head(body_.size()));
}

double CoupledPropagator::ahead_compliance(int row_a, int row_b) const {
  const auto a = row_table_.col(row_a);
  return a.dot(row_gains_.col(row_b).head(body_.size())) +
         a.dot(feedthrough_gains_.col(row_b));
}

Eigen::VectorXd CoupledPropagator::modal_force(const double* forces) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(body_.size());
  for (int port = 0; port < num_ports(); ++port) force += forces[port] * row_table_.col(row(port));
  return force;
}

/// Both motions are to be at the same place at t_{n+1}, where the forces are still the same.
Eigen::VectorXd CoupledPropagator::velocity_before(const Eigen::VectorXd& force) const {
  const Eigen::Index n = body_.size();
  const Eigen::VectorXd at_once = by_step_.feedthrough * force;
  Eigen::VectorXd ahead = by_step_.by_constant * (load_ + force) - load_impulse_.head(n);
  ahead += by_step_.free.topLeftCorner(n, n) * at_once - at_once;
  ahead -= by_step_.by_force.topRows(n) * force;
  return by_velocity_.solve(ahead);
}

Propagator::Motion CoupledPropagator::motion(const double* forces) const {
  const Eigen::Index n = body_.size();
  const Eigen::VectorXd force = modal_force(forces);
  return {state_.head(n) + by_step_.feedthrough * force,
          state_.tail(n) - velocity_before(force)};
}

void CoupledPropagator::predict_step(const double* forces, std::span<double> position,
                                std::span<double> increment) const {
  const Eigen::Index n = body_.size();
  Eigen::Map<Eigen::VectorXd> r(position.data(), n);
  Eigen::Map<Eigen::VectorXd> d(increment.data(), n);
  r = state_.head(n);
  d = next_.head(n) - r;
  for (int port = 0; port < num_ports(); ++port)
    d += forces[port] * row_gains_.col(row(port)).head(n);
}

void CoupledPropagator::set_body_motion(const Eigen::VectorXd& displacement,
                                        const Eigen::VectorXd& velocity, const double* forces) {
  const Eigen::Index n = body_.size();
  const Eigen::VectorXd force = modal_force(forces);
  state_.head(n) = displacement - by_step_.feedthrough * force;
  state_.tail(n) = velocity + velocity_before(force);
  predict();
}

void CoupledPropagator::predict_body_start(const Eigen::VectorXd& displacement,
                                           const Eigen::VectorXd& velocity) {
  const Eigen::Index n = body_.size();
  state_ << displacement, velocity;
  next_.noalias() = by_step_.free * state_;
  next_.head(n) += by_step_.by_constant * load_;
}

double CoupledPropagator::initial_increment(int row, const Eigen::VectorXd& velocity) const {
  return step_ * row_table_.col(row).dot(velocity);
}

void CoupledPropagator::save_body(State& state, const std::string& prefix) const {
  state.put(prefix + "x", as_span(state_));
  state.put(prefix + "x_next", as_span(next_));
}

void CoupledPropagator::load_body(const State& state, const std::string& prefix) {
  state.get(prefix + "x", as_span(state_));
  state.get(prefix + "x_next", as_span(next_));
  if (!is_renewal_due_) return;
  renew();
  renew_compliances();
}

}  // namespace stridor
