#include "solvers/contact/face_point.hpp"

#include <algorithm>

#include "solvers/contact/space_point.hpp"
#include "solvers/contact/spinning_point.hpp"

namespace stridor {
namespace {

Eigen::Index index_of(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

/// Displacements and directions of one body.
void put_side(PortBlock& block, std::span<const int> ports, const FaceDirections& directions,
              std::size_t first) {
  block.count = static_cast<int>(ports.size());
  block.width = 3;
  std::copy(ports.begin(), ports.end(), block.ports.begin());
  for (std::size_t i = 0; i < ports.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      block.sense(index_of(i), index_of(c)) = directions.sense[first + i][c];
      block.push(index_of(i), index_of(c)) = directions.push[first + i][c];
    }
  }
}

}  // namespace

FacePoint::FacePoint(const ContactPoint& point, Propagator& slave, Propagator& master,
                     int slave_port, int num_master_ports)
    : point_(point),
      slave_(&slave),
      master_(&master),
      num_slave_ports_(point.num_slave_ports()),
      num_master_ports_(num_master_ports) {
  for (int i = 0; i < num_slave_ports_; ++i) {
    slave_ports_[static_cast<std::size_t>(i)] = slave_port + i;
    slave_->watch(slave_port + i, point.slave_rows.row(i));
  }
}

TangentPorts FacePoint::gathered(const double* slave, const double* master) const {
  TangentPorts y = TangentPorts::Zero(num_master_ports_ + 3);
  Eigen::Index k = 0;
  for (const int port : master_ports()) y[k++] = master[port];
  for (const int port : slave_ports()) y[k++] = slave[port];
  return y;
}

std::array<int, max_facet_ports> FacePoint::master_rows() const {
  std::array<int, max_facet_ports> rows{};
  std::size_t k = 0;
  for (const int port : master_ports()) rows[k++] = master_->row(port);
  return rows;
}

std::array<PortBlock, 2> FacePoint::blocks(const FaceDirections& directions) const {
  std::array<PortBlock, 2> made;
  auto& [master, slave] = made;
  master.body = master_;
  slave.body = slave_;
  put_side(master, master_ports(), directions, 0);
  put_side(slave, slave_ports(), directions, master_ports().size());
  return made;
}

void FacePoint::apply(double normal, const Eigen::Vector2d& friction, double* slave_forces,
                      double* master_forces) const {
  const TangentPorts forces = normal * normal_ + friction.x() * along_ + friction.y() * across_;
  Eigen::Index k = 0;
  for (const int port : master_ports()) master_forces[port] += forces[k++];
  for (const int port : slave_ports()) slave_forces[port] += forces[k++];
}

std::unique_ptr<FacePoint> make_spinning_point(const ContactPoint& point, Propagator& slave,
                                               Propagator& master, int slave_port,
                                               int master_port) {
  return std::make_unique<SpinningPoint>(point, slave, master, slave_port, master_port);
}

std::unique_ptr<FacePoint> make_space_point(const ContactPoint& point, const FacetSurface* surface,
                                            NodePorts* nodes, const DrivenMotion& driven,
                                            Propagator& slave, Propagator& master, int slave_port) {
  return std::make_unique<SpacePoint>(point, surface, nodes, driven, slave, master, slave_port);
}

}  // namespace stridor
