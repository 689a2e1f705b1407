#include "solvers/contact/face_point.hpp"

#include "solvers/contact/space_point.hpp"
#include "solvers/contact/spinning_point.hpp"

namespace stridor {
namespace {

int num_ports_of(const ContactPoint& point, const FacetSurface* surface) {
  if (point.face) return num_face_rows;
  return surface == nullptr ? 0 : 3 * surface->max_nodes();
}

}  // namespace

FacePoint::FacePoint(const ContactPoint& point, Propagator& slave, Propagator& master,
                     int slave_port, int master_port, int num_master_ports)
    : point_(point),
      slave_(&slave),
      master_(&master),
      slave_port_(slave_port),
      master_port_(master_port),
      num_slave_ports_(point.num_slave_ports()),
      num_master_ports_(num_master_ports) {
  slave_->watch(slave_port, point.slave_rows.x);
  slave_->watch(slave_port + 1, point.slave_rows.y);
  if (num_slave_ports_ > 2) slave_->watch(slave_port + 2, point.slave_rows.z);
}

TangentPorts FacePoint::gathered(const double* slave, const double* master) const {
  TangentPorts y = TangentPorts::Zero(num_master_ports_ + 3);
  for (int k = 0; k < num_master_ports_; ++k) y[k] = master[master_port_ + k];
  for (int k = 0; k < num_slave_ports_; ++k) y[num_master_ports_ + k] = slave[slave_port_ + k];
  return y;
}

std::array<int, max_facet_ports> FacePoint::master_rows() const {
  std::array<int, max_facet_ports> rows{};
  for (int k = 0; k < num_master_ports_; ++k)
    rows[static_cast<std::size_t>(k)] = master_->row(master_port_ + k);
  return rows;
}

std::array<PortBlock, 2> FacePoint::blocks(const Directions& directions) const {
  const auto& [sense, push] = directions;
  std::array<PortBlock, 2> made;
  auto& [master, slave] = made;
  master.body = master_;
  master.port = master_port_;
  master.count = num_master_ports_;
  slave.body = slave_;
  slave.port = slave_port_;
  slave.count = num_slave_ports_;
  master.width = slave.width = 3;
  master.sense.topRows(num_master_ports_) = sense.topRows(num_master_ports_);
  master.push.topRows(num_master_ports_) = push.topRows(num_master_ports_);
  slave.sense.topRows<3>() = sense.bottomRows<3>();
  slave.push.topRows<3>() = push.bottomRows<3>();
  return made;
}

void FacePoint::apply(double normal, const Eigen::Vector2d& friction, double* slave_forces,
                      double* master_forces) const {
  const TangentPorts forces = normal * normal_ + friction.x() * along_ + friction.y() * across_;
  for (int k = 0; k < num_master_ports_; ++k) master_forces[master_port_ + k] = forces[k];
  for (int k = 0; k < num_slave_ports_; ++k)
    slave_forces[slave_port_ + k] = forces[num_master_ports_ + k];
}

std::unique_ptr<FacePoint> make_face_point(const ContactPoint& point, const FacetSurface* surface,
                                           const DrivenMotion& driven, Propagator& slave,
                                           Propagator& master, int slave_port, int master_port) {
  if (point.face)
    return std::make_unique<SpinningPoint>(point, slave, master, slave_port, master_port);
  return std::make_unique<SpacePoint>(point, surface, driven, slave, master, slave_port,
                                      master_port, num_ports_of(point, surface));
}

}  // namespace stridor
