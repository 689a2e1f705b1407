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

/// Gap at the end of a step and mean velocities over it, from the ports at its end.
std::vector<FaceContactPorts::LocalRows> mean_rows(const FaceContactPorts& ports, double step) {
  std::vector<FaceContactPorts::LocalRows> mean;
  for (int i = 0; i < ports.num_contacts(); ++i) {
    mean.push_back(ports.velocity(i) / step + 0.5 * ports.displacement(i));
    mean.back().row(0) = ports.displacement(i).row(0);
  }
  return mean;
}

/// The same from the ports at its beginning.
std::vector<FaceContactPorts::LocalRows> now_rows(const FaceContactPorts& ports, double step) {
  std::vector<FaceContactPorts::LocalRows> now;
  for (int i = 0; i < ports.num_contacts(); ++i) {
    now.push_back(-ports.velocity(i) / step + 0.5 * ports.displacement(i));
    now.back().row(0).setZero();
  }
  return now;
}

}  // namespace

class RigidContactMotion::Answer final : public FaceContactAnswer {
 public:
  /// @param share of the impulse that is still to come
  /// @param free  ports at t_{n+1} without it
  /// @param lag   slip_lag()
  Answer(const RigidContactMotion& motion, double share, const Eigen::VectorXd& free,
         const Eigen::VectorXd& lag)
      : motion_(motion), share_(share), free_(free), compliance_(&motion.compliance_) {
    if (share != 1.0) {
      scaled_ = share * motion.compliance_;
      compliance_ = &scaled_;
    }
    const FaceContactPorts& ports = motion.ports_;
    known_ = ports.drive() - lag;
    for (int i = 0; i < ports.num_contacts(); ++i) {
      const auto index = static_cast<std::size_t>(i);
      known_.segment<3>(3 * i) += motion.now_[index] * ports.of(i, motion.y_.data()) +
                                  motion.mean_[index] * ports.of(i, free.data());
    }
    force_ = moved_ = y_ = Eigen::VectorXd::Zero(free.size());
  }

  double see(const double* forces, double* seen) override {
    const FaceContactPorts& ports = motion_.ports_;
    motion_.port_forces(forces, force_.data());
    force_ *= share_;
    moved_.setZero();
    motion_.port_answer_.add_product(force_.data(), moved_.data());
    y_ = free_ + moved_;
    // What forces move is so little in a short step that it would be lost in the rounding of y.
    for (int i = 0; i < ports.num_contacts(); ++i) {
      Eigen::Map<Eigen::Vector3d> sees(seen + 3 * i);
      sees = known_.segment<3>(3 * i) +
             motion_.mean_[static_cast<std::size_t>(i)] * ports.of(i, moved_.data());
      sees(0) += ports.gap_bending(i, ports.of(i, y_.data()));
    }
    return 0.0;
  }
  const Compliance& compliance() const override { return *compliance_; }

 private:
  const RigidContactMotion& motion_;
  double share_;
  Eigen::VectorXd free_;
  const Compliance* compliance_;
  Compliance scaled_;
  Eigen::VectorXd known_;  ///< seen without the impulse
  Eigen::VectorXd force_, moved_, y_;
};

RigidContactMotion::RigidContactMotion(const LinearSystem& bodies,
                                       std::vector<FaceContact> contacts, const FaceContactLaw& law,
                                       const FaceSlidingState& state, double step)
    : contacts_(std::move(contacts)),
      law_(checked(law)),
      ports_(contacts_, law_, state),
      propagator_(bodies, step),
      solver_(law_, ports_.preload().cwiseAbs().maxCoeff()),
      mean_(mean_rows(ports_, step)),
      now_(now_rows(ports_, step)) {
  check_compliance(bodies, state, step);
  const Eigen::Index n = bodies.size();
  const DecoupledSystem& apart = propagator_.apart();
  const Eigen::MatrixXd rows = ports_.rows() * apart.motion;
  const Eigen::MatrixXd impulse = step * apart.system.mass.inverse();
  const Eigen::MatrixXd z_answer = propagator_.z_by_v().dense() * impulse;
  const Eigen::MatrixXd port_answer = rows * z_answer * rows.transpose();
  rows_ = PortRows(rows);
  impulse_ = GroupDiagonal(impulse, apart.groups);
  z_answer_ = GroupDiagonal(z_answer, apart.groups);
  v_answer_ = GroupDiagonal(propagator_.v_by_v().dense() * impulse, apart.groups);
  port_answer_ = PaddedMatrix(port_answer);
  compliance_ = ports_.placed(mean_) * port_answer * ports_.inputs();
  preload_ports_ = ports_.inputs() * ports_.preload();
  check_growth(bodies, state, step,
               propagator_.free_response().rightCols(n) * (step * bodies.mass.inverse()));
  directions_.resize(static_cast<std::size_t>(num_contacts()));
  for (Eigen::VectorXd* values : {&z_, &v_, &next_z_, &next_v_, &modal_force_})
    values->setZero(static_cast<Eigen::Index>(padded_size(n)));
  for (Eigen::VectorXd* values : {&y_, &next_y_, &port_force_})
    values->setZero(static_cast<Eigen::Index>(padded_size(ports_.num_ports())));
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
  const Eigen::MatrixXd mean_rows = ports_.placed(mean_) * ports_.rows();
  const Eigen::MatrixXd now_rows = ports_.placed(now_) * ports_.rows();
  const Eigen::MatrixXd inputs = ports_.rows().transpose() * ports_.inputs();
  Eigen::MatrixXd U(n, 3 * k), gaps(k, n), mean(2 * k, n), now(2 * k, n);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(2 * k, 2 * k);
  for (Eigen::Index j = 0; j < k; ++j) {
    const Eigen::Index i = closed[static_cast<std::size_t>(j)];
    const FaceContact& contact = contacts_[static_cast<std::size_t>(i)];
    const FaceContactPoint& point = state.contacts[static_cast<std::size_t>(i)];
    U.col(j) = unit_force(contact, law_, point);
    U.middleCols<2>(k + 2 * j) = inputs.middleCols<2>(3 * i + 1);
    gaps.row(j) = mean_rows.row(3 * i);
    mean.middleRows<2>(2 * j) = mean_rows.middleRows<2>(3 * i + 1);
    now.middleRows<2>(2 * j) = now_rows.middleRows<2>(3 * i + 1);
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
  const Eigen::Index n = propagator_.size();
  z_.head(n) = propagator_.apart().inverse * displacement;
  v_.head(n) = propagator_.apart().inverse * velocity;
  rows_.gather(z_.data(), y_.data());
  Eigen::VectorXd rates = y_;
  rows_.gather(v_.data(), rates.data());
  forces_ = ports_.preload();
  ahead_ = ports_.drive();
  for (int i = 0; i < num_contacts(); ++i) {
    const FaceContactPorts::Local y = ports_.of(i, y_.data());
    ahead_.segment<3>(3 * i) +=
        ports_.displacement(i) * y + ports_.velocity(i) * ports_.of(i, rates.data());
    ahead_(3 * i) += ports_.gap_bending(i, y);
  }
  before_ = ahead_;
  // Half of the first impulse comes before t = 0: the velocity there is that in its middle.
  solver_.forget();
  has_converged_ = solve(0.5);
  solver_.forget();
  v_ -= half_impulse();
}

bool RigidContactMotion::step() {
  if (!has_converged_) return false;
  z_.swap(next_z_);
  v_.swap(next_v_);
  rows_.gather(z_.data(), y_.data());
  has_converged_ = solve(1.0);
  return has_converged_ && std::isfinite(z_.squaredNorm() + v_.squaredNorm());
}

/// f_n and the motion until t_{n+1}, from that at t_n before the impulse.
/// @param share of the impulse that is still to come
bool RigidContactMotion::solve(double share) {
  propagator_.advance(z_.data(), v_.data(), next_z_.data(), next_v_.data());
  rows_.gather(next_z_.data(), next_y_.data());
  const Eigen::VectorXd lag = slip_lag();
  before_ = ahead_;
  point_forces();
  Answer answer(*this, share, next_y_, lag);
  if (!solver_.solve(answer, forces_)) return false;
  slip_.resize(forces_.size());
  slip_ = solver_.seen();
  ahead_ = slip_ + lag;
  port_forces(forces_.data(), port_force_.data());
  port_force_ *= share;
  rows_.scatter(port_force_.data(), modal_force_.data());
  z_answer_.add_product(modal_force_.data(), next_z_.data());
  v_answer_.add_product(modal_force_.data(), next_v_.data());
  return true;
}

/// Forces act in the directions that contacts have at t_n.
void RigidContactMotion::point_forces() {
  for (int i = 0; i < num_contacts(); ++i) {
    FaceContactPorts::LocalColumns& directions = directions_[static_cast<std::size_t>(i)];
    directions = ports_.inputs(i);
    if (!ports_.bends()) continue;
    const FaceContactPorts::Local y = ports_.of(i, y_.data());
    directions.col(0) += ports_.normal_turn(i, y);
    directions.col(1) += ports_.friction_turn(i, y);
  }
}

/// R ΔF_n: what forces and those of the sliding state differ by, on the ports.
void RigidContactMotion::port_forces(const double* forces, double* ports) const {
  std::fill_n(ports, padded_size(ports_.num_ports()), 0.0);
  for (int i = 0; i < num_contacts(); ++i) {
    const Eigen::Map<const Eigen::Vector3d> f(forces + 3 * i);
    ports_.add(i, directions_[static_cast<std::size_t>(i)] * f, ports);
  }
  Eigen::Map<Eigen::VectorXd>(ports, ports_.num_ports()) -= preload_ports_;
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

/// ½ h M⁻¹ ΔF_n, of z.
Eigen::VectorXd RigidContactMotion::half_impulse() const {
  Eigen::VectorXd ports = y_, force = z_;
  port_forces(forces_.data(), ports.data());
  rows_.scatter(ports.data(), force.data());
  Eigen::VectorXd impulse = Eigen::VectorXd::Zero(force.size());
  impulse_.add_product(force.data(), impulse.data());
  return 0.5 * impulse;
}

Eigen::VectorXd RigidContactMotion::displacement() const {
  return propagator_.apart().motion * z_.head(propagator_.size());
}

Eigen::VectorXd RigidContactMotion::velocity() const {
  return propagator_.apart().motion * (v_ + half_impulse()).head(propagator_.size());
}

FaceContactState RigidContactMotion::contact(int index) const {
  const Eigen::Index k = 3 * index;
  const Eigen::Vector3d seen(before_(k), slip_(k + 1), slip_(k + 2));
  return face_contact_state(law_, contacts_[static_cast<std::size_t>(index)], seen,
                            forces_.segment<3>(k));
}

void RigidContactMotion::save(State& state, const std::string& prefix) const {
  const auto put = [&](const char* name, const Eigen::VectorXd& values, Eigen::Index size) {
    state.put(prefix + name, {values.data(), static_cast<std::size_t>(size)});
  };
  const Eigen::Index n = propagator_.size();
  put("displacement", z_, n);
  put("velocity", v_, n);
  put("forces", forces_, forces_.size());
  put("next_displacement", next_z_, n);
  put("next_velocity", next_v_, n);
  put("before", before_, before_.size());
  put("ahead", ahead_, ahead_.size());
  put("slip", slip_, slip_.size());
  solver_.save(state, prefix + "solver/");
}

void RigidContactMotion::load(const State& state, const std::string& prefix) {
  const auto get = [&](const char* name, Eigen::VectorXd& values, Eigen::Index size) {
    state.get(prefix + name, {values.data(), static_cast<std::size_t>(size)});
  };
  const Eigen::Index n = propagator_.size();
  get("displacement", z_, n);
  get("velocity", v_, n);
  get("forces", forces_, forces_.size());
  get("next_displacement", next_z_, n);
  get("next_velocity", next_v_, n);
  get("before", before_, before_.size());
  get("ahead", ahead_, ahead_.size());
  get("slip", slip_, slip_.size());
  solver_.load(state, prefix + "solver/");
  rows_.gather(z_.data(), y_.data());
  point_forces();
  has_converged_ = true;
}

}  // namespace stridor
