#include "solvers/rigid_contact_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "solvers/dense_eigenvalues.hpp"
#include "solvers/linear_pencil.hpp"

namespace stridor {
namespace {

const FaceContactLaw& checked(const FaceContactLaw& law) {
  if (law.penalty || !(law.speed > 0.0)) {
    throw std::invalid_argument(
        "motion of rigid face contacts: takes no penalty, and a plate that turns");
  }
  return law;
}

/// Impulses of closed contacts are to push them apart: Σ φ φᵀ h² sin(ω h)/(ω h) of the modes of the
/// bodies is positive definite. No longer step is better.
void check_compliance(const LinearSystem& bodies, const FaceSlidingState& state, double step) {
  const Eigen::MatrixXd moved =
      normal_answer(bodies, state, [step](double omega) { return least_sine_ratio(omega * step); });
  if (is_positive_definite(moved)) return;
  throw std::invalid_argument(fmt::format(
      "motion of rigid face contacts: a step of {:g} s is too long for bodies as stiff as these",
      step));
}

}  // namespace

RigidContactMotion::RigidContactMotion(const LinearSystem& bodies,
                                       std::vector<FaceContact> contacts, const FaceContactLaw& law,
                                       const FaceSlidingState& state, double step)
    : contacts_(std::move(contacts)),
      law_(checked(law)),
      rows_(bodies, contacts_, law_, state),
      propagator_(bodies, step),
      solver_(law_, rows_.preload.cwiseAbs().maxCoeff()) {
  check_compliance(bodies, state, step);
  const Eigen::Index n = bodies.size();
  impulse_ = step * bodies.mass.inverse();
  mean_rows_ = rows_.velocity / step + 0.5 * rows_.displacement;
  now_rows_ = -rows_.velocity / step + 0.5 * rows_.displacement;
  for (Eigen::Index k = 0; k < mean_rows_.rows(); k += 3) {
    mean_rows_.row(k) = rows_.displacement.row(k);
    now_rows_.row(k).setZero();
  }
  const Eigen::MatrixXd after = propagator_.free_response().rightCols(n) * impulse_;
  answer_ = after * rows_.inputs;
  seen_ = mean_rows_ * answer_.topRows(n);
  if (rows_.bends()) {  // BLAS takes no empty matrices
    bending_answer_ = after * rows_.bending_inputs;
    bending_seen_ = mean_rows_ * bending_answer_.topRows(n);
  }
  preload_answer_ = answer_ * rows_.preload;
  check_growth(bodies, state, step, after);
  forces_ = rows_.preload;
  start(Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n));
}

/// The step as a linear map of (x, ẋ, mean velocities of the last two steps) about the sliding
/// state, closed contacts closed.
/// @param after (x, ẋ) at t_{n+1} per generalised force at t_n
Eigen::MatrixXd RigidContactMotion::linear_step(const FaceSlidingState& state,
                                                const Eigen::MatrixXd& after) const {
  std::vector<Eigen::Index> closed;
  for (std::size_t i = 0; i < state.contacts.size(); ++i)
    if (state.contacts[i].is_closed) closed.push_back(static_cast<Eigen::Index>(i));
  const auto k = static_cast<Eigen::Index>(closed.size());
  const Eigen::Index n = after.cols();
  const Eigen::Index size = 2 * n + 4 * k;
  // ΔF = U z + C x of z = (λ, τ) - those of the sliding state, and of forces that bend.
  Eigen::MatrixXd U(n, 3 * k), gaps(k, n), mean(2 * k, n), now(2 * k, n);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(2 * k, 2 * k);
  for (Eigen::Index j = 0; j < k; ++j) {
    const Eigen::Index i = closed[static_cast<std::size_t>(j)];
    const FaceContact& contact = contacts_[static_cast<std::size_t>(i)];
    const FaceContactPoint& point = state.contacts[static_cast<std::size_t>(i)];
    U.col(j) = unit_force(contact, law_, point);
    U.middleCols<2>(k + 2 * j) = rows_.inputs.middleCols<2>(3 * i + 1);
    gaps.row(j) = mean_rows_.row(3 * i);
    mean.middleRows<2>(2 * j) = mean_rows_.middleRows<2>(3 * i + 1);
    now.middleRows<2>(2 * j) = now_rows_.middleRows<2>(3 * i + 1);
    D.block<2, 2>(2 * j, 2 * j) = turning_resistance(law_, point);
    if (!law_.forces_bend) continue;
    C += contact.bending_forces() *
         (point.force * contact.normal_bending() +
          law_.friction * point.force * point.direction.x() * contact.friction_bending());
  }
  Eigen::MatrixXd free = Eigen::MatrixXd::Zero(2 * n, size);
  free.leftCols(2 * n) = propagator_.free_response();
  free.leftCols(n) += after * C;
  Eigen::MatrixXd slips = mean * free.topRows(n);
  slips.leftCols(n) += now;
  // N x_{n+1} = 0 and τ = D (v - ½ (v₁ - v₂)) give z.
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(3 * k, 3 * k);
  Eigen::MatrixXd known = Eigen::MatrixXd::Zero(3 * k, size);
  const Eigen::MatrixXd moved = after.topRows(n) * U;
  equations.topRows(k) = gaps * moved;
  equations.bottomRows(2 * k) = -D * (mean * moved);
  equations.bottomRightCorner(2 * k, 2 * k) += Eigen::MatrixXd::Identity(2 * k, 2 * k);
  known.topRows(k) = -gaps * free.topRows(n);
  known.bottomRows(2 * k) = D * slips;
  known.block(k, 2 * n, 2 * k, 2 * k) -= 0.5 * D;
  known.block(k, 2 * n + 2 * k, 2 * k, 2 * k) += 0.5 * D;
  const Eigen::MatrixXd z = equations.partialPivLu().solve(known);
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(size, size);
  map.topRows(2 * n) = free + after * U * z;
  map.middleRows(2 * n, 2 * k) = slips + mean * moved * z;
  map.block(2 * n + 2 * k, 2 * n, 2 * k, 2 * k).setIdentity();
  return map;
}

/// Small motion must not grow in steps as it does not by itself.
void RigidContactMotion::check_growth(const LinearSystem& bodies, const FaceSlidingState& state,
                                      double step, const Eigen::MatrixXd& after) const {
  double growth = 0.0;
  double lowest = std::numeric_limits<double>::infinity();
  const LinearSystem closed = linearise(bodies, contacts_, law_, state);
  const bool nothing_moves = closed.gaps.rows() == closed.size();
  if (closed.gaps.rows() == 0 || nothing_moves) return;  // free motion is exact
  for (const Eigenvalue& eigenvalue : dense_eigenvalues(make_pencil(closed))) {
    growth = std::max(growth, eigenvalue.growth());
    if (eigenvalue.s.imag() > 0.0) lowest = std::min(lowest, std::abs(eigenvalue.s));
  }
  constexpr double accuracy = 0.01;  // of the lowest frequency
  Eigen::MatrixXd map = linear_step(state, after);
  // All in velocities, or rounding is amplified.
  map.topRows(bodies.size()) /= step;
  map.leftCols(bodies.size()) *= step;
  const double radius =
      Eigen::EigenSolver<Eigen::MatrixXd>(map, false).eigenvalues().cwiseAbs().maxCoeff();
  if (std::log(radius) / step <= growth + accuracy * lowest) return;
  throw std::invalid_argument(fmt::format(
      "motion of rigid face contacts: with a step of {:g} s small motion grows with {:g} 1/s, by "
      "itself with {:g}",
      step, std::log(radius) / step, growth));
}

void RigidContactMotion::start(const Eigen::VectorXd& displacement,
                               const Eigen::VectorXd& velocity) {
  q_ = displacement;
  v_ = velocity;
  forces_ = rows_.preload;
  ahead_ = rows_.drive + rows_.displacement * q_ + rows_.velocity * v_;
  const Eigen::VectorXd bent = rows_.gap_bending(q_);
  for (Eigen::Index i = 0; i < bent.size(); ++i) ahead_(3 * i) += bent(i);
  before_ = ahead_;
  // Half of the first impulse comes before t = 0: the velocity there is that in its middle.
  has_converged_ = solve(0.5);
  v_ -= 0.5 * impulse_ * deviation();
}

bool RigidContactMotion::step() {
  if (!has_converged_) return false;
  q_ = next_q_;
  v_ = next_v_;
  has_converged_ = solve(1.0);
  return has_converged_ && std::isfinite(q_.squaredNorm() + v_.squaredNorm());
}

/// f_n and the motion until t_{n+1}, from that at t_n before the impulse.
/// @param share of the impulse that is still to come
bool RigidContactMotion::solve(double share) {
  constexpr int max_repeats = 100;
  const bool bends = rows_.bends();
  next_q_ = q_;
  next_v_ = v_;
  propagator_.advance(next_q_, next_v_);
  const Eigen::Index n = q_.size();
  next_q_ -= share * preload_answer_.head(n);
  next_v_ -= share * preload_answer_.tail(n);
  const Eigen::VectorXd lag = slip_lag();
  before_ = ahead_;
  at_end_.compliance = share * seen_;
  if (bends) bend_compliance(share);
  const Eigen::VectorXd free = rows_.drive + mean_rows_ * next_q_ + now_rows_ * q_ - lag;
  at_end_.free = free;
  Eigen::VectorXd gap_bending = Eigen::VectorXd::Zero(num_contacts());
  Eigen::VectorXd change;
  bool has_converged = false;
  for (int repeat = 0; repeat < max_repeats && !has_converged; ++repeat) {
    if (!solver_.solve(at_end_, forces_)) return false;
    change = share * (answer_ * forces_);
    if (!bends) break;
    change += share * (bending_answer_ * rows_.bending(forces_, q_));
    const Eigen::VectorXd bent = rows_.gap_bending(next_q_ + change.head(n));
    has_converged = true;
    for (Eigen::Index i = 0; i < bent.size(); ++i) {
      const double least = solver_.tolerance * at_end_.compliance(3 * i, 3 * i) * largest_force();
      has_converged = has_converged && std::abs(bent(i) - gap_bending(i)) <= least;
      at_end_.free(3 * i) = free(3 * i) + bent(i);
    }
    gap_bending = bent;
  }
  next_q_ += change.head(n);
  next_v_ += change.tail(n);
  slip_ = at_end_.free + at_end_.compliance * forces_;
  ahead_ = slip_ + lag;
  return has_converged || !bends;
}

/// How much of the mean velocity over the coming step belongs to the time after t_n: half of what
/// it changes by from step to step. That is known from the two steps before as long as the change
/// is steady; where sliding ends or turns round it is left out.
Eigen::VectorXd RigidContactMotion::slip_lag() const {
  constexpr double steady = 0.5;
  Eigen::VectorXd lag = Eigen::VectorXd::Zero(ahead_.size());
  for (Eigen::Index k = 0; k < lag.size(); k += 3) {
    const Eigen::Vector2d change = (ahead_ - before_).segment<2>(k + 1);
    if (change.norm() <= steady * ahead_.segment<2>(k + 1).norm())
      lag.segment<2>(k + 1) = 0.5 * change;
  }
  return lag;
}

double RigidContactMotion::largest_force() const {
  return std::max(forces_.cwiseAbs().maxCoeff(), rows_.preload.cwiseAbs().maxCoeff());
}

/// Forces act in the directions that contacts have at t_n.
void RigidContactMotion::bend_compliance(double share) {
  constexpr Eigen::Index each = FaceContact::num_bending;
  const Eigen::VectorXd normal = rows_.normal_bending * q_;
  const Eigen::VectorXd friction = rows_.friction_bending * q_;
  for (Eigen::Index i = 0; i < num_contacts(); ++i) {
    const auto seen = bending_seen_.middleCols(each * i, each);
    at_end_.compliance.col(3 * i) += share * (seen * normal.segment<each>(each * i));
    at_end_.compliance.col(3 * i + 1) += share * (seen * friction.segment<each>(each * i));
  }
}

/// ΔF_n.
Eigen::VectorXd RigidContactMotion::deviation() const {
  Eigen::VectorXd sum = rows_.inputs * (forces_ - rows_.preload);
  if (rows_.bends()) sum += rows_.bending_inputs * rows_.bending(forces_, q_);
  return sum;
}

Eigen::VectorXd RigidContactMotion::velocity() const {
  return v_ + 0.5 * impulse_ * deviation();
}

FaceContactState RigidContactMotion::contact(int index) const {
  const Eigen::Index k = 3 * index;
  const Eigen::Vector3d seen(before_(k), slip_(k + 1), slip_(k + 2));
  return face_contact_state(law_, contacts_[static_cast<std::size_t>(index)], seen,
                            forces_.segment<3>(k));
}

void RigidContactMotion::save(State& state, const std::string& prefix) const {
  const auto put = [&](const char* name, const Eigen::VectorXd& values) {
    state.put(prefix + name, {values.data(), static_cast<std::size_t>(values.size())});
  };
  put("displacement", q_);
  put("velocity", v_);
  put("forces", forces_);
  put("next_displacement", next_q_);
  put("next_velocity", next_v_);
  put("before", before_);
  put("ahead", ahead_);
  put("slip", slip_);
}

void RigidContactMotion::load(const State& state, const std::string& prefix) {
  const auto get = [&](const char* name, Eigen::VectorXd& values) {
    state.get(prefix + name, {values.data(), static_cast<std::size_t>(values.size())});
  };
  get("displacement", q_);
  get("velocity", v_);
  get("forces", forces_);
  get("next_displacement", next_q_);
  get("next_velocity", next_v_);
  get("before", before_);
  get("ahead", ahead_);
  get("slip", slip_);
  has_converged_ = true;
}

}  // namespace stridor
