#include "solvers/face_contact_ports.hpp"

namespace stridor {
namespace {

using Rows = Eigen::MatrixXd;

Rows plate_rows(const FaceContact& contact) {
  const PlateRows& plate = contact.plate;
  Rows rows(FaceContactPorts::plate_ports, plate.w.size());
  rows << plate.w.transpose(), plate.w_r.transpose(), plate.w_phi.transpose(),
      plate.w_r_phi.transpose(), plate.w_phi_phi.transpose();
  return rows;
}

Rows pad_rows(const FaceContact& contact) {
  Rows rows(FaceContactPorts::pad_ports, contact.pad_r.size());
  rows << contact.pad_r.transpose(), contact.pad_phi.transpose(), contact.pad_z.transpose();
  return rows;
}

/// The contact with its ports as coordinates.
FaceContact on_ports(const FaceContact& contact) {
  const auto port = [](Eigen::Index i) -> Eigen::VectorXd {
    return Eigen::VectorXd::Unit(FaceContactPorts::per_contact, i);
  };
  FaceContact local = contact;
  local.plate = {port(0), port(1), port(2), port(3), port(4)};
  local.pad_r = port(5);
  local.pad_phi = port(6);
  local.pad_z = port(7);
  return local;
}

}  // namespace

FaceContactPorts::FaceContactPorts(const std::vector<FaceContact>& contacts,
                                   const FaceContactLaw& law, const FaceSlidingState& state)
    : bends_(law.forces_bend) {
  place_ports(contacts);
  drive_ = preload_ = Eigen::VectorXd::Zero(3 * num_contacts());
  for (int i = 0; i < num_contacts(); ++i) {
    const auto index = static_cast<std::size_t>(i);
    const FaceContactPoint& point = state.contacts[index];
    const Eigen::VectorXd sliding = rows_ * state.displacement;
    set_rows(contacts_[index], on_ports(contacts[index]), law, of(i, sliding.data()));
    drive_(3 * i) = point.gap;
    drive_.segment<2>(3 * i + 1) = point.velocity;
    if (!point.is_closed) continue;
    preload_(3 * i) = point.force;
    preload_.segment<2>(3 * i + 1) = point.force * law.friction * point.direction;
  }
}

/// Ports of the plate first, so that rows of one body follow one another.
void FaceContactPorts::place_ports(const std::vector<FaceContact>& contacts) {
  std::vector<Rows> places;
  contacts_.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Rows rows = plate_rows(contacts[i]);
    std::size_t place = 0;
    while (place < places.size() && places[place] != rows) ++place;
    if (place == places.size()) places.push_back(rows);
    contacts_[i].plate = static_cast<Eigen::Index>(place) * plate_ports;
  }
  const auto num_plate = static_cast<Eigen::Index>(places.size()) * plate_ports;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts_[i].pad = num_plate + static_cast<Eigen::Index>(i) * pad_ports;
    places.push_back(pad_rows(contacts[i]));
  }
  rows_.resize(num_plate + static_cast<Eigen::Index>(contacts.size()) * pad_ports,
               places.front().cols());
  Eigen::Index row = 0;
  for (const Rows& rows : places) {
    rows_.middleRows(row, rows.rows()) = rows;
    row += rows.rows();
  }
}

/// @param contact on its ports
/// @param sliding its ports in the sliding state
void FaceContactPorts::set_rows(Contact& local, const FaceContact& contact,
                                const FaceContactLaw& law, const Eigen::VectorXd& sliding) {
  local.normal_bending.setZero();
  local.friction_bending.setZero();
  if (bends_) {
    const Eigen::MatrixXd forces = contact.bending_forces();
    local.normal_bending = forces * contact.normal_bending();
    local.friction_bending = forces * contact.friction_bending();
  }
  local.inputs.setZero();
  local.inputs.col(0) = contact.gap() + local.normal_bending * sliding;
  local.inputs.col(1) = contact.friction() + local.friction_bending * sliding;
  local.displacement.setZero();
  local.velocity.setZero();
  local.displacement.row(0) = local.inputs.col(0);
  local.velocity.row(1) = -contact.friction();
  if (!law.friction_turns) return;
  local.inputs.col(2) = contact.across();
  local.velocity.row(2) = -contact.across();
  local.displacement.row(2) = -law.speed * contact.radius * contact.turning();
}

Eigen::MatrixXd FaceContactPorts::placed(const std::vector<LocalRows>& rows) const {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(3 * num_contacts(), num_ports());
  for (int i = 0; i < num_contacts(); ++i) {
    const LocalRows& one = rows[static_cast<std::size_t>(i)];
    whole.block<3, plate_ports>(3 * i, local(i).plate) = one.leftCols<plate_ports>();
    whole.block<3, pad_ports>(3 * i, local(i).pad) = one.rightCols<pad_ports>();
  }
  return whole;
}

Eigen::MatrixXd FaceContactPorts::inputs() const {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(num_ports(), 3 * num_contacts());
  for (int i = 0; i < num_contacts(); ++i) {
    columns.block<plate_ports, 3>(local(i).plate, 3 * i) = inputs(i).topRows<plate_ports>();
    columns.block<pad_ports, 3>(local(i).pad, 3 * i) = inputs(i).bottomRows<pad_ports>();
  }
  return columns;
}

}  // namespace stridor
