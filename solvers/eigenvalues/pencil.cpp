#include "solvers/eigenvalues/pencil.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "coupling/system/undeformed_contact.hpp"

namespace stridor {
namespace {

[[noreturn]] void reject(const std::string& message) {
  throw std::invalid_argument("pencil: " + message);
}

void check_size(const char* name, const Eigen::MatrixXd& matrix, Eigen::Index rows,
                Eigen::Index columns) {
  if (matrix.rows() != rows || matrix.cols() != columns) {
    reject(fmt::format("{} is {} x {} instead of {} x {}", name, matrix.rows(), matrix.cols(), rows,
                       columns));
  }
  if (!matrix.allFinite()) reject(fmt::format("{} is not finite", name));
}

/// Segment under a point of the undeformed master and the projection on it.
std::pair<int, Projection> undeformed_place(const MasterSurface& surface,
                                            const Eigen::Vector2d& point, int first) {
  const int last = surface.num_segments() - 1;
  int segment = std::clamp(first, 0, last);
  Projection projection = surface.project_undeformed(segment, point);
  while (projection.xi > 1.0 && segment < last) {
    projection = surface.project_undeformed(++segment, point);
  }
  while (projection.xi < 0.0 && segment > 0) {
    projection = surface.project_undeformed(--segment, point);
    if (projection.xi > 1.0) break;  // between two segments that diverge
  }
  return {segment, projection};
}

}  // namespace

double Eigenvalue::frequency() const {
  return s.imag() / (2.0 * std::numbers::pi);
}

void check_pencil(const Pencil& pencil) {
  const Eigen::Index n = pencil.num_modes();
  const Eigen::Index m = pencil.num_ports();
  const Eigen::Index k = pencil.num_constraints();
  check_size("omega", pencil.omega, n, 1);
  check_size("damping", pencil.damping, n, 1);
  check_size("ports", pencil.ports, m, n);
  check_size("compatibility", pencil.compatibility, k, m);
  check_size("equilibrium", pencil.equilibrium, k, m);
  if (pencil.compliance.size() > 0) check_size("compliance", pencil.compliance, k, 1);
  if (pencil.port_stiffness.size() > 0) check_size("port_stiffness", pencil.port_stiffness, m, m);
  if (pencil.port_damping.size() > 0) check_size("port_damping", pencil.port_damping, m, m);
  if (pencil.normal_stiffness.size() > 0)
    check_size("normal_stiffness", pencil.normal_stiffness, m, m);
  if (k >= n) reject(fmt::format("{} constraints leave nothing of {} modes", k, n));
  if ((pencil.omega.array() < 0.0).any()) reject("omega is negative");
}

Pencil make_modal_pencil(const System& system) {
  Eigen::Index n = 0;
  for (const SystemBody& body : system.bodies) n += body.modal.size();
  Pencil pencil;
  pencil.omega.resize(n);
  pencil.damping.resize(n);
  Eigen::Index first = 0;
  for (const SystemBody& body : system.bodies) {
    const Eigen::Index size = body.modal.size();
    pencil.omega.segment(first, size) = body.modal.omega;
    pencil.damping.segment(first, size) =
        body.modal.damping.alpha + body.modal.damping.beta * body.modal.omega.array().square();
    if (!body.modal.coupled.is_empty()) pencil.num_body_ports += size;
    first += size;
  }
  const auto k = static_cast<Eigen::Index>(system.contacts.size());
  const Eigen::Index num_contact_ports = first_contact_port(system, static_cast<int>(k));
  const Eigen::Index m = num_contact_ports + pencil.num_body_ports;
  pencil.ports.setZero(m, n);
  pencil.compatibility.setZero(k, m);
  pencil.equilibrium.setZero(k, m);
  if (pencil.num_body_ports == 0) return pencil;
  pencil.port_stiffness.setZero(m, m);
  pencil.port_damping.setZero(m, m);
  Eigen::Index port = num_contact_ports;
  first = 0;
  for (const SystemBody& body : system.bodies) {
    const Eigen::Index size = body.modal.size();
    const CoupledTerms& coupled = body.modal.coupled;
    if (!coupled.is_empty()) {
      pencil.ports.block(port, first, size, size).setIdentity();
      pencil.port_stiffness.block(port, port, size, size) = coupled.position;
      pencil.port_damping.block(port, port, size, size) = coupled.velocity;
      port += size;
    }
    first += size;
  }
  return pencil;
}

Pencil with_springs(const Pencil& pencil) {
  if (pencil.compliance.size() == 0) return pencil;
  Pencil sprung = pencil;
  sprung.compliance.resize(0);
  if (sprung.port_stiffness.size() == 0)
    sprung.port_stiffness.setZero(pencil.num_ports(), pencil.num_ports());
  if (sprung.normal_stiffness.size() == 0)
    sprung.normal_stiffness.setZero(pencil.num_ports(), pencil.num_ports());
  std::vector<Eigen::Index> rigid;
  std::vector<Eigen::Index> yielding;
  for (Eigen::Index i = 0; i < pencil.num_constraints(); ++i)
    (pencil.compliance(i) == 0.0 ? rigid : yielding).push_back(i);
  const Eigen::MatrixXd gaps = pencil.compatibility(yielding, Eigen::all);
  const Eigen::MatrixXd springs = pencil.compliance(yielding).cwiseInverse().asDiagonal() * gaps;
  sprung.port_stiffness += pencil.equilibrium(yielding, Eigen::all).transpose() * springs;
  sprung.normal_stiffness += gaps.transpose() * springs;
  sprung.compatibility = pencil.compatibility(rigid, Eigen::all);
  sprung.equilibrium = pencil.equilibrium(rigid, Eigen::all);
  return sprung;
}

void drop_contact_terms(Pencil& pencil) {
  pencil.normal_stiffness.resize(0, 0);
  const Eigen::Index num_contact_ports = pencil.num_ports() - pencil.num_body_ports;
  for (Eigen::MatrixXd* terms : {&pencil.port_stiffness, &pencil.port_damping}) {
    if (pencil.num_body_ports == 0) {
      terms->resize(0, 0);
    } else if (terms->size() > 0) {
      terms->topLeftCorner(num_contact_ports, num_contact_ports).setZero();
    }
  }
}

void drop_structural_damping(Pencil& pencil) {
  pencil.damping.setZero();
  const Eigen::Index n = pencil.num_body_ports;
  if (n == 0 || pencil.port_damping.size() == 0) return;
  auto coupled = pencil.port_damping.bottomRightCorner(n, n);
  coupled = 0.5 * (coupled - coupled.transpose()).eval();
}

void drop_contact_damping(Pencil& pencil) {
  const Eigen::Index num_contact_ports = pencil.num_ports() - pencil.num_body_ports;
  if (pencil.port_damping.size() > 0)
    pencil.port_damping.topLeftCorner(num_contact_ports, num_contact_ports).setZero();
}

Eigen::Index first_contact_port(const System& system, int contact) {
  Eigen::Index first = 0;
  for (int i = 0; i < contact; ++i)
    first += system.num_contact_ports(system.contacts[static_cast<std::size_t>(i)]);
  return first;
}

void place_contact(Pencil& pencil, const System& system, int contact, int segment,
                   const ContactRows& rows) {
  const ContactPoint& point = system.contacts[static_cast<std::size_t>(contact)];
  const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(point.surface)];
  const Stencil stencil = surface.stencil(segment);
  const Eigen::Index port = first_contact_port(system, contact);
  pencil.ports.middleRows(port, system.num_contact_ports(point)).setZero();
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const ModalBody& modal = system.bodies[b].modal;
    const auto body = static_cast<int>(b);
    // Mode by mode: the rows of neighbouring nodes lie side by side in a column.
    const auto fill = [&](Eigen::Index at, std::span<const PointRows> watched) {
      for (Eigen::Index i = 0; i < modal.size(); ++i) {
        Eigen::Index row = port + at;
        for (const PointRows& source : watched) {
          pencil.ports(row++, first + i) = modal.rows(source.x, i);
          pencil.ports(row++, first + i) = modal.rows(source.y, i);
        }
      }
    };
    if (body == point.slave_body) fill(0, {&point.slave_rows, 1});
    if (body == surface.body) {
      fill(2, std::span(surface.rows)
                  .subspan(static_cast<std::size_t>(stencil.first),
                           static_cast<std::size_t>(stencil.count)));
    }
    first += modal.size();
  }
  const auto set_row = [&](Eigen::MatrixXd& matrix, const ContactRow& row) {
    for (Eigen::Index i = 0; i < 2; ++i)
      matrix(contact, port + i) = row.slave[static_cast<std::size_t>(i)];
    for (Eigen::Index i = 0; i < 2 * stencil.count; ++i)
      matrix(contact, port + 2 + i) = row.master[static_cast<std::size_t>(i)];
  };
  set_row(pencil.compatibility, rows.compatibility);
  set_row(pencil.equilibrium, rows.equilibrium);
}

void place_face(Pencil& pencil, const System& system, int contact, int facet,
                const Eigen::VectorXd& compatibility, const Eigen::VectorXd& equilibrium) {
  const ContactPoint& point = system.contacts[static_cast<std::size_t>(contact)];
  const Eigen::Index port = first_contact_port(system, contact);
  const Eigen::Index num_ports = system.num_contact_ports(point);
  pencil.ports.middleRows(port, num_ports).setZero();
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const ModalBody& modal = system.bodies[b].modal;
    const auto columns = Eigen::seqN(first, modal.size());
    if (static_cast<int>(b) == system.master_of(point)) {
      Eigen::Index at = port;
      for (const int row : system.master_rows(point, facet))
        pencil.ports(at++, columns) = modal.rows.row(row);
    }
    if (static_cast<int>(b) == point.slave_body) {
      const Eigen::Index first_of_slave = system.num_master_ports(point);
      for (Eigen::Index k = first_of_slave; k < num_ports; ++k)
        pencil.ports(port + k, columns) +=
            modal.rows.row(point.slave_rows.row(static_cast<int>(k - first_of_slave)));
    }
    first += modal.size();
  }
  pencil.compatibility.row(contact).segment(port, num_ports) = compatibility.transpose();
  pencil.equilibrium.row(contact).segment(port, num_ports) = equilibrium.transpose();
}

namespace {

/// A contact with two tangents on the undeformed bodies, with friction along the sliding: along the
/// first of them on a face.
void place_two_tangents(Pencil& pencil, const System& system, int contact, double displacement,
                        double friction) {
  const ContactPoint& point = system.contacts[static_cast<std::size_t>(contact)];
  const std::optional<UndeformedContact> at = undeformed_contact(system, point, displacement);
  if (!at) {
    throw std::invalid_argument(
        fmt::format("pencil: contact '{}' is beyond the edge of its master at a drive displacement of "
                    "{:g} m",
                    point.name, displacement));
  }
  const auto& [facet, kinematics] = *at;
  const double speed = kinematics.velocity.norm();
  const bool slides_askew = point.space && speed > 0.0;
  const Eigen::Vector2d direction =
      slides_askew ? Eigen::Vector2d(kinematics.velocity / speed) : Eigen::Vector2d(1.0, 0.0);
  const Eigen::Index num_ports = system.num_contact_ports(point);
  place_face(pencil, system, contact, facet, -kinematics.normal.head(num_ports),
             -(kinematics.normal + friction * (kinematics.friction * direction)).head(num_ports));
}

}  // namespace

void place_undeformed(Pencil& pencil, const System& system, double drive_displacement,
                      double friction, double direction) {
  for (std::size_t c = 0; c < system.contacts.size(); ++c) {
    const ContactPoint& point = system.contacts[c];
    if (point.has_two_tangents()) {
      place_two_tangents(pencil, system, static_cast<int>(c), drive_displacement, friction);
      continue;
    }
    const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(point.surface)];
    // The surface may follow a drive, too; seen from it, only the difference moves the slave.
    const Eigen::Vector2d slave =
        point.slave_position + Eigen::Vector2d(system.path_share(point) * drive_displacement, 0.0);
    const auto [segment, projection] = undeformed_place(surface, slave, point.first_segment);
    constexpr double rounding = 1e-9;
    const bool is_off = (segment == 0 && projection.xi < -rounding) ||
                        (segment == surface.num_segments() - 1 && projection.xi > 1.0 + rounding);
    if (is_off && !surface.is_endless) {
      throw std::invalid_argument(
          fmt::format("pencil: contact '{}' is beyond the end of its master at a drive "
                      "displacement of {:g} m",
                      point.name, drive_displacement));
    }
    place_contact(pencil, system, static_cast<int>(c), segment,
                  make_rows(projection, friction, direction));
  }
}

}  // namespace stridor
