#include "solvers/spring_contact_motion.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

const FaceContactLaw& checked_for_springs(const FaceContactLaw& law) {
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

namespace {

/// A over B of a contact on its ports.
Eigen::MatrixXd turns_of(const FaceContactPorts& ports, int contact) {
  constexpr int size = FaceContactPorts::per_contact;
  Eigen::MatrixXd turns(2 * size, size);
  for (int j = 0; j < size; ++j) {
    const FaceContactPorts::Local unit = FaceContactPorts::Local::Unit(j);
    turns.col(j) << ports.normal_turn(contact, unit), ports.friction_turn(contact, unit);
  }
  return turns;
}

}  // namespace

class SpringContactMotion::Answer final : public FaceContactAnswer {
 public:
  /// @param scratch with the ports and their rates at the end of a step without forces there, and
  ///                the ports expected
  Answer(const SpringContactMotion& motion, Scratch& scratch) : motion_(motion), of_(scratch) {
    motion.set_relative(of_.free_y, of_.free_rates, of_.relative);
    of_.free.setZero();
    motion.answering_.add_product(of_.relative.data(), of_.free.data());
    of_.bending.setZero();
    of_.gap_bending.setZero();
    if (!motion.ports_.bends()) return;
    motion.set_turns(of_.y.data(), of_.turns.data());
  }

  /// The bending is that of the ports when last asked.
  double see(const double* forces, double* seen) override {
    const FaceContactPorts& ports = motion_.ports_;
    const Eigen::Index size = motion_.forces_.size();
    of_.change = Eigen::Map<const Eigen::VectorXd>(forces, size) - ports.preload();
    double unsettled = 0.0;
    of_.relative = of_.free;
    motion_.force_answer_.add_product(of_.change.data(), of_.relative.data());
    if (ports.bends()) {
      unsettled = bend();
      motion_.bending_answer_.add_product(of_.bending.data(), of_.relative.data());
    }
    of_.port_force = of_.bending;
    motion_.add_inputs(of_.change, of_.relative, of_.port_force.data());
    of_.y = of_.free_y;
    motion_.port_answer_.add_product(of_.port_force.data(), of_.y.data());
    Eigen::Map<Eigen::VectorXd> sees(seen, size);
    sees = ports.drive() + of_.relative.head(size);
    if (!ports.bends()) return unsettled;
    motion_.set_turns(of_.y.data(), of_.turns.data());
    double gap_change = 0.0;
    for (int i = 0; i < motion_.num_contacts(); ++i) {
      const double bent = motion_.gap_bending(i, of_.y.data(), of_.turns.data());
      gap_change = std::max(gap_change, std::abs(bent - of_.gap_bending(i)));
      of_.gap_bending(i) = bent;
      sees(3 * i) += bent;
    }
    return unsettled + *motion_.law_.penalty * gap_change;
  }
  const Compliance& compliance() const override { return motion_.compliance_; }

 private:
  /// @return the largest change of a force on a pad
  double bend() {
    const FaceContactPorts& ports = motion_.ports_;
    of_.last_bending.swap(of_.bending);
    of_.bending.setZero();
    motion_.add_bending(of_.change.data(), of_.turns.data(), of_.bending.data());
    double largest = 0.0;
    for (int i = 0; i < motion_.num_contacts(); ++i)
      for (const FacePort port : {FacePort::pad_r, FacePort::pad_phi, FacePort::pad_z}) {
        largest = std::max(largest, std::abs(ports.at(i, port, of_.bending.data()) -
                                             ports.at(i, port, of_.last_bending.data())));
      }
    return largest;
  }

  const SpringContactMotion& motion_;
  Scratch& of_;
};

SpringContactMotion::SpringContactMotion(const LinearSystem& bodies,
                                         std::vector<FaceContact> contacts,
                                         const FaceContactLaw& law, const FaceSlidingState& state,
                                         double step)
    : contacts_(std::move(contacts)),
      law_(checked_for_springs(law)),
      ports_(contacts_, law_, state),
      propagator_(linearise(bodies, contacts_, law_, state), step),
      solver_(law_, ports_.preload().cwiseAbs().maxCoeff()) {
  const Eigen::Index n = bodies.size();
  const Eigen::Index m = 3 * num_contacts();
  const double penalty = *law_.penalty;
  check_step(linearise(bodies, contacts_, law_, state), state, penalty, step);
  Eigen::MatrixXd linear = Eigen::MatrixXd::Zero(m, m);
  std::vector<FaceContactPorts::LocalRows> displacement, velocity;
  for (int i = 0; i < num_contacts(); ++i) {
    const FaceContactPoint& point = state.contacts[static_cast<std::size_t>(i)];
    displacement.push_back(ports_.displacement(i));
    velocity.push_back(ports_.velocity(i));
    linear_.push_back(Eigen::Matrix3d::Zero());
    if (!point.is_closed) continue;
    linear_.back()(0, 0) = -penalty;
    linear_.back().bottomLeftCorner<2, 1>() = -penalty * law_.friction * point.direction;
    linear_.back().bottomRightCorner<2, 2>() = turning_resistance(law_, point);
    linear.block<3, 3>(3 * i, 3 * i) = linear_.back();
  }
  const Eigen::MatrixXd& R = ports_.rows();
  const Eigen::MatrixXd slope = propagator_.slope_response() * R.transpose();
  const Eigen::MatrixXd fall = propagator_.constant_response() * R.transpose() - slope;
  const Eigen::MatrixXd answer = ports_.placed(displacement) * (R * slope.topRows(n)) +
                                 ports_.placed(velocity) * (R * slope.bottomRows(n));
  const Eigen::MatrixXd bare = answer * ports_.inputs();
  const Eigen::MatrixXd answering = (Eigen::MatrixXd::Identity(m, m) + bare * linear).inverse();
  compliance_ = answering * bare;
  answering_ = PaddedMatrix(answering);
  force_answer_ = PaddedMatrix(compliance_);
  bending_answer_ = PaddedMatrix(answering * answer);
  port_answer_ = PaddedMatrix(R * slope.topRows(n));
  const DecoupledSystem& apart = propagator_.apart();
  rows_ = PortRows(R * apart.motion);
  z_before_ = PaddedMatrix(apart.inverse * fall.topRows(n));
  v_before_ = PaddedMatrix(apart.inverse * fall.bottomRows(n));
  z_after_ = PaddedMatrix(apart.inverse * slope.topRows(n));
  v_after_ = PaddedMatrix(apart.inverse * slope.bottomRows(n));
  for (Eigen::VectorXd* values : {&z_, &v_, &next_z_, &next_v_})
    values->setZero(static_cast<Eigen::Index>(padded_size(n)));
  for (Eigen::VectorXd* values :
       {&y_, &last_y_, &port_force_, &scratch_.free_y, &scratch_.free_rates, &scratch_.y,
        &scratch_.bending, &scratch_.last_bending, &scratch_.port_force})
    values->setZero(static_cast<Eigen::Index>(padded_size(ports_.num_ports())));
  for (Eigen::VectorXd* values : {&scratch_.free, &scratch_.relative})
    values->setZero(static_cast<Eigen::Index>(padded_size(m)));
  scratch_.turns.setZero(2 * FaceContactPorts::per_contact * num_contacts());
  scratch_.gap_bending.setZero(num_contacts());
  for (int i = 0; i < num_contacts(); ++i) bending_.emplace_back(turns_of(ports_, i));
  start(Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n));
}

/// Gap and velocities, as far as they are linear, from those of the sliding state.
/// @param relative 3k numbers or more
void SpringContactMotion::set_relative(const Eigen::VectorXd& y, const Eigen::VectorXd& rates,
                                       Eigen::VectorXd& relative) const {
  for (int i = 0; i < num_contacts(); ++i) {
    relative.segment<3>(3 * i) = ports_.displacement(i).lazyProduct(ports_.of(i, y.data())) +
                                 ports_.velocity(i).lazyProduct(ports_.of(i, rates.data()));
  }
}

/// A y and B y of every contact, one after the other.
void SpringContactMotion::set_turns(const double* y, double* turns) const {
  std::fill_n(turns, 2 * FaceContactPorts::per_contact * num_contacts(), 0.0);
  for (int i = 0; i < num_contacts(); ++i) {
    const FaceContactPorts::Local local = ports_.of(i, y);
    bending_[static_cast<std::size_t>(i)].add_product(
        local.data(), turns + 2 * FaceContactPorts::per_contact * i);
  }
}

/// ½ yᵀ A y, m.
double SpringContactMotion::gap_bending(int contact, const double* y, const double* turns) const {
  const Eigen::Map<const FaceContactPorts::Local> normal(turns + 2 * FaceContactPorts::per_contact *
                                                                     contact);
  return 0.5 * ports_.of(contact, y).dot(normal);
}

/// What forces beside those of the sliding state do by bending, on the ports; those of the sliding
/// state are in the linear part.
void SpringContactMotion::add_bending(const double* forces, const double* turns,
                                      double* ports) const {
  for (int i = 0; i < num_contacts(); ++i) {
    const double* normal = turns + 2 * FaceContactPorts::per_contact * i;
    const Eigen::Map<const FaceContactPorts::Local> A(normal);
    const Eigen::Map<const FaceContactPorts::Local> B(normal + FaceContactPorts::per_contact);
    ports_.add(i, forces[3 * i] * A + forces[3 * i + 1] * B, ports);
  }
}

/// Forces beside those of the sliding state and the linear ones, on the ports.
void SpringContactMotion::add_inputs(const Eigen::VectorXd& forces, const Eigen::VectorXd& relative,
                                     double* ports) const {
  for (int i = 0; i < num_contacts(); ++i) {
    const Eigen::Vector3d rest =
        forces.segment<3>(3 * i) -
        linear_[static_cast<std::size_t>(i)].lazyProduct(relative.segment<3>(3 * i));
    ports_.add(i, ports_.inputs(i).lazyProduct(rest), ports);
  }
}

void SpringContactMotion::start(const Eigen::VectorXd& displacement,
                                const Eigen::VectorXd& velocity) {
  const Eigen::Index n = propagator_.size();
  z_.head(n) = propagator_.apart().inverse * displacement;
  v_.head(n) = propagator_.apart().inverse * velocity;
  rows_.gather(z_.data(), y_.data());
  Eigen::VectorXd rates = y_;
  rows_.gather(v_.data(), rates.data());
  Eigen::VectorXd moved(3 * num_contacts());
  set_relative(y_, rates, moved);
  set_turns(y_.data(), scratch_.turns.data());
  seen_ = ports_.drive() + moved;
  forces_.setZero(seen_.size());
  for (int i = 0; i < num_contacts(); ++i) {
    const Eigen::Index k = 3 * i;
    seen_(k) += gap_bending(i, y_.data(), scratch_.turns.data());
    forces_(k) = std::max(0.0, -*law_.penalty * seen_(k));
    const double speed = seen_.segment<2>(k + 1).norm();
    const double limit = law_.friction * forces_(k);
    if (speed > 0.0) {
      forces_.segment<2>(k + 1) = limit / speed * seen_.segment<2>(k + 1);
    } else {
      forces_.segment<2>(k + 1) =
          ports_.preload().segment<2>(k + 1) +
          (linear_[static_cast<std::size_t>(i)] * moved.segment<3>(k)).tail<2>();
    }
  }
  const Eigen::VectorXd change = forces_ - ports_.preload();
  port_force_.setZero();
  add_bending(change.data(), scratch_.turns.data(), port_force_.data());
  add_inputs(change, moved, port_force_.data());
  last_y_ = y_;
  last_forces_ = forces_;
  solver_.forget();
}

bool SpringContactMotion::step() {
  propagator_.advance(z_.data(), v_.data(), next_z_.data(), next_v_.data());
  z_before_.add_product(port_force_.data(), next_z_.data());
  v_before_.add_product(port_force_.data(), next_v_.data());
  z_.swap(next_z_);
  v_.swap(next_v_);
  rows_.gather(z_.data(), scratch_.free_y.data());
  rows_.gather(v_.data(), scratch_.free_rates.data());
  scratch_.y = 2.0 * y_ - last_y_;
  scratch_.guess = 2.0 * forces_ - last_forces_;
  last_y_.swap(y_);
  last_forces_.swap(forces_);
  forces_.swap(scratch_.guess);
  Answer answer(*this, scratch_);
  if (!solver_.solve(answer, forces_)) return false;
  seen_ = solver_.seen();
  y_ = scratch_.y;
  port_force_ = scratch_.port_force;
  z_after_.add_product(port_force_.data(), z_.data());
  v_after_.add_product(port_force_.data(), v_.data());
  return std::isfinite(z_.squaredNorm() + v_.squaredNorm());
}

Eigen::VectorXd SpringContactMotion::displacement() const {
  return propagator_.apart().motion * z_.head(propagator_.size());
}

Eigen::VectorXd SpringContactMotion::velocity() const {
  return propagator_.apart().motion * v_.head(propagator_.size());
}

FaceContactState SpringContactMotion::contact(int index) const {
  return face_contact_state(law_, contacts_[static_cast<std::size_t>(index)],
                            seen_.segment<3>(3 * index), forces_.segment<3>(3 * index));
}

void SpringContactMotion::save(State& state, const std::string& prefix) const {
  const auto put = [&](const char* name, const Eigen::VectorXd& values) {
    state.put(prefix + name, {values.data(), static_cast<std::size_t>(values.size())});
  };
  put("displacement", z_);
  put("velocity", v_);
  put("ports", y_);
  put("forces", forces_);
  put("last_ports", last_y_);
  put("last_forces", last_forces_);
  put("seen", seen_);
  put("port_force", port_force_);
  solver_.save(state, prefix + "solver/");
}

void SpringContactMotion::load(const State& state, const std::string& prefix) {
  const auto get = [&](const char* name, Eigen::VectorXd& values) {
    state.get(prefix + name, {values.data(), static_cast<std::size_t>(values.size())});
  };
  get("displacement", z_);
  get("velocity", v_);
  get("ports", y_);
  get("forces", forces_);
  get("last_ports", last_y_);
  get("last_forces", last_forces_);
  get("seen", seen_);
  get("port_force", port_force_);
  solver_.load(state, prefix + "solver/");
}

}  // namespace stridor
