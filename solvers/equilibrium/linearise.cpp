#include "solvers/equilibrium/linearise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <vector>

#include "solvers/algebra/block_products.hpp"

namespace stridor {
namespace {

ContactRow row_of(const PortVector& ports) {
  ContactRow row{{ports[0], ports[1]}, {}};
  for (Eigen::Index k = 2; k < ports.size(); ++k)
    row.master[static_cast<std::size_t>(k - 2)] = ports[k];
  return row;
}

/// One contact where it is in equilibrium.
ContactLinearisation linearised(const System& system, const ContactPoint& point,
                                const ContactEquilibrium& contact, const EquilibriumState& state,
                                const LinearisationTerms& terms) {
  if (point.has_two_tangents()) {
    return linearise_face(tangent_kinematics(system, point, contact, state.geometry, terms),
                          system.num_contact_ports(point), point.friction, state.friction_factor,
                          terms);
  }
  ContactPositions positions = contact.positions;
  set_roughness(positions, system.surface_of(point), contact.segment);
  if (point.substrate)
    return linearise_contact(positions, constant_friction(contact.friction), 1.0, terms);
  return linearise_contact(positions, point.friction, state.friction_factor, terms);
}

/// Rows of a body that carry no displacement: derivatives at contacts on its faces, and forces of
/// springs that a drive displaces.
std::vector<int> other_rows(const System& system, int body) {
  std::vector<int> rows;
  for (const ContactPoint& contact : system.contacts) {
    if (!contact.face || contact.face->body != body) continue;
    rows.insert(rows.end(), contact.face->rows.begin() + 1, contact.face->rows.end());
  }
  for (const BodyLoad& load : system.bodies[static_cast<std::size_t>(body)].loads)
    if (load.by == BodyLoad::By::shift) rows.push_back(load.row);
  std::erase_if(rows, [](int row) { return row < 0; });
  return rows;
}

/// Adds the reduced form of modal coordinates to a state that may be empty.
void add_motion(Eigen::VectorXd& state, const Eigen::MatrixXd& shapes,
                const Eigen::VectorXd& modal) {
  if (state.size() == 0) state = Eigen::VectorXd::Zero(shapes.rows());
  state += shapes * modal;
}

/// The closed contacts of a pencil, one after the other, with what their forces add to G, H and
/// what of G is left without friction. These join the ports of each contact alone.
class ClosedContacts {
 public:
  /// A contact and what its force adds where it turns or shifts.
  void add(double force, const ContactLinearisation& local) {
    const Eigen::Index size = local.gap_row.size();
    contacts_.push_back({num_ports_, size, force * local.force_by_position,
                         force * local.force_by_velocity, Eigen::MatrixXd::Zero(size, size)});
    num_ports_ += size;
  }

  /// Of the contact added last: a substrate's force varies with indentation and slip instead of
  /// closing the gap: on the left-hand side b_nᵀ δF_k + b_tᵀ δT with b_n = ∂y/∂z and the friction T
  /// against the slip.
  void add_substrate(const SubstrateContact& substrate, const ContactEquilibrium& contact,
                     const ContactLinearisation& local, double friction_factor) {
    const SubstrateForces forces =
        substrate.at(-contact.gap, contact.slip_velocity, contact.direction);
    const auto pushed = [&](double normal, double tangential) -> PortVector {
      return normal * local.gap_row - friction_factor * tangential * local.tangent_row;
    };
    Contact& last = contacts_.back();
    last.stiffness += pushed(forces.normal.by_indentation, forces.tangential.by_indentation) *
                      local.gap_row.transpose();
    last.normal_stiffness += pushed(forces.normal.by_indentation, 0.0) * local.gap_row.transpose();
    last.damping +=
        pushed(forces.normal.by_slip, forces.tangential.by_slip) * local.tangent_row.transpose();
  }

  /// Adds G and H to the coupled terms of bodies; empty where they vanish.
  /// @param pencil with the ports of these contacts, and then those of bodies
  void move_terms_to(Pencil& pencil) const {
    // The modes move in fewer ways than many contacts have ports: then they are the ports.
    const bool is_on_modes = num_ports_ > pencil.num_modes();
    Eigen::MatrixXd contact_ports;
    if (is_on_modes) {
      const Eigen::MatrixXd body_ports = pencil.ports.bottomRows(pencil.num_body_ports);
      contact_ports = std::move(pencil.ports);
      take_modes_as_ports(pencil, contact_ports, body_ports);
    }
    const Eigen::Index m = pencil.num_ports();
    const auto on_ports = [&](Eigen::MatrixXd Contact::*of_contact,
                              const Eigen::MatrixXd& of_bodies) -> Eigen::MatrixXd {
      const bool vanishes =
          std::all_of(contacts_.begin(), contacts_.end(),
                      [&](const Contact& one) { return (one.*of_contact).isZero(0.0); });
      if (vanishes && of_bodies.isZero(0.0)) return {};
      Eigen::MatrixXd terms = Eigen::MatrixXd::Zero(m, m);
      const Eigen::Index num_body_ports = of_bodies.rows();
      terms.bottomRightCorner(num_body_ports, num_body_ports) = of_bodies;
      if (vanishes) return terms;
      if (is_on_modes) {
        const Eigen::Index n = pencil.num_modes();
        BlockProducts products(n, n);
        for (const Contact& one : contacts_) {
          const auto rows = contact_ports.middleRows(one.first, one.count);
          products.add(rows.transpose(), one.*of_contact, rows);
        }
        terms.topLeftCorner(n, n) = products.sum();
      } else {
        for (const Contact& one : contacts_)
          terms.block(one.first, one.first, one.count, one.count) = one.*of_contact;
      }
      return terms;
    };
    const Eigen::Index n = pencil.num_body_ports;
    const auto of_bodies = [&](const Eigen::MatrixXd& terms) -> Eigen::MatrixXd {
      if (terms.size() == 0) return {};
      return terms.bottomRightCorner(n, n);
    };
    pencil.port_stiffness = on_ports(&Contact::stiffness, of_bodies(pencil.port_stiffness));
    pencil.port_damping = on_ports(&Contact::damping, of_bodies(pencil.port_damping));
    pencil.normal_stiffness = on_ports(&Contact::normal_stiffness, {});
  }

 private:
  struct Contact {
    Eigen::Index first = 0;  ///< of its ports
    Eigen::Index count = 0;
    Eigen::MatrixXd stiffness;
    Eigen::MatrixXd damping;
    Eigen::MatrixXd normal_stiffness;
  };

  /// y = q for the contacts; the ports of bodies stay the last ones.
  /// @param contact_ports first rows: of the contacts
  void take_modes_as_ports(Pencil& pencil, const Eigen::MatrixXd& contact_ports,
                           const Eigen::MatrixXd& body_ports) const {
    const Eigen::Index n = pencil.num_modes();
    const auto on_modes = [&](const Eigen::MatrixXd& rows) {
      Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(rows.rows(), n + pencil.num_body_ports);
      // A row is of one contact: the product of all ports would be mostly of zeros.
      for (const Contact& one : contacts_) {
        const auto of_contact = rows.middleCols(one.first, one.count);
        for (Eigen::Index i = 0; i < rows.rows(); ++i) {
          if (!of_contact.row(i).isZero(0.0))
            moved.row(i).head(n) +=
                of_contact.row(i) * contact_ports.middleRows(one.first, one.count);
        }
      }
      moved.rightCols(pencil.num_body_ports) = rows.rightCols(pencil.num_body_ports);
      return moved;
    };
    pencil.compatibility = on_modes(pencil.compatibility);
    pencil.equilibrium = on_modes(pencil.equilibrium);
    Eigen::MatrixXd ports(n + pencil.num_body_ports, n);
    ports << Eigen::MatrixXd::Identity(n, n), body_ports;
    pencil.ports = std::move(ports);
  }

  std::vector<Contact> contacts_;
  Eigen::Index num_ports_ = 0;
};

}  // namespace

Pencil linearise(const System& system, const Equilibrium& equilibrium,
                 const LinearisationTerms& terms) {
  return with_springs(linearise_constraints(system, equilibrium, terms));
}

Pencil linearise_constraints(const System& system, const Equilibrium& equilibrium,
                             const LinearisationTerms& terms) {
  if (equilibrium.status != EquilibriumStatus::converged)
    throw std::invalid_argument("linearise: the equilibrium has not converged");
  Pencil pencil = make_modal_pencil(system);
  ClosedContacts closed;
  std::vector<Eigen::Index> kept_ports;
  std::vector<Eigen::Index> kept_constraints;
  std::vector<double> compliance;
  for (std::size_t i = 0; i < equilibrium.contacts.size(); ++i) {
    const ContactEquilibrium& contact = equilibrium.contacts[i];
    if (!contact.is_closed) continue;
    const ContactPoint& point = system.contacts[i];
    const ContactLinearisation local = linearised(system, point, contact, equilibrium.state, terms);
    const Eigen::Index first = first_contact_port(system, static_cast<int>(i));
    if (point.has_two_tangents()) {
      place_face(pencil, system, static_cast<int>(i), contact.segment, local.gap_row,
                 local.force_row);
    } else {
      place_contact(pencil, system, static_cast<int>(i), contact.segment,
                    {row_of(local.gap_row), row_of(local.force_row)});
    }
    closed.add(contact.force, local);
    if (point.substrate) {
      closed.add_substrate(*point.substrate, contact, local, equilibrium.state.friction_factor);
    } else {
      kept_constraints.push_back(static_cast<Eigen::Index>(i));
      compliance.push_back(point.compliance());
    }
    for (Eigen::Index k = 0; k < local.gap_row.size(); ++k) kept_ports.push_back(first + k);
  }
  const Eigen::Index num_ports = pencil.num_ports();
  for (Eigen::Index port = num_ports - pencil.num_body_ports; port < num_ports; ++port)
    kept_ports.push_back(port);
  if (static_cast<Eigen::Index>(kept_ports.size()) < num_ports)
    pencil.ports = pencil.ports(kept_ports, Eigen::all).eval();
  pencil.compatibility = pencil.compatibility(kept_constraints, kept_ports).eval();
  pencil.equilibrium = pencil.equilibrium(kept_constraints, kept_ports).eval();
  const bool gives_way =
      std::any_of(compliance.begin(), compliance.end(), [](double c) { return c > 0.0; });
  if (gives_way) {
    pencil.compliance = Eigen::Map<const Eigen::VectorXd>(
        compliance.data(), static_cast<Eigen::Index>(compliance.size()));
  }
  closed.move_terms_to(pencil);
  return pencil;
}

void add_perturbation(System& system, const Eigen::VectorXcd& vector, std::complex<double> s,
                      double amplitude) {
  Eigen::Index num_modes = 0;
  for (const SystemBody& body : system.bodies) num_modes += body.modal.size();
  if (vector.size() != num_modes) {
    throw std::invalid_argument(
        fmt::format("add_perturbation: the eigenvector has {} entries, the bodies have {} modes",
                    vector.size(), num_modes));
  }
  std::complex<double> largest = 0.0;
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const SystemBody& body = system.bodies[b];
    Eigen::VectorXcd rows = body.modal.rows * vector.segment(first, body.modal.size());
    for (const int row : other_rows(system, static_cast<int>(b))) rows(row) = 0.0;
    for (const std::complex<double>& row : rows)
      if (std::abs(row) > std::abs(largest)) largest = row;
    first += body.modal.size();
  }
  if (!(std::abs(largest) > 0.0))
    throw std::invalid_argument("add_perturbation: the eigenvector moves no row of the bodies");
  const std::complex<double> scale = amplitude / largest;
  first = 0;
  for (SystemBody& body : system.bodies) {
    if (body.modal.size() == 0) continue;  // BLAS takes no empty matrix
    const Eigen::VectorXcd motion = scale * vector.segment(first, body.modal.size());
    add_motion(body.initial_displacement, body.modal.shapes, motion.real());
    add_motion(body.initial_velocity, body.modal.shapes, (s * motion).real());
    first += body.modal.size();
  }
}

}  // namespace stridor
