// Contact forces of one step where contacts have two tangents.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "solvers/contact/contact_solver.hpp"

namespace stridor {
namespace {

/// μ of a contact that slips by a distance, and its derivative by the distance.
struct SlipFriction {
  double coefficient;
  double slope;
};

SlipFriction friction_over(const PlanarProblem& contact, double distance) {
  if (contact.creep == nullptr) return {contact.sliding_friction, 0.0};
  const double speed = distance / contact.step;
  return {contact.friction_factor * sliding_friction(*contact.creep, speed),
          contact.friction_factor * sliding_friction_slope(*contact.creep, speed) / contact.step};
}

/// Forces for one η, and how far their friction is below its limit: χ = μ λ/|τ| − 1, nearly linear
/// in η, with its derivative.
struct SlipTrial {
  Eigen::Vector3d forces;
  double below;
  double slope;
};

SlipTrial try_slip(const PlanarProblem& contact, const Eigen::Matrix3d& delassus,
                   const Eigen::Vector3d& known, double eta) {
  Eigen::Matrix3d matrix = delassus;
  matrix(1, 1) += eta;
  matrix(2, 2) += eta;
  const Eigen::Matrix3d inverse = matrix.inverse();
  SlipTrial trial{inverse * known, 0.0, 0.0};
  const Eigen::Vector2d tau = trial.forces.tail<2>();
  const Eigen::Vector3d change = -inverse.rightCols<2>() * tau;
  const double size = tau.norm();
  const double size_change = tau.dot(change.tail<2>()) / size;
  const SlipFriction friction = friction_over(contact, eta * size);
  const double share = trial.forces(0) / size;
  trial.below = friction.coefficient * share - 1.0;
  trial.slope = friction.coefficient * (change(0) - share * size_change) / size +
                friction.slope * (size + eta * size_change) * share;
  return trial;
}

/// η of a contact that slips, by Newton's method in a bracket.
std::optional<Eigen::Vector3d> slip_forces(const PlanarProblem& contact,
                                           const Eigen::Matrix3d& delassus,
                                           const Eigen::Vector3d& known) {
  constexpr int max_iterations = 200;
  constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  const double scale = 0.5 * (delassus(1, 1) + delassus(2, 2));
  // Without the response of slip to forces η is |σ*|/(μ λ).
  const double distance = known.tail<2>().norm();
  const double limit =
      friction_over(contact, distance).coefficient * known(0) / delassus(0, 0);
  double eta = limit > 0.0 ? distance / limit : scale;
  SlipTrial trial = try_slip(contact, delassus, known, eta);
  for (int i = 0; i < max_iterations; ++i) {
    if (std::isnan(trial.below)) return std::nullopt;
    (trial.below > 0.0 ? high : low) = eta;
    double next = eta - trial.below / trial.slope;
    if (!(next > low && next < high))
      next = std::isinf(high) ? 2.0 * eta + scale : 0.5 * (low + high);
    if (std::abs(next - eta) <= rounding * eta || trial.below == 0.0) break;
    eta = next;
    trial = try_slip(contact, delassus, known, eta);
  }
  if (!(trial.forces(0) > 0.0)) return std::nullopt;
  // Friction exactly at its limit.
  const double size = trial.forces.tail<2>().norm();
  const double coefficient = friction_over(contact, eta * size).coefficient;
  trial.forces.tail<2>() *= coefficient * trial.forces(0) / size;
  return trial.forces;
}

/// Friction in a direction that is given; λ_n of either sign.
bool slide_on(PlanarProblem& contact, const Eigen::Matrix3d& delassus, double penetration) {
  const Eigen::Vector2d push = contact.sliding_friction * contact.direction;
  const double compliance = delassus(0, 0) + delassus.block<1, 2>(0, 1).dot(push.transpose());
  contact.normal = penetration / compliance;
  contact.tangential = contact.normal * push;
  contact.state = ContactState::slip;
  return compliance > 0.0;
}

}  // namespace

bool solve_planar(PlanarProblem& contact, const Eigen::Matrix3d& delassus,
                  const Eigen::Vector3d& known) {
  if (!contact.is_unilateral) return slide_on(contact, delassus, known(0));
  contact.normal = 0.0;
  contact.tangential.setZero();
  contact.state = ContactState::open;
  if (!(known(0) > 0.0)) return !known.hasNaN();
  contact.state = ContactState::slip;
  const bool is_frictionless =
      contact.creep == nullptr ? contact.sticking_friction == 0.0
                               : contact.friction_factor == 0.0 || contact.creep->is_frictionless();
  if (is_frictionless) {
    contact.normal = known(0) / delassus(0, 0);
    return delassus(0, 0) > 0.0;
  }
  if (contact.creep == nullptr) {
    const Eigen::Vector3d sticking = delassus.inverse() * known;
    if (sticking(0) > 0.0 &&
        sticking.tail<2>().norm() <= contact.sticking_friction * sticking(0)) {
      contact.normal = sticking(0);
      contact.tangential = sticking.tail<2>();
      contact.state = ContactState::stick;
      return true;
    }
    if (contact.sliding_friction == 0.0) {
      contact.normal = known(0) / delassus(0, 0);
      return delassus(0, 0) > 0.0;
    }
  } else if (known.tail<2>().isZero(0.0) && delassus.block<2, 1>(1, 0).isZero(0.0)) {
    contact.normal = known(0) / delassus(0, 0);
    return delassus(0, 0) > 0.0;
  }
  const std::optional<Eigen::Vector3d> forces = slip_forces(contact, delassus, known);
  if (!forces) return false;
  contact.normal = (*forces)(0);
  contact.tangential = forces->tail<2>();
  return true;
}

double ContactSolver::known(double without, Eigen::Index row, Eigen::Index first,
                            Eigen::Index width) const {
  double sum = without - delassus_.row(row).dot(all_forces_);
  for (Eigen::Index k = first; k < first + width; ++k) sum += delassus_(row, k) * all_forces_(k);
  return sum;
}

ContactAnswer ContactSolver::solve(std::span<LocalProblem> contacts,
                                   std::span<PlanarProblem> planar) {
  if (planar.empty()) return solve(contacts);
  const bool is_bilateral =
      std::none_of(contacts.begin(), contacts.end(),
                   [](const LocalProblem& c) { return c.is_unilateral || c.creep != nullptr; }) &&
      std::none_of(planar.begin(), planar.end(),
                   [](const PlanarProblem& c) { return c.is_unilateral; });
  return is_bilateral ? solve_bilateral(contacts, planar) : iterate(contacts, planar);
}

ContactAnswer ContactSolver::solve_bilateral(std::span<LocalProblem> contacts,
                                             std::span<PlanarProblem> planar) {
  const auto num_lines = static_cast<Eigen::Index>(contacts.size());
  const auto n = num_lines + static_cast<Eigen::Index>(planar.size());
  const auto row_of = [&](Eigen::Index i) {
    return i < num_lines ? 2 * i : first_planar(static_cast<int>(i - num_lines));
  };
  for (Eigen::Index j = 0; j < n; ++j) {
    const Eigen::Index column = row_of(j);
    for (Eigen::Index i = 0; i < n; ++i) {
      double& moved = sliding_(i, j) = delassus_(row_of(i), column);
      if (j < num_lines) {
        const LocalProblem& other = contacts[static_cast<std::size_t>(j)];
        moved += other.direction * other.sliding_friction * delassus_(row_of(i), column + 1);
      } else {
        const PlanarProblem& other = planar[static_cast<std::size_t>(j - num_lines)];
        moved += other.sliding_friction * delassus_.block<1, 2>(row_of(i), column + 1)
                                              .dot(other.direction.transpose());
      }
    }
    right_side_(j) = j < num_lines ? contacts[static_cast<std::size_t>(j)].penetration
                                   : planar[static_cast<std::size_t>(j - num_lines)].penetration;
  }
  if (const std::optional<int> jammed = jamming_(sliding_))
    return {ContactStatus::jammed, *jammed, 1};
  factor_.compute(sliding_);
  forces_ = factor_.solve(right_side_);
  for (Eigen::Index i = 0; i < num_lines; ++i) {
    LocalProblem& contact = contacts[static_cast<std::size_t>(i)];
    contact.normal = forces_(i);
    contact.tangential = contact.direction * contact.sliding_friction * contact.normal;
    contact.state = ContactState::slip;
  }
  for (Eigen::Index i = num_lines; i < n; ++i) {
    PlanarProblem& contact = planar[static_cast<std::size_t>(i - num_lines)];
    contact.normal = forces_(i);
    contact.tangential = contact.sliding_friction * contact.normal * contact.direction;
    contact.state = ContactState::slip;
  }
  return {};
}

ContactAnswer ContactSolver::iterate(std::span<LocalProblem> contacts,
                                     std::span<PlanarProblem> planar) {
  const auto num_lines = static_cast<int>(contacts.size());
  const auto num_planar = static_cast<int>(planar.size());
  for (int i = 0; i < num_lines; ++i) {
    const LocalProblem& contact = contacts[static_cast<std::size_t>(i)];
    all_forces_.segment<2>(2 * i) << contact.normal, contact.tangential;
  }
  for (int i = 0; i < num_planar; ++i) {
    const PlanarProblem& contact = planar[static_cast<std::size_t>(i)];
    all_forces_.segment<3>(first_planar(i)) << contact.normal, contact.tangential;
  }
  ContactAnswer answer{ContactStatus::not_converged, 0, 0};
  double largest_change = 0.0;
  double largest_force = 0.0;
  const auto take = [&](int contact, Eigen::Index row, const auto& forces) {
    auto held = all_forces_.segment(row, forces.size());
    const double change = (forces - held).cwiseAbs().maxCoeff();
    if (!(change <= largest_change)) {
      largest_change = change;
      answer.contact = contact;
    }
    held = forces;
    largest_force = std::max(largest_force, forces.cwiseAbs().maxCoeff());
  };
  while (answer.sweeps < parameters_.max_sweeps) {
    ++answer.sweeps;
    largest_change = largest_force = 0.0;
    for (int i = 0; i < num_lines; ++i) {
      LocalProblem& contact = contacts[static_cast<std::size_t>(i)];
      const Eigen::Index row = 2 * i;
      if (!solve_line(contact, delassus_.block<2, 2>(row, row),
                      known(contact.penetration, row, row, 2),
                      known(contact.slip, row + 1, row, 2)))
        return {ContactStatus::jammed, i, answer.sweeps};
      take(i, row, Eigen::Vector2d(contact.normal, contact.tangential));
    }
    for (int i = 0; i < num_planar; ++i) {
      PlanarProblem& contact = planar[static_cast<std::size_t>(i)];
      const Eigen::Index row = first_planar(i);
      const Eigen::Vector3d free(known(contact.penetration, row, row, 3),
                                 known(contact.slip.x(), row + 1, row, 3),
                                 known(contact.slip.y(), row + 2, row, 3));
      if (!solve_planar(contact, delassus_.block<3, 3>(row, row), free))
        return {ContactStatus::jammed, num_lines + i, answer.sweeps};
      take(num_lines + i, row,
           Eigen::Vector3d(contact.normal, contact.tangential.x(), contact.tangential.y()));
    }
    if (largest_change <= parameters_.tolerance * largest_force) {
      answer.status = ContactStatus::converged;
      break;
    }
  }
  return answer;
}

}  // namespace stridor
