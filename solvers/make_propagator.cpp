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

}  // namespace

std::unique_ptr<Propagator> make_propagator(const SystemBody& body, const TimeParameters& time,
                                            int num_slots, std::span<const double> loads) {
  const double alpha = body.modal.damping.alpha_at(0.0);
  const Eigen::MatrixXd reduced_patterns =
      load_patterns(body, body.reduced.rows, body.reduced.base_inertia);
  switch (time.coordinates) {
    case Coordinates::craig_bampton:
      return std::make_unique<PublishedTwoStep>(body.reduced, reduced_patterns, time.step,
                                                num_slots, alpha, loads);
    case Coordinates::craig_bampton_fused:
      return std::make_unique<FusedTwoStep>(body.reduced, reduced_patterns, time.step, num_slots,
                                            alpha, loads);
    case Coordinates::modal:
      break;
  }
  return std::make_unique<ModalRecurrence>(
      body.modal, load_patterns(body, body.modal.rows, body.modal.base_inertia), time.step,
      num_slots, alpha, loads);
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
