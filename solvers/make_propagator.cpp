#include "solvers/make_propagator.hpp"

#include <limits>

#include "solvers/dense_two_step.hpp"
#include "solvers/modal_recurrence.hpp"

namespace stridor {
namespace {

/// Load patterns of a body in given coordinates: the drive's load, and the inertia of its motion.
Eigen::MatrixXd load_patterns(const SystemBody& body, const Eigen::MatrixXd& rows,
                              const Eigen::VectorXd& base_inertia) {
  if (!body.follows_drive) return Eigen::MatrixXd(rows.cols(), 0);
  Eigen::MatrixXd patterns(rows.cols(), 2);
  patterns.col(0) = rows.row(body.load_row).transpose();
  patterns.col(1) = -base_inertia;
  return patterns;
}

Propagator::Residual residual_of(const SystemBody& body, double step) {
  const ModalResidual& modes = body.modal.residual;
  if (modes.num_modes == 0) return {};
  return {modes, load_patterns(body, modes.flexibility, modes.base_rows),
          load_patterns(body, modes.shapes.transpose(), modes.base_shapes), step};
}

}  // namespace

System retained(const System& system, const TimeParameters& time) {
  System kept = system;
  if (!time.retain) return kept;
  for (SystemBody& body : kept.bodies)
    body.modal = with_static_residual(body.modal, time.retain->cutoff());
  return kept;
}

Eigen::Index num_retained(const ModalBody& body, const TimeParameters& time) {
  if (!time.retain) return body.size();
  return (body.omega.array() <= time.retain->cutoff()).count();
}

std::unique_ptr<Propagator> make_propagator(const SystemBody& body, const TimeParameters& time,
                                            int num_slots, std::span<const double> loads) {
  const double alpha = body.modal.damping.alpha_at(0.0);
  const auto patterns = [&](const Eigen::MatrixXd& rows, const Eigen::VectorXd& base_inertia) {
    return load_patterns(body, rows, base_inertia);
  };
  std::unique_ptr<Propagator> propagator;
  // A body without degrees of freedom is the same in all coordinates, but BLAS takes no empty
  // matrix.
  switch (body.reduced.size() == 0 ? Coordinates::modal : time.coordinates) {
    case Coordinates::modal:
      propagator = std::make_unique<ModalRecurrence>(
          body.modal, patterns(body.modal.rows, body.modal.base_inertia), time.integrator,
          time.step, num_slots, alpha, loads, residual_of(body, time.step));
      break;
    case Coordinates::craig_bampton:
      propagator = std::make_unique<PublishedTwoStep>(
          body.reduced, patterns(body.reduced.rows, body.reduced.base_inertia), time.step,
          num_slots, alpha, loads);
      break;
    case Coordinates::craig_bampton_fused:
      propagator = std::make_unique<FusedTwoStep>(
          body.reduced, patterns(body.reduced.rows, body.reduced.base_inertia), time.step,
          num_slots, alpha, loads);
      break;
  }
  return propagator;
}

void start_motion(Propagator& propagator, const SystemBody& body, const TimeParameters& time,
                  const double* forces) {
  const auto n = body.reduced.size();
  const bool starts_at_rest =
      body.initial_displacement.size() == 0 && body.initial_velocity.size() == 0;
  if (starts_at_rest) return;
  const auto or_zero = [&](const Eigen::VectorXd& given) -> Eigen::VectorXd {
    return given.size() == 0 ? Eigen::VectorXd(Eigen::VectorXd::Zero(n)) : given;
  };
  Eigen::VectorXd displacement = or_zero(body.initial_displacement);
  Eigen::VectorXd velocity = or_zero(body.initial_velocity);
  if (time.coordinates == Coordinates::modal) {
    // ΦᵀMΦ = I, so ΦᵀM takes reduced coordinates to modal ones.
    const Eigen::MatrixXd to_modal = body.modal.shapes.transpose() * body.reduced.mass;
    displacement = (to_modal * displacement).eval();
    velocity = (to_modal * velocity).eval();
  }
  propagator.set_motion(displacement, velocity, forces);
}

StepLimit step_limit(const System& system) {
  StepLimit limit{std::numeric_limits<double>::infinity(), ""};
  for (const SystemBody& body : system.bodies) {
    const double step = central_difference_limit(body.modal);
    if (step < limit.step) limit = {step, body.name};
  }
  return limit;
}

}  // namespace stridor
