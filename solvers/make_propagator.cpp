#include "solvers/make_propagator.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "solvers/dense_two_step.hpp"
#include "solvers/modal_recurrence.hpp"
#include "solvers/two_step_scheme.hpp"

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
  if (time.coordinates == Coordinates::modal) {
    // ΦᵀMΦ = I, so ΦᵀM takes reduced coordinates to modal ones.
    const Eigen::MatrixXd to_modal = body.modal.shapes.transpose() * body.reduced.mass;
    motion.displacement = (to_modal * motion.displacement).eval();
    motion.velocity = (to_modal * motion.velocity).eval();
  }
  return motion;
}

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

PointAnswer answer_of(const ModalBody& body, const PointRows& rows, const TimeParameters& time) {
  PointAnswer sum;
  for (Eigen::Index i = 0; i < body.size(); ++i) {
    const double omega = body.omega(i);
    const double damping = body.damping.alpha + body.damping.beta * omega * omega;
    const StepCoefficients c = step_coefficients(time.integrator, omega, damping, time.step, 0.0);
    const Eigen::Vector2d entry(body.rows(rows.x, i), body.rows(rows.y, i));
    const Eigen::Matrix2d square = entry * entry.transpose();
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
    const double share = time.step / (time.step + body.residual.beta);
    const Eigen::Index at[] = {rows.x, rows.y};
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) sum.prompt(a, b) += share * residual(at[a], at[b]);
    }
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

}  // namespace

double retained_frequency(const TimeParameters& time) {
  const double asked =
      time.retain ? time.retain->cutoff() : std::numeric_limits<double>::infinity();
  // Beyond a step of 2 rad a mode nears the one at which it would seem to stand still or to run
  // backwards.
  constexpr double resolved = 2.0;
  return time.integrator == Integrator::exact ? std::min(asked, resolved / time.step) : asked;
}

System retained(const System& system, const TimeParameters& time) {
  System kept = system;
  const double cutoff = retained_frequency(time);
  for (SystemBody& body : kept.bodies) {
    if (body.modal.size() > 0 && body.modal.omega.maxCoeff() > cutoff)
      body.modal = with_static_residual(body.modal, cutoff);
  }
  return kept;
}

Eigen::Index num_retained(const ModalBody& body, const TimeParameters& time) {
  return (body.omega.array() <= retained_frequency(time)).count();
}

std::unique_ptr<Propagator> make_propagator(const SystemBody& body, const TimeParameters& time,
                                            std::optional<double> surplus, int num_slots,
                                            std::span<const double> loads) {
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
          time.step, surplus, num_slots, alpha, loads, residual_of(body, time.step));
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

bool starts_at_rest(const System& system) {
  return std::all_of(system.bodies.begin(), system.bodies.end(), is_at_rest);
}

void foresee_start(Propagator& propagator, const SystemBody& body, const TimeParameters& time) {
  const StartingMotion motion = starting_motion(body, time);
  propagator.foresee_start(motion.displacement, motion.velocity);
}

void start_motion(Propagator& propagator, const SystemBody& body, const TimeParameters& time,
                  const double* forces) {
  const bool has_forces = std::any_of(forces, forces + propagator.num_slots(),
                                      [](double force) { return force != 0.0; });
  if (is_at_rest(body) && !has_forces) return;
  const StartingMotion motion = starting_motion(body, time);
  propagator.set_motion(motion.displacement, motion.velocity, forces);
}

std::optional<double> prompt_surplus(const System& system, const TimeParameters& time) {
  if (time.integrator == Integrator::central_difference && !time.retain) return std::nullopt;
  // A force law acts by where the body is at the beginning of a step.
  if (std::any_of(system.contacts.begin(), system.contacts.end(),
                  [](const ContactPoint& contact) { return contact.substrate.has_value(); })) {
    return std::nullopt;
  }
  // Stable are ratios up to 4. Friction, damping and what changes along the path want some room,
  // and contacts that open more: near the limit the force changes its sign from step to step.
  const bool may_open =
      std::any_of(system.contacts.begin(), system.contacts.end(), [](const ContactPoint& contact) {
        return contact.unilateral_from() < std::numeric_limits<double>::infinity();
      });
  const double limit = may_open ? 2.0 : 3.6;
  // With it every mode by itself has limit · g ≥ e.
  const double enough = 1.0 / limit - 1.0 / 12.0;
  if (system.contacts.size() != 1) return system.contacts.empty() ? 0.0 : enough;
  const ContactPoint& contact = system.contacts.front();
  const MasterSurface& surface = system.surface_of(contact);
  const auto body = [&](int index) -> const ModalBody& {
    return system.bodies[static_cast<std::size_t>(index)].modal;
  };
  const PointAnswer slave = answer_of(body(contact.slave_body), contact.slave_rows, time);
  double surplus = 0.0;
  for (const PointRows& node : surface.rows) {
    PointAnswer both = slave;
    both += answer_of(body(surface.body), node, time);
    surplus = std::max(surplus, least_surplus(both, limit));
  }
  return std::min(surplus, enough);
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
