#include "solvers/contact/spinning_point.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stridor {

SpinningPoint::SpinningPoint(const ContactPoint& point, Propagator& slave, Propagator& master,
                             int slave_port, int master_port)
    : FacePoint(point, slave, master, slave_port, num_face_rows),
      face_(make_face_kinematics(*point.face)) {
  for (std::size_t k = 0; k < num_face_rows; ++k) {
    master_ports_[k] = master_port + static_cast<int>(k);
    master.watch(master_ports_[k], point.face->rows[k]);
  }
  across_ = face_.across;
  direct(FacePorts::Zero());
}

FacePorts SpinningPoint::ports(const double* slave, const double* master) const {
  return gathered(slave, master);
}

bool SpinningPoint::find(double /*sought*/) {
  direct(expected());
  return true;
}

void SpinningPoint::direct(const FacePorts& ports) {
  directed_at_ = ports;
  bent_normal_ = face_.normal_at(ports);
  bent_along_ = face_.along_at(ports);
  normal_ = bent_normal_;
  along_ = bent_along_;
}

std::optional<Eigen::Vector2d> SpinningPoint::stand(const System& system, const FaceInstant& at) {
  const auto row_of = [&](int index, int row, Eigen::VectorXd SystemBody::*motion) {
    const SystemBody& body = system.bodies[static_cast<std::size_t>(index)];
    return row < 0 || (body.*motion).size() == 0 ? 0.0
                                                 : body.reduced.rows.row(row).dot(body.*motion);
  };
  const auto ports_of = [&](Eigen::VectorXd SystemBody::*motion) {
    FacePorts y;
    for (int k = 0; k < num_face_rows; ++k)
      y[k] = row_of(point().face->body, point().face->rows[static_cast<std::size_t>(k)], motion);
    const PointRows& slave = point().slave_rows;
    y.tail<3>() << row_of(point().slave_body, slave.x, motion),
        row_of(point().slave_body, slave.y, motion), row_of(point().slave_body, slave.z, motion);
    return y;
  };
  reached_ = ports_of(&SystemBody::initial_displacement);
  const FacePorts rate = ports_of(&SystemBody::initial_velocity);
  const Eigen::Vector2d velocity = face_.velocity(reached_, rate);
  if (at.has_feedthrough) reached_ -= at.step * rate;
  return velocity;
}

double SpinningPoint::predicted_gap() const {
  const double gap = 0.5 * directed_at_.dot(face_.normal + bent_normal_);
  return gap + bent_normal_.dot(predicted() - directed_at_) - point().overlap;
}

double SpinningPoint::gap_ahead(const FaceInstant& /*at*/) const {
  const FacePorts y = ahead();
  return face_.gap(directed_at_) + bent_normal_.dot(y - directed_at_) +
         0.5 * (y - directed_at_).dot(face_.normal_bending.lazyProduct(y - directed_at_)) -
         point().overlap;
}

double SpinningPoint::present_gap(double /*now*/) const {
  return face_.gap(current()) - point().overlap;
}

double SpinningPoint::position() const {
  return point().face->radius * point().face->angle;
}

Eigen::Vector2d SpinningPoint::predicted_slip(const FaceInstant& at) const {
  return face_.slip(reached_, predicted(), at.step);
}

Eigen::Vector2d SpinningPoint::expected_slip(const FaceInstant& at) const {
  return face_.slip(reached_, directed_at_, at.step);
}

Eigen::Vector2d SpinningPoint::slip_ahead(const FaceInstant& at) const {
  return face_.slip(directed_at_, ahead(), at.step);
}

Eigen::Vector2d SpinningPoint::follow(const FaceInstant& at) {
  const FacePorts now = current();
  const Eigen::Vector2d slip = face_.slip(reached_, now, at.step);
  reached_ = now;
  return slip;
}

Eigen::Vector2d SpinningPoint::drawn(double /*from*/, double step) const {
  const double spun = step * face_.sliding;
  return {spun, -spun * face_.turning.dot(directed_at_)};
}

FaceDirections SpinningPoint::directions_along(const FacePorts& normal, const FacePorts& along,
                                               double step) const {
  const double turning = 0.5 * step * face_.sliding;
  FaceDirections made;
  made.count = num_face_ports;
  for (std::size_t i = 0; i < num_face_ports; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double across = face_.across[k];
    made.sense[i] = {normal[k], face_.along[k], across + turning * face_.turning[k], 0.0};
    made.push[i] = {normal[k], along[k], across, 0.0};
  }
  return made;
}

FaceDirections SpinningPoint::directions(double step) const {
  return directions_along(bent_normal_, bent_along_, step);
}

FaceDirections SpinningPoint::directions_at_rest(double step) const {
  return directions_along(face_.normal, face_.along, step);
}

std::vector<double> SpinningPoint::numbers() const {
  std::vector<double> numbers(directed_at_.begin(), directed_at_.end());
  numbers.insert(numbers.end(), reached_.begin(), reached_.end());
  return numbers;
}

void SpinningPoint::restore(std::span<const double> numbers) {
  FacePorts directed;
  std::copy_n(numbers.begin(), num_face_ports, directed.begin());
  std::copy_n(numbers.begin() + num_face_ports, num_face_ports, reached_.begin());
  direct(directed);
}

std::string SpinningPoint::where() const {
  return fmt::format("radius {:.6g} m, angle {:.4g} rad", point().face->radius,
                     point().face->angle);
}

}  // namespace stridor
