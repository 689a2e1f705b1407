#include "solvers/face_contact_solver.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace stridor {
namespace {

constexpr Eigen::Index per_contact = 3;  // normal, along, across

/// What friction is compared with: velocities that it takes away, per force.
double resistance(const FaceContactAnswer::Compliance& compliance, Eigen::Index k) {
  return std::max({0.0, -compliance(k + 1, k + 1), -compliance(k + 2, k + 2)});
}

}  // namespace

FaceContactSolver::FaceContactSolver(const FaceContactLaw& law, double least)
    : friction_(law.friction), softness_(law.penalty ? 1.0 / *law.penalty : 0.0), least_(least) {}

bool FaceContactSolver::solve(FaceContactAnswer& answer, Eigen::VectorXd& forces) {
  seen_.resize(forces.size());
  apart_.resize(forces.size());
  first_guess_ = forces;
  if (follow(answer, forces)) return true;
  forget();
  forces = first_guess_;
  return repeat(answer, forces);
}

double FaceContactSolver::largest_of(const Eigen::VectorXd& forces) const {
  return std::max(least_, forces.cwiseAbs().maxCoeff());
}

FaceContactSolver::Regime FaceContactSolver::regime_of(const Compliance& compliance, Eigen::Index k,
                                                       const Eigen::VectorXd& seen,
                                                       const Eigen::VectorXd& f) const {
  const double overlap = (seen(k) + softness_ * f(k)) / (softness_ + compliance(k, k));
  if (!(f(k) > overlap)) return Regime::open;
  const double soft = resistance(compliance, k);
  const Eigen::Vector2d trial = soft * f.segment<2>(k + 1) + seen.segment<2>(k + 1);
  const double limit = soft * friction_ * std::max(0.0, f(k));
  return trial.squaredNorm() > limit * limit ? Regime::slip : Regime::stick;
}

/// Newton's method with an inverse that is kept.
bool FaceContactSolver::follow(FaceContactAnswer& answer, Eigen::VectorXd& f) {
  constexpr int max_iterations = 40;
  constexpr double slow = 0.2;       // share of a correction that is left to the next
  constexpr double most_left = 6.0;  // iterations, beyond which a new inverse takes less
  const Compliance& compliance = answer.compliance();
  regimes_.resize(static_cast<std::size_t>(f.size() / per_contact));
  double before = 0.0;  // the last correction; 0 where there is none, negative: for a new inverse
  num_corrections_ = 0;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const double unsettled = answer.see(f.data(), seen_.data());
    if (open_contacts(compliance, f)) {  // the others see it
      num_corrections_ = 0;
      continue;
    }
    const bool is_new = kept_ != regimes_;
    if (is_new || before < 0.0) keep(compliance, seen_, f);
    const double change = correct(compliance, seen_, f);
    const double largest = largest_of(f);
    if (!std::isfinite(largest)) return false;
    if (std::max(change, unsettled) <= tolerance * largest) {
      obey(compliance, seen_, f);
      return true;
    }
    const double rate = !is_new && before > 0.0 ? change / before : 0.0;
    const bool is_slow = rate > slow || (rate > 0.0 && std::log(tolerance * largest / change) <
                                                           most_left * std::log(rate));
    before = is_slow ? -1.0 : change;
  }
  return false;
}

/// Finds the regime of every contact. @return whether one has opened under a force, now none
bool FaceContactSolver::open_contacts(const Compliance& compliance, Eigen::VectorXd& f) {
  bool has_opened = false;
  for (std::size_t i = 0; i < regimes_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i) * per_contact;
    regimes_[i] = regime_of(compliance, k, seen_, f);
    if (regimes_[i] != Regime::open) continue;
    has_opened = has_opened || !f.segment<3>(k).isZero(0.0);
    f.segment<3>(k).setZero();
  }
  return has_opened;
}

/// The inverse at forces and what is seen under them.
void FaceContactSolver::keep(const Compliance& compliance, const Eigen::VectorXd& seen,
                             const Eigen::VectorXd& f) {
  kept_ = regimes_;
  num_corrections_ = 0;
  deviation(compliance, seen, f, apart_, &slope_);
  active_.clear();
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i] == Regime::open) continue;
    for (Eigen::Index d = 0; d < per_contact; ++d)
      active_.push_back(static_cast<Eigen::Index>(i) * per_contact + d);
  }
  if (active_.empty()) {
    keep_inverse({});
    return;
  }
  keep_inverse(small_inverse(slope_(active_, active_)));
}

void FaceContactSolver::keep_inverse(const Eigen::MatrixXd& inverse) {
  inverse_ = inverse;
  padded_inverse_ = PaddedMatrix(inverse);
  const auto padded = static_cast<Eigen::Index>(padded_size(inverse.rows()));
  active_apart_.setZero(padded);
  change_.setZero(padded);
}

/// @return the largest correction of a force
double FaceContactSolver::correct(const Compliance& compliance, const Eigen::VectorXd& seen,
                                  Eigen::VectorXd& f) {
  deviation(compliance, seen, f, apart_, nullptr);
  const std::size_t num_active = active_.size();
  for (std::size_t i = 0; i < num_active; ++i)
    active_apart_(static_cast<Eigen::Index>(i)) = apart_(active_[i]);
  change_.setZero();
  padded_inverse_.add_product(active_apart_.data(), change_.data());
  accelerate();
  double largest = 0.0;
  for (std::size_t i = 0; i < num_active; ++i) {
    const double change = change_(static_cast<Eigen::Index>(i));
    f(active_[i]) -= change;
    largest = std::max(largest, std::abs(change));
  }
  return largest;
}

/// Broyden's method from the kept inverse H: the corrections c_0, ... since it was last changed
/// tell how the forces answer to them,
///
///   c ← H r,   c ← c + c_{j+1} (c_jᵀ c)/|c_j|² for j < n − 1,   c_n = c/(1 − c_{n−1}ᵀ
///   c/|c_{n−1}|²)
///
/// (Kelley, Iterative Methods for Linear and Nonlinear Equations, 7.3).
void FaceContactSolver::accelerate() {
  constexpr double least = 0.1;  // of what c is divided by
  for (std::size_t j = 0; j + 1 < num_corrections_; ++j) {
    const double share = corrections_[j].dot(change_) / corrections_[j].squaredNorm();
    change_ += share * corrections_[j + 1];
  }
  if (num_corrections_ > 0) {
    const Eigen::VectorXd& last = corrections_[num_corrections_ - 1];
    const double left = 1.0 - last.dot(change_) / last.squaredNorm();
    if (left > least) change_ /= left;
  }
  if (num_corrections_ == corrections_.size()) {
    num_corrections_ = 0;
    return;
  }
  corrections_[num_corrections_++] = change_;
}

/// Removes what rounding left of the laws: no force pulls, and friction that slips is at its limit.
void FaceContactSolver::obey(const Compliance& compliance, const Eigen::VectorXd& seen,
                             Eigen::VectorXd& f) const {
  for (std::size_t i = 0; i < regimes_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i) * per_contact;
    if (regimes_[i] == Regime::open) continue;
    f(k) = std::max(0.0, f(k));
    if (regimes_[i] != Regime::slip) continue;
    const Eigen::Vector2d trial =
        resistance(compliance, k) * f.segment<2>(k + 1) + seen.segment<2>(k + 1);
    f.segment<2>(k + 1) = friction_ * f(k) / trial.norm() * trial;
  }
}

/// The laws with what bends as it was, until that has settled.
bool FaceContactSolver::repeat(FaceContactAnswer& answer, Eigen::VectorXd& f) {
  constexpr int max_repeats = 100;
  const Compliance& compliance = answer.compliance();
  for (int repeat = 0; repeat < max_repeats; ++repeat) {
    const double unsettled = answer.see(f.data(), seen_.data());
    const Eigen::VectorXd free = seen_ - compliance * f;
    const Eigen::VectorXd before = f;
    if (!sweep(compliance, free, f) && !search(compliance, free, f)) return false;
    const double change = (f - before).cwiseAbs().maxCoeff();
    if (std::max(change, unsettled) <= tolerance * largest_of(f)) return true;
  }
  return false;
}

bool FaceContactSolver::sweep(const Compliance& compliance, const Eigen::VectorXd& free,
                              Eigen::VectorXd& f) const {
  constexpr int max_sweeps = 40;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    double largest = least_;
    double change = 0.0;
    for (Eigen::Index k = 0; k < f.size(); k += per_contact) {
      const Eigen::Vector3d last = f.segment<3>(k);
      const double W = compliance(k, k);
      const double gap = free(k) + compliance.row(k).dot(f) - W * f(k);
      f(k) = std::max(0.0, -gap / (softness_ + W));
      const double limit = friction_ * f(k);
      const Eigen::Vector2d velocity = free.segment<2>(k + 1) + compliance.middleRows<2>(k + 1) * f;
      // Without slip friction is what stops it, unless that is more than there can be.
      const double soft = resistance(compliance, k);
      const Eigen::Vector2d trial = soft * f.segment<2>(k + 1) + velocity;
      if (trial.norm() > soft * limit) {
        f.segment<2>(k + 1) = limit * trial.normalized();
      } else if (soft > 0.0) {
        f.segment<2>(k + 1) = trial / soft;
      }
      change = std::max(change, (f.segment<3>(k) - last).cwiseAbs().maxCoeff());
      largest = std::max(largest, f(k));
    }
    if (change <= tolerance * largest) return true;
  }
  return false;
}

/// How far forces are from the laws, and its slope where that is wanted.
void FaceContactSolver::deviation(const Compliance& compliance, const Eigen::VectorXd& seen,
                                  const Eigen::VectorXd& f, Eigen::VectorXd& apart,
                                  Compliance* slope) const {
  apart = f;
  if (slope != nullptr) slope->setIdentity(f.size(), f.size());
  for (Eigen::Index k = 0; k < f.size(); k += per_contact) {
    const double stiffness = 1.0 / (softness_ + compliance(k, k));
    const double overlap = stiffness * (seen(k) + softness_ * f(k));
    if (f(k) > overlap) {
      apart(k) = overlap;
      if (slope != nullptr) {
        slope->row(k) = stiffness * compliance.row(k);
        (*slope)(k, k) += stiffness * softness_;
      }
    }
    const double soft = resistance(compliance, k);
    const double limit = friction_ * std::max(0.0, f(k));
    const Eigen::Vector2d velocity = seen.segment<2>(k + 1);
    const auto rows = compliance.middleRows<2>(k + 1);
    const Eigen::Vector2d trial = soft * f.segment<2>(k + 1) + velocity;
    const double size = trial.norm();
    if (size > soft * limit) {
      const Eigen::Vector2d direction = trial / size;
      apart.segment<2>(k + 1) -= limit * direction;
      if (slope == nullptr) continue;
      const Eigen::Matrix2d turning =
          limit / size * (Eigen::Matrix2d::Identity() - direction * direction.transpose());
      slope->middleRows<2>(k + 1) -= turning * rows;
      slope->block<2, 2>(k + 1, k + 1) -= soft * turning;
      if (f(k) > 0.0) slope->block<2, 1>(k + 1, k) -= friction_ * direction;
    } else if (soft > 0.0) {
      apart.segment<2>(k + 1) = -velocity / soft;
      if (slope == nullptr) continue;
      slope->middleRows<2>(k + 1) = -rows / soft;
      // A direction that friction has not is left where it is.
      for (const Eigen::Index row : {k + 1, k + 2})
        if (compliance(row, row) == 0.0) (*slope)(row, row) = 1.0;
    }
  }
}

/// Newton's method with steps that are halved until the deviation falls.
bool FaceContactSolver::search(const Compliance& compliance, const Eigen::VectorXd& free,
                               Eigen::VectorXd& forces) const {
  constexpr int max_iterations = 60;
  constexpr int max_halvings = 12;
  Compliance slope;
  Eigen::VectorXd apart, shortened;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    deviation(compliance, free + compliance * forces, forces, apart, &slope);
    const double largest = largest_of(forces);
    if (!std::isfinite(largest)) return false;
    if (apart.cwiseAbs().maxCoeff() <= tolerance * largest) return true;
    const Eigen::VectorXd change = slope.partialPivLu().solve(-apart);
    if (change.cwiseAbs().maxCoeff() <= tolerance * largest) {
      forces += change;
      return true;
    }
    double share = 1.0;
    for (int halving = 0; halving < max_halvings; ++halving, share *= 0.5) {
      const Eigen::VectorXd trial = forces + share * change;
      deviation(compliance, free + compliance * trial, trial, shortened, nullptr);
      if (shortened.norm() < apart.norm()) break;
    }
    forces += share * change;
  }
  return false;
}

void FaceContactSolver::save(State& state, const std::string& prefix) const {
  std::vector<double> regimes;
  for (const Regime regime : kept_) regimes.push_back(static_cast<double>(regime));
  state.put(prefix + "regimes", regimes);
  state.put(prefix + "inverse", {inverse_.data(), static_cast<std::size_t>(inverse_.size())});
}

void FaceContactSolver::load(const State& state, const std::string& prefix) {
  kept_.clear();
  active_.clear();
  for (const double regime : state.array(prefix + "regimes")) {
    kept_.push_back(static_cast<Regime>(static_cast<int>(regime)));
    if (kept_.back() == Regime::open) continue;
    for (Eigen::Index d = 0; d < per_contact; ++d)
      active_.push_back(static_cast<Eigen::Index>(kept_.size() - 1) * per_contact + d);
  }
  const auto size = static_cast<Eigen::Index>(kept_.empty() ? 0 : active_.size());
  Eigen::MatrixXd inverse(size, size);
  state.get(prefix + "inverse", {inverse.data(), static_cast<std::size_t>(inverse.size())});
  keep_inverse(inverse);
}

}  // namespace stridor
