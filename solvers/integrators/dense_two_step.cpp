#include "solvers/integrators/dense_two_step.hpp"

#include <Eigen/Cholesky>

#include "core/errors.hpp"
#include "solvers/algebra/vector_views.hpp"

namespace stridor {
namespace {

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& mass) {
  const Eigen::LLT<Eigen::MatrixXd> factor(mass);
  if (factor.info() != Eigen::Success)
    throw NumericalError(Refusal::singular, "the reduced mass is not positive definite");
  return factor.solve(Eigen::MatrixXd::Identity(mass.rows(), mass.cols()));
}

}  // namespace

PublishedTwoStep::PublishedTwoStep(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                   double step, int num_ports, double alpha,
                                   std::span<const double> loads)
    : Propagator(num_ports),
      body_(body),
      row_table_(body.rows.transpose()),
      patterns_(patterns),
      step_(step),
      inverse_mass_(inverse_of(body.mass)),
      load_(Eigen::VectorXd::Zero(body.size())),
      current_(load_),
      previous_(load_),
      predicted_(load_),
      contact_(load_),
      acceleration_(load_) {
  set_mass_damping(alpha);
  set_loads(loads);
  start();
}

double PublishedTwoStep::body_displacement(int row) const {
  return row_table_.col(row).dot(current_);
}

Propagator::Motion PublishedTwoStep::motion(const double* /*forces*/) const {
  return {current_, (current_ - previous_) / step_};
}

void PublishedTwoStep::predict_step(const double* forces, std::span<double> position,
                               std::span<double> increment) const {
  auto contact = as_vector(position);  // scratch at first
  contact.setZero();
  for (int port = 0; port < num_ports(); ++port)
    contact += forces[port] * row_table_.col(row(port));
  auto next = as_vector(increment);
  next.noalias() = inverse_mass_ * contact;
  next = predicted_ + (step_ * step_) * next - current_;
  as_vector(position) = current_;
}

double PublishedTwoStep::predicted_displacement(int row) const {
  return row_table_.col(row).dot(predicted_);
}

double PublishedTwoStep::row_compliance(int row_a, int row_b) const {
  return step_ * step_ * row_table_.col(row_a).dot(inverse_mass_ * row_table_.col(row_b));
}

void PublishedTwoStep::set_body_loads(std::span<const double> amplitudes) {
  if (!amplitudes.empty()) load_ = patterns_ * as_vector(amplitudes);
}

void PublishedTwoStep::set_mass_damping(double alpha) {
  damping_ = alpha * body_.mass + body_.damping.beta * body_.stiffness;
}

void PublishedTwoStep::advance_body(const double* forces, double* predicted) {
  contact_.setZero();
  for (int port = 0; port < num_ports(); ++port)
    contact_ += forces[port] * row_table_.col(row(port));
  // Before the first step the prediction is that of the state at rest: no correction to make.
  const Eigen::VectorXd corrected = predicted_ + (step_ * step_) * (inverse_mass_ * contact_);
  previous_.swap(current_);
  current_ = corrected;
  predict();
  for (int port = 0; port < num_ports(); ++port)
    predicted[port] = row_table_.col(row(port)).dot(predicted_);
}

void PublishedTwoStep::predict() {
  contact_.noalias() = load_ - body_.stiffness * current_;
  contact_.noalias() -= damping_ * ((current_ - previous_) / step_);
  acceleration_.noalias() = inverse_mass_ * contact_;
  predicted_ = (step_ * step_) * acceleration_ + 2.0 * current_ - previous_;
}

void PublishedTwoStep::set_body_motion(const Eigen::VectorXd& displacement,
                                       const Eigen::VectorXd& velocity, const double* /*forces*/) {
  current_ = displacement;
  previous_ = displacement - step_ * velocity;
  predict();
}

double PublishedTwoStep::initial_increment(int row, const Eigen::VectorXd& velocity) const {
  return step_ * row_table_.col(row).dot(velocity);
}

void PublishedTwoStep::save_body(State& state, const std::string& prefix) const {
  state.put(prefix + "u", as_span(current_));
  state.put(prefix + "u_previous", as_span(previous_));
  state.put(prefix + "u_predicted", as_span(predicted_));
}

void PublishedTwoStep::load_body(const State& state, const std::string& prefix) {
  state.get(prefix + "u", as_span(current_));
  state.get(prefix + "u_previous", as_span(previous_));
  state.get(prefix + "u_predicted", as_span(predicted_));
}

FusedTwoStep::FusedTwoStep(const ReducedBody& body, const Eigen::MatrixXd& patterns, double step,
                           int num_ports, double alpha, std::span<const double> loads)
    : Propagator(num_ports),
      row_table_(body.rows.transpose()),
      step_(step),
      alpha_(alpha),
      beta_(body.damping.beta),
      load_(Eigen::VectorXd::Zero(body.size())),
      current_(load_),
      increment_(load_),
      next_increment_(load_),
      blend_(load_) {
  const Eigen::MatrixXd inverse_mass = inverse_of(body.mass);
  mass_to_stiffness_ = inverse_mass * body.stiffness;
  port_gain_ = (step * step) * inverse_mass * row_table_;
  load_gain_ = (step * step) * inverse_mass * patterns;
  set_loads(loads);
  start();
}

double FusedTwoStep::body_displacement(int row) const {
  return row_table_.col(row).dot(current_);
}

Propagator::Motion FusedTwoStep::motion(const double* /*forces*/) const {
  return {current_, increment_ / step_};
}

void FusedTwoStep::predict_step(const double* forces, std::span<double> position,
                           std::span<double> increment) const {
  auto next = as_vector(increment);
  next = next_increment_;
  for (int port = 0; port < num_ports(); ++port) next += forces[port] * port_gain_.col(row(port));
  as_vector(position) = current_;
}

double FusedTwoStep::predicted_displacement(int row) const {
  return row_table_.col(row).dot(current_ + next_increment_);
}

double FusedTwoStep::row_compliance(int row_a, int row_b) const {
  return row_table_.col(row_a).dot(port_gain_.col(row_b));
}

void FusedTwoStep::set_body_loads(std::span<const double> amplitudes) {
  if (!amplitudes.empty()) load_ = load_gain_ * as_vector(amplitudes);
}

void FusedTwoStep::advance_body(const double* forces, double* predicted) {
  increment_ = next_increment_;
  for (int port = 0; port < num_ports(); ++port)
    increment_ += forces[port] * port_gain_.col(row(port));
  current_ += increment_;
  predict();
  for (int port = 0; port < num_ports(); ++port)
    predicted[port] = predicted_displacement(row(port));
}

void FusedTwoStep::predict() {
  blend_ = (step_ * step_) * current_ + (step_ * beta_) * increment_;
  next_increment_ = (1.0 - step_ * alpha_) * increment_ + load_;
  next_increment_.noalias() -= mass_to_stiffness_ * blend_;
}

void FusedTwoStep::set_body_motion(const Eigen::VectorXd& displacement,
                                   const Eigen::VectorXd& velocity, const double* /*forces*/) {
  current_ = displacement;
  increment_ = step_ * velocity;
  predict();
}

double FusedTwoStep::initial_increment(int row, const Eigen::VectorXd& velocity) const {
  return step_ * row_table_.col(row).dot(velocity);
}

void FusedTwoStep::save_body(State& state, const std::string& prefix) const {
  state.put(prefix + "u", as_span(current_));
  state.put(prefix + "next_increment", as_span(next_increment_));
}

void FusedTwoStep::load_body(const State& state, const std::string& prefix) {
  state.get(prefix + "u", as_span(current_));
  state.get(prefix + "next_increment", as_span(next_increment_));
}

}  // namespace stridor
