#include "solvers/spring_contact_motion.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

const FaceContactLaw& checked(const FaceContactLaw& law) {
  if (!law.penalty || !(law.speed > 0.0)) {
    throw std::invalid_argument(
        "motion of face contacts: takes contacts with a penalty, and a plate that turns");
  }
  return law;
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
  const Eigen::MatrixXd moved = normal_answer(closed, state, [step](double omega) {
    const double angle = omega * step;
    return angle > 1e-4 ? (1.0 - least_sine_ratio(angle)) / (omega * omega) : step * step / 6.0;
  });
  const Eigen::MatrixXd share =
      Eigen::MatrixXd::Identity(moved.rows(), moved.cols()) - penalty * moved;
  if (is_positive_definite(share)) return;
  throw std::invalid_argument(fmt::format(
      "motion of face contacts: a step of {:g} s is too long for contacts as stiff as these",
      step));
}

}  // namespace

SpringContactMotion::SpringContactMotion(const LinearSystem& bodies,
                                         std::vector<FaceContact> contacts,
                                         const FaceContactLaw& law, const FaceSlidingState& state,
                                         double step)
    : contacts_(std::move(contacts)),
      law_(checked(law)),
      rows_(bodies, contacts_, law_, state),
      propagator_(linearise(bodies, contacts_, law_, state), step),
      solver_(law_, rows_.preload.cwiseAbs().maxCoeff()) {
  const Eigen::Index n = bodies.size();
  const Eigen::Index m = rows_.drive.size();
  const double penalty = *law_.penalty;
  check_step(linearise(bodies, contacts_, law_, state), state, penalty, step);
  linear_ = Eigen::MatrixXd::Zero(m, m);
  for (Eigen::Index k = 0; k < m; k += 3) {
    const FaceContactPoint& point = state.contacts[static_cast<std::size_t>(k / 3)];
    if (!point.is_closed) continue;
    linear_(k, k) = -penalty;
    linear_.block<2, 1>(k + 1, k) = -penalty * law_.friction * point.direction;
    linear_.block<2, 2>(k + 1, k + 1) = turning_resistance(law_, point);
  }
  const Eigen::MatrixXd& response = propagator_.slope_response();
  const auto seen = [&](const Eigen::MatrixXd& answer) -> Eigen::MatrixXd {
    return rows_.displacement * answer.topRows(n) + rows_.velocity * answer.bottomRows(n);
  };
  answer_ = response * rows_.inputs;
  bare_ = seen(answer_);
  answering_ = (Eigen::MatrixXd::Identity(m, m) + bare_ * linear_).inverse();
  at_end_.compliance = answering_ * bare_;
  if (rows_.bends()) {  // BLAS takes no empty matrices
    bending_answer_ = response * rows_.bending_inputs;
    bending_bare_ = seen(bending_answer_);
  }
  start(Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n));
}

/// Gap and velocities, as far as they are linear, from those of the sliding state.
Eigen::VectorXd SpringContactMotion::relative(const Eigen::VectorXd& q,
                                              const Eigen::VectorXd& v) const {
  return rows_.displacement * q + rows_.velocity * v;
}

Eigen::VectorXd SpringContactMotion::linear_forces(const Eigen::VectorXd& relative) const {
  return rows_.preload + linear_ * relative;
}

/// What the forces of this instant do by bending, at a displacement; those of the sliding state are
/// in the linear part.
void SpringContactMotion::bend(const Eigen::VectorXd& displacement) {
  if (!rows_.bends()) return;
  gap_bending_ = rows_.gap_bending(displacement);
  bending_ = rows_.bending(forces_ - rows_.preload, displacement);
}

void SpringContactMotion::start(const Eigen::VectorXd& displacement,
                                const Eigen::VectorXd& velocity) {
  q_ = displacement;
  v_ = velocity;
  relative_ = relative(q_, v_);
  forces_ = linear_forces(relative_);
  gap_bending_ = rows_.gap_bending(q_);
  for (Eigen::Index k = 0; k < forces_.size(); k += 3) {
    const double gap = rows_.drive(k) + relative_(k) + gap_bending_(k / 3);
    forces_(k) = std::max(0.0, -*law_.penalty * gap);
    const Eigen::Vector2d v_face = rows_.drive.segment<2>(k + 1) + relative_.segment<2>(k + 1);
    const double speed = v_face.norm();
    const double limit = law_.friction * forces_(k);
    if (speed > 0.0) forces_.segment<2>(k + 1) = limit / speed * v_face;
  }
  bend(q_);
  remainder_ = forces_ - linear_forces(relative_);
}

bool SpringContactMotion::step() {
  constexpr int max_repeats = 100;
  const Eigen::Index n = q_.size();
  const bool bends = rows_.bends();
  Eigen::VectorXd before = rows_.inputs * remainder_;
  if (bends) before += rows_.bending_inputs * bending_;
  propagator_.advance(q_, v_, before, Eigen::VectorXd::Zero(n));
  const Eigen::VectorXd predicted = relative(q_, v_);
  Eigen::VectorXd change;
  bool has_converged = false;
  for (int repeat = 0; repeat < max_repeats && !has_converged; ++repeat) {
    if (!solve(bends ? predicted + bending_bare_ * bending_ : predicted)) return false;
    change = answer_ * remainder_;
    if (!bends) break;
    change += bending_answer_ * bending_;
    const Eigen::VectorXd gap_before = gap_bending_;
    const Eigen::VectorXd bending_before = bending_;
    bend(q_ + change.head(n));
    const double largest =
        std::max(forces_.cwiseAbs().maxCoeff(), rows_.preload.cwiseAbs().maxCoeff());
    const double gap_change = (gap_bending_ - gap_before).lpNorm<Eigen::Infinity>();
    const double force_change = (bending_ - bending_before).lpNorm<Eigen::Infinity>();
    has_converged = *law_.penalty * gap_change + force_change <= solver_.tolerance * largest;
  }
  q_ += change.head(n);
  v_ += change.tail(n);
  return (has_converged || !bends) && std::isfinite(q_.squaredNorm() + v_.squaredNorm());
}

/// Forces at the end of a step.
/// @param predicted what is linear of gap and velocities there, without any remainder
bool SpringContactMotion::solve(const Eigen::VectorXd& predicted) {
  const Eigen::VectorXd linear = answering_ * (predicted - bare_ * rows_.preload);
  at_end_.free = rows_.drive + linear;
  for (Eigen::Index i = 0; i < gap_bending_.size(); ++i) at_end_.free(3 * i) += gap_bending_(i);
  const bool has_converged = solver_.solve(at_end_, forces_);
  relative_ = linear + at_end_.compliance * forces_;
  remainder_ = forces_ - linear_forces(relative_);
  return has_converged;
}

FaceContactState SpringContactMotion::contact(int index) const {
  const Eigen::Index k = 3 * index;
  Eigen::Vector3d seen = rows_.drive.segment<3>(k) + relative_.segment<3>(k);
  seen(0) += gap_bending_(index);
  return face_contact_state(law_, contacts_[static_cast<std::size_t>(index)], seen,
                            forces_.segment<3>(k));
}

void SpringContactMotion::save(State& state, const std::string& prefix) const {
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

void SpringContactMotion::load(const State& state, const std::string& prefix) {
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
