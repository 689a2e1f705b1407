#include "solvers/face_contact_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

constexpr Eigen::Index per_contact = 3;  // normal, along, across
constexpr double tolerance = 1e-12;      // of the largest force

const FaceContactLaw& checked(const FaceContactLaw& law) {
  if (!law.penalty || !(law.speed > 0.0)) {
    throw std::invalid_argument(
        "motion of face contacts: takes contacts with a penalty, and a plate that turns");
  }
  return law;
}

/// sin(x)/x, and its lowest value from where that is first reached.
double least_sine_ratio(double x) {
  constexpr double lowest_at = 4.493409457909064;
  const double to = std::min(x, lowest_at);
  return to > 0.0 ? std::sin(to) / to : 1.0;
}

/// The springs of closed contacts are part of what is propagated, and one that opens is taken out
/// by a force. The law has one solution where that force, which acts on itself through what it
/// moves by the end of a step, is always left a positive share: 1 − k_C W, with
///
///   W = Σ φ φᵀ (1 − sin(ω h)/(ω h))/ω²
///
/// of the modes of the closed system at the contacts. No longer step is better.
void check_step(const LinearSystem& closed, const FaceSlidingState& state, double penalty,
                double step) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(
      split(closed.position).symmetric, closed.mass);
  std::vector<Eigen::VectorXd> rows;
  for (const FaceContactPoint& point : state.contacts)
    if (point.is_closed) rows.push_back(modes.eigenvectors().transpose() * point.normal);
  Eigen::VectorXd moved(closed.size());
  for (Eigen::Index i = 0; i < moved.size(); ++i) {
    const double square = std::max(modes.eigenvalues()(i), 0.0);
    const double angle = std::sqrt(square) * step;
    moved(i) = angle > 1e-4 ? (1.0 - least_sine_ratio(angle)) / square : step * step / 6.0;
  }
  const auto size = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd share = Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      share(i, j) -= penalty * rows[static_cast<std::size_t>(i)].dot(
                                   moved.cwiseProduct(rows[static_cast<std::size_t>(j)]));
    }
  }
  if (size == 0 || Eigen::LLT<Eigen::MatrixXd>(share).info() == Eigen::Success) return;
  throw std::invalid_argument(fmt::format(
      "motion of face contacts: a step of {:g} s is too long for contacts as stiff as these",
      step));
}

}  // namespace

FaceContactMotion::FaceContactMotion(const LinearSystem& bodies, std::vector<FaceContact> contacts,
                                     const FaceContactLaw& law, const FaceSlidingState& state,
                                     double step)
    : contacts_(std::move(contacts)),
      law_(checked(law)),
      sliding_(state),
      propagator_(linearise(bodies, contacts_, law_, sliding_), step) {
  const Eigen::Index n = bodies.size();
  const auto num_contacts = static_cast<Eigen::Index>(contacts_.size());
  const Eigen::Index m = per_contact * num_contacts;
  const double penalty = *law_.penalty;
  check_step(linearise(bodies, contacts_, law_, sliding_), sliding_, penalty, step);
  gap_rows_ = velocity_rows_ = Eigen::MatrixXd::Zero(m, n);
  drive_ = preload_ = Eigen::VectorXd::Zero(m);
  inputs_ = Eigen::MatrixXd::Zero(n, m);
  linear_ = Eigen::MatrixXd::Zero(m, m);
  for (Eigen::Index k = 0; k < m; k += per_contact) {
    const auto i = static_cast<std::size_t>(k / per_contact);
    const FaceContact& contact = contacts_[i];
    const FaceContactPoint& point = sliding_.contacts[i];
    gap_rows_.row(k) = point.normal;
    velocity_rows_.row(k + 1) = -contact.friction();
    drive_.segment<2>(k + 1) = point.velocity;
    inputs_.col(k) = point.normal;
    inputs_.col(k + 1) = point.along;
    if (law_.friction_turns) {
      velocity_rows_.row(k + 2) = -contact.across();
      gap_rows_.row(k + 2) = -law_.speed * contact.radius * contact.turning();
      inputs_.col(k + 2) = contact.across();
    }
    if (!point.is_closed) continue;
    const Eigen::Vector2d friction = law_.friction * point.direction;
    linear_(k, k) = -penalty;
    linear_.block<2, 1>(k + 1, k) = -penalty * friction;
    linear_.block<2, 2>(k + 1, k + 1) = turning_resistance(law_, point);
    preload_(k) = point.force;
    preload_.segment<2>(k + 1) = point.force * friction;
  }
  const Eigen::MatrixXd& response = propagator_.slope_response();
  const auto seen = [&](const Eigen::MatrixXd& answer) -> Eigen::MatrixXd {
    return gap_rows_ * answer.topRows(n) + velocity_rows_ * answer.bottomRows(n);
  };
  answer_ = response * inputs_;
  bare_ = seen(answer_);
  answering_ = (Eigen::MatrixXd::Identity(m, m) + bare_ * linear_).inverse();
  compliance_ = answering_ * bare_;
  constexpr Eigen::Index each = FaceContact::num_bending;
  const Eigen::Index num_bending = law_.forces_bend ? each * num_contacts : 0;
  bending_inputs_.resize(n, num_bending);
  normal_bending_.resize(num_bending, n);
  friction_bending_.resize(num_bending, n);
  for (Eigen::Index i = 0; each * i < num_bending; ++i) {
    const FaceContact& contact = contacts_[static_cast<std::size_t>(i)];
    bending_inputs_.middleCols(each * i, each) = contact.bending_forces();
    normal_bending_.middleRows(each * i, each) = contact.normal_bending();
    friction_bending_.middleRows(each * i, each) = contact.friction_bending();
  }
  if (num_bending > 0) {
    bending_answer_ = response * bending_inputs_;
    bending_bare_ = seen(bending_answer_);
  }
  start(Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n));
}

/// Gap and velocities, as far as they are linear, from those of the sliding state.
Eigen::VectorXd FaceContactMotion::relative(const Eigen::VectorXd& q,
                                            const Eigen::VectorXd& v) const {
  return gap_rows_ * q + velocity_rows_ * v;
}

Eigen::VectorXd FaceContactMotion::linear_forces(const Eigen::VectorXd& relative) const {
  return preload_ + linear_ * relative;
}

/// What the forces of this instant do by bending, at a displacement.
void FaceContactMotion::bend(const Eigen::VectorXd& displacement) {
  if (bending_.size() == 0) return;
  constexpr Eigen::Index each = FaceContact::num_bending;
  const Eigen::VectorXd normal = normal_bending_ * displacement;
  const Eigen::VectorXd friction = friction_bending_ * displacement;
  for (Eigen::Index i = 0; each * i < bending_.size(); ++i) {
    const Eigen::Index k = per_contact * i;
    const auto force = bending_inputs_.middleCols(each * i, each) * normal.segment<each>(each * i);
    gap_bending_(i) = 0.5 * displacement.dot(force);
    bending_.segment<each>(each * i) =
        (forces_(k) - preload_(k)) * normal.segment<each>(each * i) +
        (forces_(k + 1) - preload_(k + 1)) * friction.segment<each>(each * i);
  }
}

void FaceContactMotion::start(const Eigen::VectorXd& displacement,
                              const Eigen::VectorXd& velocity) {
  q_ = displacement;
  v_ = velocity;
  relative_ = relative(q_, v_);
  forces_ = linear_forces(relative_);
  bending_ = Eigen::VectorXd::Zero(bending_inputs_.cols());
  gap_bending_ = Eigen::VectorXd::Zero(num_contacts());
  bend(q_);
  for (Eigen::Index k = 0; k < forces_.size(); k += per_contact) {
    const Eigen::Index i = k / per_contact;
    const double gap =
        sliding_.contacts[static_cast<std::size_t>(i)].gap + relative_(k) + gap_bending_(i);
    forces_(k) = std::max(0.0, -*law_.penalty * gap);
    const Eigen::Vector2d v_face = drive_.segment<2>(k + 1) + relative_.segment<2>(k + 1);
    const double speed = v_face.norm();
    const double limit = law_.friction * forces_(k);
    if (speed > 0.0) forces_.segment<2>(k + 1) = limit / speed * v_face;
  }
  bend(q_);
  remainder_ = forces_ - linear_forces(relative_);
}

bool FaceContactMotion::step() {
  constexpr int max_repeats = 100;
  const Eigen::Index n = q_.size();
  const bool bends = bending_.size() > 0;  // BLAS takes no empty matrices
  Eigen::VectorXd before = inputs_ * remainder_;
  if (bends) before += bending_inputs_ * bending_;
  propagator_.advance(q_, v_, before, Eigen::VectorXd::Zero(n));
  const Eigen::VectorXd predicted = relative(q_, v_);
  Eigen::VectorXd change;
  bool has_converged = false;
  for (int repeat = 0; repeat < max_repeats && !has_converged; ++repeat) {
    if (!solve(bends ? predicted + bending_bare_ * bending_ : predicted)) return false;
    change = answer_ * remainder_;
    if (bends) change += bending_answer_ * bending_;
    const Eigen::VectorXd gap_before = gap_bending_;
    const Eigen::VectorXd bending_before = bending_;
    bend(q_ + change.head(n));
    const double largest = std::max(forces_.cwiseAbs().maxCoeff(), preload_.cwiseAbs().maxCoeff());
    const double gap_change = (gap_bending_ - gap_before).lpNorm<Eigen::Infinity>();
    const double force_change = (bending_ - bending_before).lpNorm<Eigen::Infinity>();
    has_converged = *law_.penalty * gap_change + force_change <= tolerance * largest;
  }
  q_ += change.head(n);
  v_ += change.tail(n);
  return has_converged && std::isfinite(q_.squaredNorm() + v_.squaredNorm());
}

/// Forces at the end of a step.
/// @param predicted what is linear of gap and velocities there, without any remainder
bool FaceContactMotion::solve(const Eigen::VectorXd& predicted) {
  free_ = answering_ * (predicted - bare_ * preload_);
  const bool has_converged = sweep() || search();
  relative_ = free_ + compliance_ * forces_;
  remainder_ = forces_ - linear_forces(relative_);
  return has_converged;
}

/// What the law compares: friction at the end of the step and what would stop the slip then, in
/// velocities.
double FaceContactMotion::softness(Eigen::Index k) const {
  return std::max({0.0, -compliance_(k + 1, k + 1), -compliance_(k + 2, k + 2)});
}

double FaceContactMotion::gap_at_rest(Eigen::Index k) const {
  const Eigen::Index i = k / per_contact;
  return sliding_.contacts[static_cast<std::size_t>(i)].gap + gap_bending_(i) + free_(k);
}

/// Gauss and Seidel's sweeps. @return whether they have converged
bool FaceContactMotion::sweep() {
  constexpr int max_sweeps = 40;
  const double penalty = *law_.penalty;
  const double least = preload_.cwiseAbs().maxCoeff();
  Eigen::VectorXd& f = forces_;
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    double largest = least;
    double change = 0.0;
    for (Eigen::Index k = 0; k < f.size(); k += per_contact) {
      const Eigen::Vector3d last = f.segment<3>(k);
      const double W = compliance_(k, k);
      const double gap = gap_at_rest(k) + compliance_.row(k).dot(f) - W * f(k);
      f(k) = std::max(0.0, -penalty * gap / (1.0 + penalty * W));
      const double limit = law_.friction * f(k);
      const Eigen::Vector2d velocity =
          drive_.segment<2>(k + 1) + free_.segment<2>(k + 1) + compliance_.middleRows<2>(k + 1) * f;
      // Without slip friction is what stops it, unless that is more than there can be.
      const double soft = softness(k);
      const Eigen::Vector2d trial = soft * f.segment<2>(k + 1) + velocity;
      const double size = trial.norm();
      if (size > soft * limit) {
        f.segment<2>(k + 1) = limit / size * trial;
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
Eigen::VectorXd FaceContactMotion::deviation(const Eigen::VectorXd& f,
                                             Eigen::MatrixXd* slope) const {
  const double penalty = *law_.penalty;
  const Eigen::VectorXd moved = compliance_ * f;
  Eigen::VectorXd apart = f;
  if (slope != nullptr) slope->setIdentity(f.size(), f.size());
  for (Eigen::Index k = 0; k < f.size(); k += per_contact) {
    const double gap = gap_at_rest(k) + moved(k);
    if (gap < 0.0) {
      apart(k) += penalty * gap;
      if (slope != nullptr) slope->row(k) += penalty * compliance_.row(k);
    }
    const double soft = softness(k);
    const double limit = law_.friction * std::max(0.0, f(k));
    const Eigen::Vector2d velocity =
        drive_.segment<2>(k + 1) + free_.segment<2>(k + 1) + moved.segment<2>(k + 1);
    const Eigen::Vector2d trial = soft * f.segment<2>(k + 1) + velocity;
    const double size = trial.norm();
    const auto rows = compliance_.middleRows<2>(k + 1);
    if (size > soft * limit) {
      const Eigen::Vector2d direction = trial / size;
      apart.segment<2>(k + 1) -= limit * direction;
      if (slope == nullptr) continue;
      const Eigen::Matrix2d turning =
          limit / size * (Eigen::Matrix2d::Identity() - direction * direction.transpose());
      slope->middleRows<2>(k + 1) -= turning * rows;
      slope->block<2, 2>(k + 1, k + 1) -= soft * turning;
      if (f(k) > 0.0) slope->block<2, 1>(k + 1, k) -= law_.friction * direction;
    } else if (soft > 0.0) {
      apart.segment<2>(k + 1) = -velocity / soft;
      if (slope == nullptr) continue;
      slope->middleRows<2>(k + 1) = -rows / soft;
      // A direction that friction has not is left where it is.
      for (const Eigen::Index row : {k + 1, k + 2})
        if (compliance_(row, row) == 0.0) (*slope)(row, row) = 1.0;
    }
  }
  return apart;
}

/// Newton's method where sweeps go round in circles, with steps that are halved until the deviation
/// falls.
bool FaceContactMotion::search() {
  constexpr int max_iterations = 60;
  constexpr int max_halvings = 12;
  Eigen::MatrixXd slope;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Eigen::VectorXd apart = deviation(forces_, &slope);
    const double largest = std::max(preload_.cwiseAbs().maxCoeff(), forces_.cwiseAbs().maxCoeff());
    if (!std::isfinite(largest)) return false;
    if (apart.cwiseAbs().maxCoeff() <= tolerance * largest) return true;
    const Eigen::VectorXd change = slope.partialPivLu().solve(-apart);
    if (change.cwiseAbs().maxCoeff() <= tolerance * largest) {
      forces_ += change;
      return true;
    }
    double share = 1.0;
    for (int halving = 0; halving < max_halvings; ++halving, share *= 0.5)
      if (deviation(forces_ + share * change, nullptr).norm() < apart.norm()) break;
    forces_ += share * change;
  }
  return false;
}

FaceContactState FaceContactMotion::contact(int index) const {
  const Eigen::Index k = per_contact * index;
  const auto i = static_cast<std::size_t>(index);
  FaceContactState state;
  state.gap = sliding_.contacts[i].gap + relative_(k) + gap_bending_(index);
  state.force = forces_(k);
  state.friction_force = forces_(k + 1);
  state.across_force = forces_(k + 2);
  state.slip_velocity = (drive_.segment<2>(k + 1) + relative_.segment<2>(k + 1)).norm();
  constexpr double still = 1e-9;  // of the velocity of sliding
  const double sliding = law_.speed * contacts_[i].radius;
  const bool sticks = law_.friction > 0.0 && state.slip_velocity <= still * sliding;
  state.state = !(state.force > 0.0) ? ContactState::open
                : sticks             ? ContactState::stick
                                     : ContactState::slip;
  return state;
}

void FaceContactMotion::save(State& state, const std::string& prefix) const {
  const auto put = [&](const char* name, const Eigen::VectorXd& values) {
    state.put(prefix + name, {values.data(), static_cast<std::size_t>(values.size())});
  };
  put("displacement", q_);
  put("velocity", v_);
  put("forces", forces_);
  put("relative", relative_);
  put("remainder", remainder_);
  put("bending", bending_);
  put("gap_bending", gap_bending_);
}

void FaceContactMotion::load(const State& state, const std::string& prefix) {
  const auto get = [&](const char* name, Eigen::VectorXd& values) {
    state.get(prefix + name, {values.data(), static_cast<std::size_t>(values.size())});
  };
  get("displacement", q_);
  get("velocity", v_);
  get("forces", forces_);
  get("relative", relative_);
  get("remainder", remainder_);
  get("bending", bending_);
  get("gap_bending", gap_bending_);
}

}  // namespace stridor
