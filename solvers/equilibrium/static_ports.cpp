#include "solvers/equilibrium/static_ports.hpp"

#include <Eigen/LU>
#include <utility>

namespace stridor {
namespace {

/// What constant forces do to the elastic modes of a body: (diag(ω²) + N)⁻¹ f.
Eigen::MatrixXd answer_of(const ModalBody& body, const Eigen::MatrixXd& forces) {
  const auto squares = body.omega.tail(forces.rows()).array().square();
  if (body.coupled.is_empty()) return squares.inverse().matrix().asDiagonal() * forces;
  // Circulatory terms do not act on rigid modes, which come first.
  Eigen::MatrixXd stiffness = body.coupled.position.bottomRightCorner(forces.rows(), forces.rows());
  stiffness.diagonal() += squares.matrix();
  return stiffness.partialPivLu().solve(forces);
}

}  // namespace

double size_of(const BodyLoad& load, const EquilibriumState& state) {
  if (state.drives.empty()) return 0.0;
  const DriveState& drive = state.drives[static_cast<std::size_t>(load.drive)];
  return load.by == BodyLoad::By::force ? drive.load : drive.shift;
}

StaticPorts::StaticPorts(const System& system, const EquilibriumState& state)
    : system_(system), state_(state) {
  Eigen::Index num_elastic = 0;
  for (const SystemBody& body : system.bodies) {
    BodyPorts ports;
    ports.num_rigid = (body.modal.omega.array() == 0.0).count();
    ports.first_rigid = num_rigid;
    ports.first_elastic = num_elastic;
    num_rigid += ports.num_rigid;
    num_elastic += body.modal.size() - ports.num_rigid;
    bodies_.push_back(std::move(ports));
  }
  for (const ContactPoint& point : system.contacts) num_ports += system.num_contact_ports(point);
  is_modal = num_ports > num_elastic && num_elastic > 0;
  num_unknown = is_modal ? num_elastic : num_ports;
}

/// Rows and static flexibility at the ports of the present segments.
void StaticPorts::gather(const std::vector<SoughtContact>& contacts) {
  for (BodyPorts& body : bodies_) body.ports.clear();
  std::vector<std::vector<int>> watched(bodies_.size());
  const auto watch_row = [&](int body, int port, int row) {
    bodies_[static_cast<std::size_t>(body)].ports.push_back(port);
    watched[static_cast<std::size_t>(body)].push_back(row);
  };
  const auto watch = [&](int body, int port, const PointRows& rows) {
    watch_row(body, port, rows.x);
    watch_row(body, port + 1, rows.y);
  };
  for (const SoughtContact& contact : contacts) {
    auto port = static_cast<int>(contact.first_port);
    if (contact.has_two_tangents()) {
      const ContactPoint& point = *contact.point;
      int on_master = port;
      for (const int row : system_.master_rows(point, contact.result.segment))
        watch_row(system_.master_of(point), on_master++, row);
      port += system_.num_master_ports(point);
      watch(point.slave_body, port, point.slave_rows);
      if (point.num_slave_ports() > 2) watch_row(point.slave_body, port + 2, point.slave_rows.z);
      continue;
    }
    watch(contact.point->slave_body, port, contact.point->slave_rows);
    const Stencil stencil = contact.surface->stencil(contact.result.segment);
    for (int k = 0; k < stencil.count; ++k) {
      watch(contact.surface->body, port + 2 * (k + 1),
            contact.surface->rows[static_cast<std::size_t>(stencil.first + k)]);
    }
  }

  flexibility = Eigen::MatrixXd::Zero(num_unknown, num_ports);
  if (is_modal) elastic_rows = Eigen::MatrixXd::Zero(num_ports, num_unknown);
  rigid_rows = Eigen::MatrixXd::Zero(num_ports, num_rigid);
  loaded = Eigen::VectorXd::Zero(num_unknown);
  rigid_load = Eigen::VectorXd::Zero(num_rigid);
  for (std::size_t b = 0; b < bodies_.size(); ++b) gather_body(b, watched[b]);
  loaded_ports = is_modal ? Eigen::VectorXd(elastic_rows * loaded) : loaded;
}

void StaticPorts::gather_body(std::size_t b, const std::vector<int>& watched) {
  const ModalBody& modal = system_.bodies[b].modal;
  BodyPorts& body = bodies_[b];
  // Rigid modes come first, ω ascending.
  const Eigen::Index num_elastic = modal.size() - body.num_rigid;
  const auto columns = Eigen::seqN(body.first_rigid, body.num_rigid);
  const Eigen::VectorXd load = load_on(system_.bodies[b]);
  rigid_load(columns) = load.head(body.num_rigid);
  if (body.ports.empty()) return;

  body.rows = modal.rows(watched, Eigen::all);
  rigid_rows(body.ports, columns) = body.rows.leftCols(body.num_rigid);
  const auto elastic = body.rows.rightCols(num_elastic);
  const Eigen::MatrixXd by_forces = answer_of(modal, elastic.transpose());
  const Eigen::VectorXd by_load = answer_of(modal, load.tail(num_elastic));
  if (is_modal) {
    const auto modes = Eigen::seqN(body.first_elastic, num_elastic);
    elastic_rows(body.ports, modes) = elastic;
    flexibility(modes, body.ports) = by_forces;
    loaded(modes) = by_load;
  } else {
    flexibility(body.ports, body.ports) = elastic * by_forces;
    loaded(body.ports) = elastic * by_load;
  }
}

Eigen::VectorXd StaticPorts::at_ports(const Eigen::VectorXd& unknown,
                                      const Eigen::VectorXd& rigid) const {
  if (!is_modal) return unknown;
  Eigen::VectorXd ports = elastic_rows * unknown;
  if (num_rigid > 0) ports += rigid_rows * rigid;  // BLAS takes no empty matrix
  return ports;
}

Eigen::VectorXd StaticPorts::modes(std::size_t b, const Eigen::VectorXd& forces,
                                   const Eigen::VectorXd& rigid) const {
  const ModalBody& modal = system_.bodies[b].modal;
  const BodyPorts& body = bodies_[b];
  Eigen::VectorXd modes = Eigen::VectorXd::Zero(modal.size());
  if (!body.ports.empty() && body.rows.size() > 0)
    modes = body.rows.transpose() * forces(body.ports);
  modes += load_on(system_.bodies[b]);
  const Eigen::Index num_elastic = modal.size() - body.num_rigid;
  modes.tail(num_elastic) = answer_of(modal, modes.tail(num_elastic));
  modes.head(body.num_rigid) = rigid.segment(body.first_rigid, body.num_rigid);
  return modes;
}

const std::string& StaticPorts::body_of(Eigen::Index rigid_mode) const {
  std::size_t b = 0;
  while (rigid_mode >= bodies_[b].first_rigid + bodies_[b].num_rigid) ++b;
  return system_.bodies[b].name;
}

Eigen::VectorXd StaticPorts::load_on(const SystemBody& body) const {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(body.modal.size());
  for (const BodyLoad& one : body.loads)
    load += size_of(one, state_) * body.modal.rows.row(one.row).transpose();
  // BLAS takes no empty matrix.
  if (body.held_load.size() > 0) load += body.modal.shapes.transpose() * body.held_load;
  return load;
}

}  // namespace stridor
