#include "solvers/contact/contact_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "solvers/contact/substrate_step.hpp"

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

/// The same where friction is regularised: with the signed coefficient g(v) = sign(v) μ(|v|) s(|v|),
///
///   λ_n = penetration/(w_nn + g w_nt),   F(v) = h v − slip + λ_n (w_tn + g w_tt) = 0,
///
/// by Newton's method in |v| on the side to which the contact slips without friction, in a bracket.
/// @returns false where no force closes the gap
bool solve_creep(LocalProblem& contact, const LocalCompliance& w, double penetration, double slip) {
  contact.normal = 0.0;
  contact.tangential = 0.0;
  contact.state = ContactState::open;
  if (contact.is_unilateral && !(penetration > 0.0)) return !std::isnan(penetration);
  const double at_rest = w.tn * penetration / w.nn - slip;  // F(0)
  if (!(w.nn > 0.0) || std::isnan(at_rest)) return false;
  const double side = at_rest > 0.0 ? -1.0 : 1.0;
  const auto coefficient_at = [&](double v) {
    return side * contact.friction_factor * sliding_friction(*contact.creep, v);
  };
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  double v = side * contact.last_slip > 0.0 ? std::abs(contact.last_slip) : 0.0;
  for (int i = 0; i < 200; ++i) {
    const double g = coefficient_at(v);
    const double compliance = w.nn + g * w.nt;
    if (!(compliance > 0.0)) return false;
    contact.normal = penetration / compliance;
    contact.tangential = g * contact.normal;
    const double moved = w.tn + g * w.tt;
    const double miss = contact.step * v + side * (contact.normal * moved - slip);
    (miss > 0.0 ? high : low) = v;
    const double by_v = contact.friction_factor * sliding_friction_slope(*contact.creep, v);
    // g changes by side · by_v with |v|.
    const double slope =
        contact.step + contact.normal * by_v * (w.tt - w.nt * moved / compliance);
    double next = v - miss / slope;
    if (!(next > low && next < high)) {
      next = std::isinf(high) ? 2.0 * v + std::abs(at_rest) / contact.step : 0.5 * (low + high);
    }
    if (std::abs(next - v) <= 1e-14 * v || next == v || miss == 0.0) break;
    v = next;
  }
  contact.state = ContactState::slip;
  return true;
}

/// Sliding in a given direction. @returns false where no force closes the gap
bool slide(LocalProblem& contact, const LocalCompliance& w, double penetration, double direction) {
  const double compliance = w.nn + direction * contact.sliding_friction * w.nt;
  contact.normal = penetration / compliance;
  contact.tangential = direction * contact.sliding_friction * contact.normal;
  contact.state = ContactState::slip;
  return compliance > 0.0;
}

/// The solution of one contact that does not just slide, under the forces of all others.
/// @returns false where no force closes the gap
[[gnu::noinline]] bool solve_any(LocalProblem& contact, const LocalCompliance& w,
                                 double penetration, double slip) {
  if (contact.substrate != nullptr) return solve_substrate(contact, w, slip);
  if (contact.creep != nullptr) return solve_creep(contact, w, penetration, slip);

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
  return slide(contact, w, penetration, tangential < 0.0 ? -1.0 : 1.0);
}

/// The solution of one contact under the forces of all others, persistent sliding first: most steps
/// of a run are that.
/// @returns false where no force closes the gap
inline bool solve_local(LocalProblem& contact, const LocalCompliance& w, double penetration,
                        double slip) {
  const bool just_slides =
      !contact.is_unilateral && contact.substrate == nullptr && contact.creep == nullptr;
  return just_slides ? slide(contact, w, penetration, contact.direction)
                     : solve_any(contact, w, penetration, slip);
}

}  // namespace

bool solve_line(LocalProblem& contact, const Eigen::Matrix2d& delassus, double penetration,
                double slip) {
  return solve_local(contact, {delassus(0, 0), delassus(0, 1), delassus(1, 0), delassus(1, 1)},
                     penetration, slip);
}

ContactSolver::ContactSolver(int num_contacts, ContactSolverParameters parameters, int num_planar)
    : parameters_(parameters),
      delassus_(Eigen::MatrixXd::Zero(2 * num_contacts + 3 * num_planar,
                                      2 * num_contacts + 3 * num_planar)),
      sliding_(Eigen::MatrixXd::Zero(num_contacts + num_planar, num_contacts + num_planar)),
      right_side_(Eigen::VectorXd::Zero(num_contacts + num_planar)),
      forces_(right_side_),
      factor_(num_contacts + num_planar),
      jamming_(num_contacts + num_planar),
      num_lines_(2 * num_contacts),
      left_(Eigen::VectorXd::Zero(num_planar > 0 ? delassus_.rows() : 0)),
      before_(left_),
      after_(left_),
      acceleration_(left_.size()) {}

ContactAnswer ContactSolver::solve(std::span<LocalProblem> contacts) {
  if (contacts.size() == 1) {
    const LocalCompliance w{delassus_(0, 0), delassus_(0, 1), delassus_(1, 0), delassus_(1, 1)};
    LocalProblem& contact = contacts[0];
    const bool is_solved = solve_local(contact, w, contact.penetration, contact.slip);
    return {is_solved ? ContactStatus::converged : ContactStatus::jammed, 0, 1};
  }
  if (contacts.empty()) return {};
  const bool is_bilateral =
      std::none_of(contacts.begin(), contacts.end(), [](const LocalProblem& c) {
        return c.is_unilateral || c.creep != nullptr;
      });
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
