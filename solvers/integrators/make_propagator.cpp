#include "solvers/integrators/make_propagator.hpp"

#include <algorithm>
#include <limits>

#include "solvers/integrators/coupled_propagator.hpp"
#include "solvers/integrators/dense_two_step.hpp"
#include "solvers/integrators/modal_recurrence.hpp"
#include "solvers/integrators/retained_modes.hpp"

namespace stridor {
namespace {

/// Load patterns of a body in given coordinates: its loads, the inertia of the motion of its drive, and
/// the load that it holds. None of a body without any.
/// @param held in these coordinates; empty where there is none
Eigen::MatrixXd load_patterns(const SystemBody& body, const Eigen::MatrixXd& rows,
                              const Eigen::VectorXd& base_inertia, const Eigen::VectorXd& held) {
  if (!BodyLoading(body).is_any()) return Eigen::MatrixXd(rows.cols(), 0);
  const auto num_loads = static_cast<Eigen::Index>(body.loads.size());
  Eigen::MatrixXd patterns = Eigen::MatrixXd::Zero(rows.cols(), num_loads + 2);
  for (Eigen::Index k = 0; k < num_loads; ++k)
    patterns.col(k) = rows.row(body.loads[static_cast<std::size_t>(k)].row).transpose();
  if (body.follows_drive()) patterns.col(num_loads) = -base_inertia;
  if (held.size() > 0) patterns.col(num_loads + 1) = held;
  return patterns;
}

Eigen::VectorXd held_on_modes(const SystemBody& body) {
  // BLAS takes no empty matrix.
  if (body.held_load.size() == 0) return {};
  return body.modal.shapes.transpose() * body.held_load;
}

/// What the load that a body holds does through its truncated modes, in reduced coordinates: all of the
/// static response less that of the modes that are kept.
Eigen::VectorXd held_residual(const SystemBody& body) {
  if (body.held_load.size() == 0) return {};
  const ModalBody all = make_modal(body.reduced);
  const Eigen::Index kept = body.modal.size();
  const Eigen::MatrixXd truncated = all.shapes.rightCols(all.size() - kept);
  return truncated * all.omega.tail(all.size() - kept)
                         .array()
                         .square()
                         .inverse()
                         .matrix()
                         .cwiseProduct(truncated.transpose() * body.held_load);
}

Propagator::Residual residual_of(const SystemBody& body, double step) {
  const ModalResidual& modes = body.modal.residual;
  if (modes.num_modes == 0) return {};
  const Eigen::VectorXd held = held_residual(body);
  // Of rows per load: the same seen by the rows of the body.
  const Eigen::VectorXd held_rows =
      held.size() > 0 ? Eigen::VectorXd(body.reduced.rows * held) : held;
  return {modes, load_patterns(body, modes.flexibility, modes.base_rows, held_rows),
          load_patterns(body, modes.shapes.transpose(), modes.base_shapes, held), step};
}

bool is_at_rest(const SystemBody& body) {
  return body.initial_displacement.size() == 0 && body.initial_velocity.size() == 0;
}

/// In the coordinates that the body is marched in.
struct StartingMotion {
  Eigen::VectorXd displacement;
  Eigen::VectorXd velocity;
};

StartingMotion starting_motion(const SystemBody& body, const TimeParameters& time) {
  const auto or_zero = [&](const Eigen::VectorXd& given) -> Eigen::VectorXd {
    return given.size() == 0 ? Eigen::VectorXd(Eigen::VectorXd::Zero(body.reduced.size())) : given;
  };
  StartingMotion motion{or_zero(body.initial_displacement), or_zero(body.initial_velocity)};
  if (time.coordinates != Coordinates::modal) return motion;
  // BLAS takes no empty matrix.
  if (body.modal.size() == 0) return {};
  // ΦᵀMΦ = I, so ΦᵀM takes reduced coordinates to modal ones.
  const Eigen::MatrixXd to_modal = body.modal.shapes.transpose() * body.reduced.mass;
  return {to_modal * motion.displacement, to_modal * motion.velocity};
}

}  // namespace

BodyLoading::BodyLoading(const SystemBody& body) : loads_(body.loads), drive_(body.drive) {
  if (body.feels_drive() || body.held_load.size() > 0) amplitudes_.assign(loads_.size() + 2, 0.0);
}

std::span<const double> BodyLoading::amplitudes(const std::vector<Drive>& drives, double time) {
  if (!is_any()) return {};
  for (std::size_t k = 0; k < loads_.size(); ++k) amplitudes_[k] = loads_[k].size(drives, time);
  amplitudes_[loads_.size()] =
      drive_ < 0 ? 0.0 : drives[static_cast<std::size_t>(drive_)].acceleration(time);
  amplitudes_[loads_.size() + 1] = 1.0;
  return amplitudes_;
}

std::unique_ptr<Propagator> make_propagator(const SystemBody& body, const TimeParameters& time,
                                            std::optional<double> added, int num_ports,
                                            std::span<const double> loads) {
  const double alpha = body.modal.damping.alpha_at(0.0);
  const auto on_modes = [&] {
    return load_patterns(body, body.modal.rows, body.modal.base_inertia, held_on_modes(body));
  };
  const auto on_reduced = [&] {
    return load_patterns(body, body.reduced.rows, body.reduced.base_inertia, body.held_load);
  };
  std::unique_ptr<Propagator> propagator;
  if (!body.modal.coupled.is_empty()) {
    require_exact(body.name, time);
    return std::make_unique<CoupledPropagator>(
        body.modal, on_modes(), time.step, added,
        num_ports, alpha, loads, body.name);
  }
  // A body without degrees of freedom is the same in all coordinates, but BLAS takes no empty
  // matrix.
  switch (body.reduced.size() == 0 ? Coordinates::modal : time.coordinates) {
    case Coordinates::modal:
      propagator = std::make_unique<ModalRecurrence>(
          body.modal, on_modes(), time.integrator,
          time.step, added, num_ports, alpha, loads, residual_of(body, time.step));
      break;
    case Coordinates::craig_bampton:
      propagator = std::make_unique<PublishedTwoStep>(
          body.reduced, on_reduced(), time.step,
          num_ports, alpha, loads);
      break;
    case Coordinates::craig_bampton_fused:
      propagator = std::make_unique<FusedTwoStep>(
          body.reduced, on_reduced(), time.step,
          num_ports, alpha, loads);
      break;
  }
  return propagator;
}

bool starts_at_rest(const System& system) {
  return std::all_of(system.bodies.begin(), system.bodies.end(), is_at_rest);
}

void predict_start(Propagator& propagator, const SystemBody& body, const TimeParameters& time) {
  const StartingMotion motion = starting_motion(body, time);
  propagator.predict_start(motion.displacement, motion.velocity);
}

void start_motion(Propagator& propagator, const SystemBody& body, const TimeParameters& time,
                  const double* forces) {
  const bool has_forces = std::any_of(forces, forces + propagator.num_ports(),
                                      [](double force) { return force != 0.0; });
  if (is_at_rest(body) && !has_forces && !propagator.is_starting()) return;
  const StartingMotion motion = starting_motion(body, time);
  propagator.set_motion(motion.displacement, motion.velocity, forces);
}

StepLimit step_limit(const System& system) {
  StepLimit limit{std::numeric_limits<double>::infinity(), ""};
  for (const SystemBody& body : system.bodies) {
    const double step = central_difference_limit(body.modal);
    if (step < limit.step) limit = {step, body.name};
  }
  return limit;
}

StepLimit step_limit(const System& system, const TimeParameters& time) {
  if (time.integrator == Integrator::exact) return {std::numeric_limits<double>::infinity(), ""};
  StepLimit limit = step_limit(retained(system, time));
  if (time.retain) limit.step *= 0.9;
  return limit;
}

}  // namespace stridor
