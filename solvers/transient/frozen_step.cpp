#include "solvers/transient/frozen_step.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/integrators/coupled_propagator.hpp"
#include "solvers/integrators/coupled_step.hpp"
#include "solvers/integrators/modal_recurrence.hpp"
#include "solvers/integrators/added_feedthrough.hpp"
#include "solvers/integrators/retained_modes.hpp"
#include "solvers/integrators/step_factors.hpp"

namespace stridor {
namespace {

/// The modes that move, from (r, d) at t_n to t_{n+1}; coupled ones have velocities in the place of
/// increments.
struct MovingModes {
  Eigen::MatrixXd free;      ///< without forces, 2n x 2n
  Eigen::MatrixXd by_force;  ///< per modal force, 2n x n
  Eigen::MatrixXd gaps;      ///< C
  Eigen::MatrixXd forces;    ///< E
  Eigen::MatrixXd closed;  ///< what a unit of λ closes of the gaps at once: C g Eᵀ, or C e Eᵀ
  Eigen::MatrixXd closed_next;  ///< and in the next step, C e Eᵀ

  Eigen::Index size() const { return gaps.cols(); }
};

MovingModes moving_modes(const Pencil& contacts, const System& system, const TimeParameters& time,
                         std::optional<double> added, double cutoff,
                         const std::vector<CoupledStep>& coupled_steps) {
  std::vector<Eigen::Index> moving;
  std::vector<Eigen::Index> coupled;  // first moving mode of every coupled body
  Eigen::Index first = 0;
  for (const SystemBody& body : system.bodies) {
    const bool is_coupled = !body.modal.coupled.is_empty();
    if (is_coupled) coupled.push_back(static_cast<Eigen::Index>(moving.size()));
    for (Eigen::Index i = first; i < first + body.modal.size(); ++i)
      if (is_coupled || contacts.omega(i) <= cutoff) moving.push_back(i);
    first += body.modal.size();
  }
  const auto n = static_cast<Eigen::Index>(moving.size());
  MovingModes modes{
      Eigen::MatrixXd::Zero(2 * n, 2 * n), Eigen::MatrixXd::Zero(2 * n, n), {}, {}, {}, {}};
  const Eigen::MatrixXd ports = contacts.ports(Eigen::all, moving);
  modes.gaps = contacts.compatibility * ports;
  modes.forces = contacts.equilibrium * ports;
  Eigen::MatrixXd feedthrough = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index mode = moving[static_cast<std::size_t>(i)];
    const StepCoefficients c =
        step_coefficients(time.integrator, contacts.omega(mode), contacts.damping(mode), time.step,
                          added.value_or(0.0));
    modes.free(i, i) = 1.0 - c.pull;
    modes.free(i, n + i) = modes.free(n + i, n + i) = c.keep;
    modes.free(n + i, i) = -c.pull;
    modes.by_force(i, i) = modes.by_force(n + i, i) = c.gain;
    feedthrough(i, i) = c.feedthrough;
  }
  for (std::size_t b = 0; b < coupled.size(); ++b) {
    const CoupledStep& step = coupled_steps[b];
    const Eigen::Index at = coupled[b];
    const Eigen::Index m = step.position.rows();
    for (const Eigen::Index to : {Eigen::Index{0}, Eigen::Index{1}}) {
      modes.by_force.block(to * n + at, at, m, m) = step.by_force.middleRows(to * m, m);
      for (const Eigen::Index from : {Eigen::Index{0}, Eigen::Index{1}}) {
        modes.free.block(to * n + at, from * n + at, m, m) =
            step.free.block(to * m, from * m, m, m);
      }
    }
    feedthrough.block(at, at, m, m) = step.feedthrough;
  }
  modes.closed_next = modes.gaps * modes.by_force.topRows(n) * modes.forces.transpose();
  modes.closed = added ? Eigen::MatrixXd(modes.gaps * feedthrough * modes.forces.transpose())
                       : modes.closed_next;
  return modes;
}

/// The same of modes that no terms couple.
FrozenModes frozen_modes(const Pencil& contacts, const TimeParameters& time,
                         std::optional<double> added, double cutoff) {
  std::vector<Eigen::Index> moving;
  for (Eigen::Index i = 0; i < contacts.num_modes(); ++i)
    if (contacts.omega(i) <= cutoff) moving.push_back(i);
  const auto n = static_cast<Eigen::Index>(moving.size());
  FrozenModes modes;
  for (Eigen::VectorXd* values : {&modes.keep, &modes.pull, &modes.gain, &modes.feedthrough})
    values->resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index mode = moving[static_cast<std::size_t>(i)];
    const StepCoefficients c =
        step_coefficients(time.integrator, contacts.omega(mode), contacts.damping(mode), time.step,
                          added.value_or(0.0));
    modes.keep(i) = c.keep;
    modes.pull(i) = c.pull;
    modes.gain(i) = c.gain;
    modes.feedthrough(i) = c.feedthrough;
  }
  const Eigen::MatrixXd ports = contacts.ports(Eigen::all, moving);
  modes.gaps = contacts.compatibility * ports;
  modes.forces = contacts.equilibrium * ports;
  modes.is_instantaneous = added.has_value();
  modes.compliance = contacts.compliance;
  return modes;
}

/// Whether a dense decomposition takes less than the search for zeros: of few modes, and of
/// hundreds of contacts by so much that the relative accuracy of slow motions is given up for it.
bool is_decomposition_cheaper(const FrozenModes& modes) {
  constexpr Eigen::Index few_modes = 12;
  constexpr double worth = 10.0;
  const auto n = static_cast<double>(modes.gaps.cols());
  const auto k = static_cast<double>(modes.gaps.rows());
  const double size = 2.0 * n + k * static_cast<double>(modes.left_out.size());
  const double by_search = 10.0 * size * (n * k * k + 10.0 * k * k * k);
  const double by_decomposition = 25.0 * size * size * size;
  return modes.gaps.cols() <= few_modes || by_search > worth * by_decomposition;
}

/// @throws NumericalError where a contact jams
void check_closed(const Eigen::MatrixXd& closed) {
  for (Eigen::Index i = 0; i < closed.rows(); ++i) {
    if (!(closed(i, i) > 0.0))
      throw NumericalError(Refusal::contact_jams,
                           fmt::format("no force of contact {} closes its gap: it jams", i));
  }
}

/// What the forces on the contacts do through the modes that bodies leave out.
using LeftOut = FrozenModes::LeftOut;

std::vector<LeftOut> left_out_modes(const Pencil& contacts, const System& system, double step,
                                    double cutoff) {
  std::vector<LeftOut> found;
  Eigen::Index first = 0;
  for (const SystemBody& body : system.bodies) {
    const Eigen::Index size = body.modal.size();
    Eigen::VectorXd flexibility = Eigen::VectorXd::Zero(size);
    const Eigen::Index num_droppable = body.modal.coupled.is_empty() ? size : 0;
    for (Eigen::Index i = 0; i < num_droppable; ++i) {
      const double omega = contacts.omega(first + i);
      if (omega > cutoff) flexibility(i) = 1.0 / (omega * omega);
    }
    if (!flexibility.isZero(0.0)) {
      const auto ports = contacts.ports.middleCols(first, size);
      found.push_back({contacts.compatibility * ports * flexibility.asDiagonal() *
                           ports.transpose() * contacts.equilibrium.transpose(),
                       step / (step + body.modal.damping.beta)});
    }
    first += size;
  }
  return found;
}

/// Constraints sought at t_{n+1}: the tangents of contacts that stick, where springs hold the gaps.
std::vector<Eigen::Index> rows_ahead(const Pencil& contacts, const System& system,
                                     const TimeParameters& time) {
  std::vector<Eigen::Index> rows;
  if (!has_springs_on_faces(system, time)) return rows;
  for (Eigen::Index row = 0; row < contacts.compliance.size(); ++row)
    if (contacts.compliance(row) == 0.0) rows.push_back(row);
  return rows;
}

std::optional<double> added_of(const System& system, const TimeParameters& time) {
  // A copy of all bodies is worth avoiding.
  if (time.integrator == Integrator::central_difference && !time.retain) return std::nullopt;
  return added_feedthrough(retained(system, time), time);
}

}  // namespace

FrozenStep::FrozenStep(const System& system, const TimeParameters& time)
    : FrozenStep(system, time, added_of(system, time)) {}

FrozenStep::FrozenStep(const System& system, const TimeParameters& time,
                       std::optional<double> added)
    : system_(&system), time_(time), added_(added), cutoff_(retained_frequency(system, time)) {
  for (const SystemBody& body : system.bodies) {
    if (body.modal.coupled.is_empty()) continue;
    require_exact(body.name, time);
    coupled_.push_back(
        make_coupled_step(body.modal, time.step, added, body.modal.damping.alpha, body.name));
  }
}

std::vector<std::complex<double>> FrozenStep::factors(const Pencil& contacts) const {
  check_pencil(contacts);
  if (contacts.num_modes() != make_modal_pencil(*system_).num_modes())
    throw std::invalid_argument("FrozenStep: the contacts are on other modes than the system has");
  const std::vector<LeftOut> left_out = left_out_modes(contacts, *system_, time_.step, cutoff_);
  const std::vector<Eigen::Index> ahead = rows_ahead(contacts, *system_, time_);
  if (coupled_.empty() && ahead.empty()) {
    FrozenModes uncoupled = frozen_modes(contacts, time_, added_, cutoff_);
    uncoupled.left_out = left_out;
    if (!is_decomposition_cheaper(uncoupled)) {
      check_closed(uncoupled.closed());
      if (auto found = step_factors(uncoupled)) return std::move(*found);
    }
  }
  const MovingModes modes = moving_modes(contacts, *system_, time_, added_, cutoff_, coupled_);
  Eigen::MatrixXd closed = modes.closed;
  for (const LeftOut& body : left_out) closed += body.share * body.closed;
  for (const Eigen::Index row : ahead) {
    closed.row(row) = modes.closed.row(row) + modes.closed_next.row(row);
    for (const LeftOut& body : left_out) closed.row(row) += body.closed.row(row);
  }
  if (contacts.compliance.size() > 0) closed.diagonal() += contacts.compliance;
  check_closed(closed);
  const Eigen::PartialPivLU<Eigen::MatrixXd> close(closed);

  // State: r, d, and λ~ of every body that leaves out modes. λ_n = by_position r + by_increment d +
  // Σ by_lag λ~.
  const Eigen::Index n = modes.size();
  const Eigen::Index k = closed.rows();
  const Eigen::Index size = 2 * n + k * static_cast<Eigen::Index>(left_out.size());
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(k, size);
  if (added_) {
    force.leftCols(n) = modes.gaps;
    for (std::size_t b = 0; b < left_out.size(); ++b) {
      force.middleCols(2 * n + k * static_cast<Eigen::Index>(b), k) =
          -(1.0 - left_out[b].share) * left_out[b].closed;
    }
    for (const Eigen::Index row : ahead) {
      force.row(row).setZero();
      force.row(row).head(2 * n) = modes.gaps.row(row) * modes.free.topRows(n);
    }
  } else {
    force.leftCols(2 * n) = modes.gaps * modes.free.topRows(n);
  }
  if (k > 0) force = close.solve(force).eval();

  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(size, size);
  map.topRows(2 * n) = -((modes.by_force * modes.forces.transpose()) * force);
  map.topLeftCorner(2 * n, 2 * n) += modes.free;
  for (std::size_t b = 0; b < left_out.size(); ++b) {
    const Eigen::Index first = 2 * n + k * static_cast<Eigen::Index>(b);
    map.middleRows(first, k) = left_out[b].share * force;
    map.block(first, first, k, k).diagonal().array() += 1.0 - left_out[b].share;
  }
  return matrix_eigenvalues(std::move(map));
}

double spectral_radius(const std::vector<std::complex<double>>& factors) {
  double largest = 0.0;
  for (const std::complex<double>& factor : factors) largest = std::max(largest, std::abs(factor));
  return largest;
}

}  // namespace stridor
