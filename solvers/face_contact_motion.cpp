#include "solvers/face_contact_motion.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stridor {
namespace {

constexpr Eigen::Index per_contact = 3;  // normal, along, across

/// Row of the velocity across that comes with the rotation, over Ω r: p_φ/r + s (h/2) w_rφ/r.
Eigen::VectorXd turning_row(const FaceContact& contact) {
  return (contact.pad_phi + contact.side * contact.half_thickness * contact.plate.w_r_phi) /
         contact.radius;
}

}  // namespace

FaceContactMotion::FaceContactMotion(const LinearSystem& system, std::vector<FaceContact> contacts,
                                     const FaceContactLaw& law, double step)
    : contacts_(std::move(contacts)), law_(law), propagator_(system, step) {
  const Eigen::Index n = system.size();
  const Eigen::Index m = per_contact * static_cast<Eigen::Index>(contacts_.size());
  gap_rows_ = velocity_rows_ = Eigen::MatrixXd::Zero(m, n);
  drive_ = preload_ = Eigen::VectorXd::Zero(m);
  inputs_ = Eigen::MatrixXd::Zero(n, m);
  linear_ = Eigen::MatrixXd::Zero(m, m);
  for (Eigen::Index k = 0; k < m; k += per_contact) {
    const FaceContact& contact = contacts_[static_cast<std::size_t>(k / per_contact)];
    const double sliding = law_.speed * contact.radius;
    gap_rows_.row(k) = contact.gap();
    velocity_rows_.row(k + 1) = -contact.friction();
    drive_(k + 1) = sliding;
    inputs_.col(k) = contact.gap();
    inputs_.col(k + 1) = contact.friction();
    linear_(k, k) = -law_.penalty;
    linear_(k + 1, k) = -law_.friction * law_.penalty;
    preload_(k) = law_.preload;
    preload_(k + 1) = law_.friction * law_.preload;
    if (!law_.friction_turns) continue;
    velocity_rows_.row(k + 2) = -contact.across();
    gap_rows_.row(k + 2) = -sliding * turning_row(contact);
    inputs_.col(k + 2) = contact.across();
    linear_(k + 2, k + 2) = law_.friction * law_.preload / sliding;
  }
  answer_ = propagator_.slope_response() * inputs_;
  bare_ = gap_rows_ * answer_.topRows(n) + velocity_rows_ * answer_.bottomRows(n);
  answering_ = (Eigen::MatrixXd::Identity(m, m) + bare_ * linear_).inverse();
  compliance_ = answering_ * bare_;
  start(Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n));
}

Eigen::VectorXd FaceContactMotion::relative(const Eigen::VectorXd& q,
                                            const Eigen::VectorXd& v) const {
  return gap_rows_ * q + velocity_rows_ * v + drive_;
}

Eigen::VectorXd FaceContactMotion::linear_forces(const Eigen::VectorXd& relative) const {
  return preload_ + linear_ * relative;
}

void FaceContactMotion::start(const Eigen::VectorXd& displacement,
                              const Eigen::VectorXd& velocity) {
  q_ = displacement;
  v_ = velocity;
  relative_ = relative(q_, v_);
  forces_ = linear_forces(relative_);
  for (Eigen::Index k = 0; k < forces_.size(); k += per_contact) {
    forces_(k) = std::max(0.0, forces_(k));
    const double speed = relative_.segment<2>(k + 1).norm();
    const double limit = law_.friction * forces_(k);
    if (speed > 0.0) forces_.segment<2>(k + 1) = limit / speed * relative_.segment<2>(k + 1);
  }
  remainder_ = forces_ - linear_forces(relative_);
}

bool FaceContactMotion::step() {
  const Eigen::Index n = q_.size();
  const Eigen::VectorXd before = inputs_ * remainder_;
  propagator_.advance(q_, v_, before, Eigen::VectorXd::Zero(n));
  const bool has_converged = solve(relative(q_, v_));
  const Eigen::VectorXd change = answer_ * remainder_;
  q_ += change.head(n);
  v_ += change.tail(n);
  return has_converged && std::isfinite(q_.squaredNorm() + v_.squaredNorm());
}

/// Forces at the end of a step.
/// @param predicted gap and velocities there without any remainder
bool FaceContactMotion::solve(const Eigen::VectorXd& predicted) {
  constexpr int max_sweeps = 1000;
  constexpr double tolerance = 1e-12;
  const Eigen::VectorXd free = answering_ * (predicted - bare_ * preload_);
  Eigen::VectorXd& f = forces_;
  bool has_converged = false;
  for (int sweep = 0; sweep < max_sweeps && !has_converged; ++sweep) {
    double largest = law_.preload;
    double change = 0.0;
    for (Eigen::Index k = 0; k < f.size(); k += per_contact) {
      const Eigen::Vector3d last = f.segment<3>(k);
      const double W = compliance_(k, k);
      const double gap = free(k) + compliance_.row(k).dot(f) - W * f(k);
      f(k) = std::max(0.0, (law_.preload - law_.penalty * gap) / (1.0 + law_.penalty * W));
      const double limit = law_.friction * f(k);
      const Eigen::Vector2d velocity =
          free.segment<2>(k + 1) + compliance_.middleRows<2>(k + 1) * f;
      // Without slip friction is what stops it, unless that is more than there can be.
      const double softness =
          std::max({0.0, -compliance_(k + 1, k + 1), -compliance_(k + 2, k + 2)});
      const Eigen::Vector2d trial = softness * f.segment<2>(k + 1) + velocity;
      const double size = trial.norm();
      if (size > softness * limit) {
        f.segment<2>(k + 1) = limit / size * trial;
      } else if (softness > 0.0) {
        f.segment<2>(k + 1) = trial / softness;
      }
      change = std::max(change, (f.segment<3>(k) - last).cwiseAbs().maxCoeff());
      largest = std::max(largest, f(k));
    }
    has_converged = change <= tolerance * largest;
  }
  relative_ = free + compliance_ * f;
  remainder_ = f - linear_forces(relative_);
  return has_converged;
}

FaceContactState FaceContactMotion::contact(int index) const {
  const Eigen::Index k = per_contact * index;
  FaceContactState state;
  state.gap = relative_(k);
  state.force = forces_(k);
  state.friction_force = forces_(k + 1);
  state.across_force = forces_(k + 2);
  state.slip_velocity = relative_.segment<2>(k + 1).norm();
  constexpr double still = 1e-9;  // of the velocity of sliding
  const double sliding = law_.speed * contacts_[static_cast<std::size_t>(index)].radius;
  const bool sticks = law_.friction > 0.0 && state.slip_velocity <= still * sliding;
  state.state = !(state.force > 0.0) ? ContactState::open
                : sticks             ? ContactState::stick
                                     : ContactState::slip;
  return state;
}

}  // namespace stridor
