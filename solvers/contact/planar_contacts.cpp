// Contact forces of one step where contacts have two tangents.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/clones.hpp"
#include "solvers/contact/contact_solver.hpp"

namespace stridor {
namespace {

/// Takes forces times the columns of a contact, one after the other, from what is left of gaps and slips.
STRIDOR_CLONES
void take_away(std::size_t n, const double* __restrict columns, const double* __restrict forces,
               std::size_t num_forces, double* __restrict left) {
  if (num_forces == 3) {
    for (std::size_t i = 0; i < n; ++i)
      left[i] -= forces[0] * columns[i] + forces[1] * columns[n + i] + forces[2] * columns[2 * n + i];
    return;
  }
  for (std::size_t i = 0; i < n; ++i) left[i] -= forces[0] * columns[i] + forces[1] * columns[n + i];
}

/// μ of a contact that slips by a distance, and its derivative by the distance.
struct SlipFriction {
  double coefficient;
  double slope;
};

inline SlipFriction friction_over(const PlanarProblem& contact, double distance) {
  if (contact.creep == nullptr) return {contact.sliding_friction, 0.0};
  const double speed = distance / contact.step;
  return {contact.friction_factor * sliding_friction(*contact.creep, speed),
          contact.friction_factor * sliding_friction_slope(*contact.creep, speed) / contact.step};
}

/// The friction equations of a contact whose gap is closed: (S + η) τ = b, λ = (p* − D_nt τ)/D_nn.
struct ClosedContact {
  Eigen::Matrix2d tangents;      ///< S = D_tt − D_tn D_nt/D_nn
  Eigen::Vector2d slip;          ///< b = σ* − D_tn p*/D_nn
  Eigen::Vector2d to_gap;        ///< D_nt/D_nn
  double pressure;               ///< p*/D_nn

  ClosedContact(const Eigen::Matrix3d& delassus, const Eigen::Vector3d& known) {
    const double soft = 1.0 / delassus(0, 0);
    pressure = known(0) * soft;
    to_gap << delassus(0, 1) * soft, delassus(0, 2) * soft;
    for (int r = 0; r < 2; ++r) {
      slip(r) = known(r + 1) - delassus(r + 1, 0) * pressure;
      for (int c = 0; c < 2; ++c)
        tangents(r, c) = delassus(r + 1, c + 1) - delassus(r + 1, 0) * to_gap(c);
    }
  }
  double normal(const Eigen::Vector2d& friction) const { return pressure - to_gap.dot(friction); }
  /// (S + η)⁻¹ x
  Eigen::Vector2d friction(double eta, const Eigen::Vector2d& x) const {
    const double a = tangents(0, 0) + eta;
    const double d = tangents(1, 1) + eta;
    const double b = tangents(0, 1);
    const double c = tangents(1, 0);
    const double share = 1.0 / (a * d - b * c);
    return {share * (d * x(0) - b * x(1)), share * (a * x(1) - c * x(0))};
  }
};

/// Forces for one η, and how far their friction is below its limit: χ = μ λ/|τ| − 1, nearly linear
/// in η, with its derivative.
struct SlipTrial {
  Eigen::Vector2d friction;
  double normal;
  double below;
  double slope;
};

SlipTrial try_slip(const PlanarProblem& contact, const ClosedContact& closed, double eta) {
  SlipTrial trial;
  const Eigen::Vector2d tau = trial.friction = closed.friction(eta, closed.slip);
  trial.normal = closed.normal(tau);
  const Eigen::Vector2d change = -closed.friction(eta, tau);
  const double size = tau.norm();
  const double size_change = tau.dot(change) / size;
  const SlipFriction friction = friction_over(contact, eta * size);
  const double share = trial.normal / size;
  trial.below = friction.coefficient * share - 1.0;
  trial.slope =
      -friction.coefficient * (closed.to_gap.dot(change) + share * size_change) / size +
      friction.slope * (size + eta * size_change) * share;
  return trial;
}

/// η of the forces from which the iteration starts; none where they do not slip.
std::optional<double> guess_of(const PlanarProblem& contact, const Eigen::Matrix3d& delassus,
                               const Eigen::Vector3d& known) {
  if (contact.state != ContactState::slip || contact.tangential.isZero(0.0)) return std::nullopt;
  const Eigen::Vector2d& tau = contact.tangential;
  Eigen::Vector2d slip;
  for (int r = 0; r < 2; ++r) {
    slip(r) = known(r + 1) - delassus(r + 1, 0) * contact.normal - delassus(r + 1, 1) * tau(0) -
              delassus(r + 1, 2) * tau(1);
  }
  return std::sqrt(slip.squaredNorm() / tau.squaredNorm());
}

/// η of a contact that slips, by Newton's method in a bracket. @returns whether there is one
bool slip(PlanarProblem& contact, const Eigen::Matrix3d& delassus, const Eigen::Vector3d& known,
          const ClosedContact& closed, std::optional<double> guess) {
  constexpr int max_iterations = 200;
  constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();
  // The next step of Newton's method is then below rounding.
  constexpr double nearly = 1e-9;
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  const double scale = 0.5 * (delassus(1, 1) + delassus(2, 2));
  double eta = guess.value_or(0.0);
  if (!(eta > 0.0)) {
    // Without the response of slip to forces η is |σ*|/(μ λ).
    const double distance = known.tail<2>().norm();
    const double limit = friction_over(contact, distance).coefficient * closed.pressure;
    eta = limit > 0.0 ? distance / limit : scale;
  }
  SlipTrial trial = try_slip(contact, closed, eta);
  for (int i = 0; i < max_iterations; ++i) {
    if (std::isnan(trial.below)) return false;
    (trial.below > 0.0 ? high : low) = eta;
    double next = eta - trial.below / trial.slope;
    if (!(next > low && next < high))
      next = std::isinf(high) ? 2.0 * eta + scale : 0.5 * (low + high);
    const double change = std::abs(next - eta);
    if (change <= rounding * eta || trial.below == 0.0) break;
    eta = next;
    trial = try_slip(contact, closed, eta);
    if (change <= nearly * eta && contact.creep == nullptr) break;
  }
  if (!(trial.normal > 0.0)) return false;
  // Friction exactly at its limit.
  const double size = trial.friction.norm();
  const double coefficient = friction_over(contact, eta * size).coefficient;
  contact.normal = trial.normal;
  contact.tangential = (coefficient * trial.normal / size) * trial.friction;
  return true;
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

/// States as a number, which tells whether any has changed.
std::uint64_t states_of(std::span<const LocalProblem> contacts,
                        std::span<const PlanarProblem> planar) {
  std::uint64_t all = 0;
  for (const LocalProblem& contact : contacts)
    all = all * 31 + static_cast<unsigned>(contact.state);
  for (const PlanarProblem& contact : planar) all = all * 31 + static_cast<unsigned>(contact.state);
  return all;
}

}  // namespace

bool solve_planar(PlanarProblem& contact, const Eigen::Matrix3d& delassus,
                  const Eigen::Vector3d& known, SlipStart start) {
  if (!contact.is_unilateral) return slide_on(contact, delassus, known(0));
  const std::optional<double> guess =
      start == SlipStart::last_forces ? guess_of(contact, delassus, known) : std::nullopt;
  contact.normal = 0.0;
  contact.tangential.setZero();
  contact.state = ContactState::open;
  if (!(known(0) > 0.0)) return !known.hasNaN();
  contact.state = ContactState::slip;
  if (!(delassus(0, 0) > 0.0)) return false;
  const ClosedContact closed(delassus, known);
  const bool is_frictionless =
      contact.creep == nullptr ? contact.sticking_friction == 0.0
                               : contact.friction_factor == 0.0 || contact.creep->is_frictionless();
  if (is_frictionless) {
    contact.normal = closed.pressure;
    return true;
  }
  if (contact.creep == nullptr) {
    const Eigen::Vector2d sticking = closed.friction(0.0, closed.slip);
    const double normal = closed.normal(sticking);
    if (normal > 0.0 && sticking.norm() <= contact.sticking_friction * normal) {
      contact.normal = normal;
      contact.tangential = sticking;
      contact.state = ContactState::stick;
      return true;
    }
    if (contact.sliding_friction == 0.0) {
      contact.normal = closed.pressure;
      return true;
    }
  } else if (known.tail<2>().isZero(0.0) && delassus.block<2, 1>(1, 0).isZero(0.0)) {
    contact.normal = closed.pressure;
    return true;
  }
  return slip(contact, delassus, known, closed, guess);
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

template <class Forces>
void ContactSolver::act(Eigen::Index column, const Forces& forces) {
  if (forces.isZero(0.0)) return;
  take_away(static_cast<std::size_t>(left_.size()), delassus_.data() + column * left_.size(),
            forces.data(), static_cast<std::size_t>(forces.size()), left_.data());
}

std::optional<int> ContactSolver::sweep(std::span<LocalProblem> contacts,
                                        std::span<PlanarProblem> planar, SlipStart start) {
  const auto num_lines = static_cast<int>(contacts.size());
  for (int i = 0; i < num_lines; ++i) {
    LocalProblem& contact = contacts[static_cast<std::size_t>(i)];
    const Eigen::Index row = 2 * i;
    const Eigen::Matrix2d own = delassus_.block<2, 2>(row, row);
    const Eigen::Vector2d before = before_.segment<2>(row);
    const Eigen::Vector2d known = left_.segment<2>(row) + own.lazyProduct(before);
    if (!solve_line(contact, own, known(0), known(1))) return i;
    after_.segment<2>(row) << contact.normal, contact.tangential;
    act(row, (after_.segment<2>(row) - before).eval());
  }
  for (int i = 0; i < static_cast<int>(planar.size()); ++i) {
    PlanarProblem& contact = planar[static_cast<std::size_t>(i)];
    const Eigen::Index row = first_planar(i);
    const Eigen::Matrix3d own = delassus_.block<3, 3>(row, row);
    const Eigen::Vector3d before = before_.segment<3>(row);
    const Eigen::Vector3d known = left_.segment<3>(row) + own.lazyProduct(before);
    if (!solve_planar(contact, own, known, start)) return num_lines + i;
    after_.segment<3>(row) << contact.normal, contact.tangential;
    act(row, (after_.segment<3>(row) - before).eval());
  }
  return std::nullopt;
}

bool ContactSolver::take_forces(std::span<LocalProblem> contacts, std::span<PlanarProblem> planar,
                                const Eigen::VectorXd& forces) {
  for (std::size_t i = 0; i < planar.size(); ++i) {
    const PlanarProblem& contact = planar[i];
    if (contact.is_unilateral && contact.state != ContactState::open &&
        !(forces(first_planar(static_cast<int>(i))) > 0.0))
      return false;
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    act(row, (forces.segment<2>(row) - after_.segment<2>(row)).eval());
    contacts[i].normal = forces(row);
    contacts[i].tangential = forces(row + 1);
  }
  for (std::size_t i = 0; i < planar.size(); ++i) {
    const Eigen::Index row = first_planar(static_cast<int>(i));
    act(row, (forces.segment<3>(row) - after_.segment<3>(row)).eval());
    planar[i].normal = forces(row);
    planar[i].tangential = forces.segment<2>(row + 1);
  }
  after_ = forces;
  return true;
}

ContactAnswer ContactSolver::iterate(std::span<LocalProblem> contacts,
                                     std::span<PlanarProblem> planar) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    left_.segment<2>(row) << contacts[i].penetration, contacts[i].slip;
    before_.segment<2>(row) << contacts[i].normal, contacts[i].tangential;
  }
  for (std::size_t i = 0; i < planar.size(); ++i) {
    const Eigen::Index row = first_planar(static_cast<int>(i));
    left_.segment<3>(row) << planar[i].penetration, planar[i].slip;
    before_.segment<3>(row) << planar[i].normal, planar[i].tangential;
  }
  // Penetration and slip under all forces; a visit subtracts its change.
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    act(row, before_.segment<2>(row).eval());
  }
  for (std::size_t i = 0; i < planar.size(); ++i) {
    const Eigen::Index row = first_planar(static_cast<int>(i));
    act(row, before_.segment<3>(row).eval());
  }
  // Sweeps that settle do so long before these.
  constexpr int most_from_last = 100;
  // Few sweeps are cheaper than what they would be extrapolated with.
  constexpr int first_taken_up = 5, last_taken_up = 60;
  acceleration_.forget();
  std::uint64_t last_states = states_of(contacts, planar);
  double last_change = std::numeric_limits<double>::infinity();
  ContactAnswer answer{ContactStatus::not_converged, 0, 0};
  while (answer.sweeps < parameters_.max_sweeps) {
    const SlipStart start =
        answer.sweeps < most_from_last ? SlipStart::last_forces : SlipStart::known;
    ++answer.sweeps;
    if (const std::optional<int> jammed = sweep(contacts, planar, start))
      return {ContactStatus::jammed, *jammed, answer.sweeps};
    Eigen::Index largest = 0;
    const double change = (after_ - before_).cwiseAbs().maxCoeff(&largest);
    answer.contact = static_cast<int>(largest < num_lines_ ? largest / 2
                                                           : num_lines_ / 2 + (largest - num_lines_) / 3);
    if (change <= parameters_.tolerance * after_.cwiseAbs().maxCoeff()) {
      answer.status = ContactStatus::converged;
      break;
    }
    const std::uint64_t now = states_of(contacts, planar);
    // An extrapolation has gone astray where the next sweep changes more.
    if (now != last_states || change > last_change) acceleration_.forget();
    last_states = now;
    last_change = change;
    if (answer.sweeps >= first_taken_up && answer.sweeps <= last_taken_up &&
        acceleration_.add(before_, after_) && acceleration_.next().allFinite() &&
        !take_forces(contacts, planar, acceleration_.next()))
      acceleration_.forget();
    before_ = after_;
  }
  return answer;
}

}  // namespace stridor
