#include "solvers/contact_solver.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "solvers/substrate_step.hpp"

namespace stridor {
namespace {

/// The 2 x 2 block of one contact: penetration and slip per unit of its own forces.
struct LocalCompliance {
  double nn, nt, tn, tt;
};

/// The same where the contact is a force law; λ_t is positive against the slip.
bool solve_substrate(LocalProblem& contact, const LocalCompliance& w, double slip) {
  const SlipAnswer answer{slip / contact.step, w.tt / contact.step, -w.tn / contact.step};
  const SubstrateStep step =
      solve_substrate_step(*contact.substrate, contact.indentation, contact.last_slip, answer, 0.0);
  contact.normal = step.normal;
  contact.tangential = -step.tangential;
  contact.state = step.state;
  contact.stiffness = step.stiffness;
  return !std::isnan(contact.indentation) && !std::isnan(slip);
}

/// The solution of one contact under the forces of all others.
/// @returns false where no force closes the gap
bool solve_local(LocalProblem& contact, const LocalCompliance& w, double penetration, double slip) {
  const auto slide = [&](double direction) {
    const double compliance = w.nn + direction * contact.sliding_friction * w.nt;
    contact.normal = penetration / compliance;
    contact.tangential = direction * contact.sliding_friction * contact.normal;
    contact.state = ContactState::slip;
    return compliance > 0.0;
  };
  if (contact.substrate != nullptr) return solve_substrate(contact, w, slip);
  if (!contact.is_unilateral) return slide(contact.direction);

  // Without penetration no force is a solution, and the one that is taken even where friction makes
  // others possible, in which contacts that part would press each other.
  contact.normal = 0.0;
  contact.tangential = 0.0;
  contact.state = ContactState::open;
  if (!(penetration > 0.0)) return !std::isnan(penetration);

  const double determinant = w.nn * w.tt - w.nt * w.tn;
  const double normal = (penetration * w.tt - slip * w.nt) / determinant;
  const double tangential = (slip * w.nn - penetration * w.tn) / determinant;
  if (normal > 0.0 && std::abs(tangential) <= contact.sticking_friction * normal) {
    contact.normal = normal;
    contact.tangential = tangential;
    contact.state = ContactState::stick;
    return true;
  }
  return slide(tangential < 0.0 ? -1.0 : 1.0);
}

}  // namespace

ContactSolver::ContactSolver(int num_contacts, ContactSolverParameters parameters)
    : parameters_(parameters),
      delassus_(Eigen::MatrixXd::Zero(2 * num_contacts, 2 * num_contacts)),
      sliding_(Eigen::MatrixXd::Zero(num_contacts, num_contacts)),
      right_side_(Eigen::VectorXd::Zero(num_contacts)),
      forces_(Eigen::VectorXd::Zero(num_contacts)),
      factor_(num_contacts),
      jamming_(num_contacts) {}

ContactAnswer ContactSolver::solve(std::span<LocalProblem> contacts) {
  if (contacts.size() == 1) {
    const LocalCompliance w{delassus_(0, 0), delassus_(0, 1), delassus_(1, 0), delassus_(1, 1)};
    LocalProblem& contact = contacts[0];
    const bool is_solved = solve_local(contact, w, contact.penetration, contact.slip);
    return {is_solved ? ContactStatus::converged : ContactStatus::jammed, 0, 1};
  }
  const bool is_bilateral = std::none_of(contacts.begin(), contacts.end(),
                                         [](const LocalProblem& c) { return c.is_unilateral; });
  return is_bilateral ? solve_bilateral(contacts) : iterate(contacts);
}

ContactAnswer ContactSolver::solve_bilateral(std::span<LocalProblem> contacts) {
  const auto n = static_cast<Eigen::Index>(contacts.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const LocalProblem& other = contacts[static_cast<std::size_t>(j)];
      sliding_(i, j) = delassus_(2 * i, 2 * j) +
                       other.direction * other.sliding_friction * delassus_(2 * i, 2 * j + 1);
    }
    right_side_(i) = contacts[static_cast<std::size_t>(i)].penetration;
  }
  if (const std::optional<int> jammed = jamming_(sliding_))
    return {ContactStatus::jammed, *jammed, 1};
  factor_.compute(sliding_);
  forces_ = factor_.solve(right_side_);
  for (Eigen::Index i = 0; i < n; ++i) {
    LocalProblem& contact = contacts[static_cast<std::size_t>(i)];
    contact.normal = forces_(i);
    contact.tangential = contact.direction * contact.sliding_friction * contact.normal;
    contact.state = ContactState::slip;
  }
  return {};
}

ContactAnswer ContactSolver::iterate(std::span<LocalProblem> contacts) {
  const auto n = static_cast<Eigen::Index>(contacts.size());
  ContactAnswer answer{ContactStatus::not_converged, 0, 0};
  while (answer.sweeps < parameters_.max_sweeps) {
    ++answer.sweeps;
    double largest_change = 0.0;
    double largest_force = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      LocalProblem& contact = contacts[static_cast<std::size_t>(i)];
      double penetration = contact.penetration;
      double slip = contact.slip;
      for (Eigen::Index j = 0; j < n; ++j) {
        if (j == i) continue;
        const LocalProblem& other = contacts[static_cast<std::size_t>(j)];
        penetration -=
            delassus_(2 * i, 2 * j) * other.normal + delassus_(2 * i, 2 * j + 1) * other.tangential;
        slip -= delassus_(2 * i + 1, 2 * j) * other.normal +
                delassus_(2 * i + 1, 2 * j + 1) * other.tangential;
      }
      const LocalCompliance w{delassus_(2 * i, 2 * i), delassus_(2 * i, 2 * i + 1),
                              delassus_(2 * i + 1, 2 * i), delassus_(2 * i + 1, 2 * i + 1)};
      const double normal = contact.normal;
      const double tangential = contact.tangential;
      if (!solve_local(contact, w, penetration, slip)) {
        return {ContactStatus::jammed, static_cast<int>(i), answer.sweeps};
      }
      const double change =
          std::max(std::abs(contact.normal - normal), std::abs(contact.tangential - tangential));
      if (!(change <= largest_change)) {
        largest_change = change;
        answer.contact = static_cast<int>(i);
      }
      largest_force =
          std::max({largest_force, std::abs(contact.normal), std::abs(contact.tangential)});
    }
    if (largest_change <= parameters_.tolerance * largest_force) {
      answer.status = ContactStatus::converged;
      break;
    }
  }
  return answer;
}

}  // namespace stridor
