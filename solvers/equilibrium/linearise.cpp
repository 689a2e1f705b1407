#include "solvers/equilibrium/linearise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <vector>

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

/// G, H and what of G is left without friction, on all ports of a system.
class TermsOnPorts {
 public:
  /// With the coupled terms of bodies.
  explicit TermsOnPorts(const Pencil& bodies)
      : stiffness_(Eigen::MatrixXd::Zero(bodies.num_ports(), bodies.num_ports())),
        damping_(stiffness_),
        normal_stiffness_(stiffness_) {
    if (bodies.num_body_ports == 0) return;
    stiffness_ = bodies.port_stiffness;
    damping_ = bodies.port_damping;
  }

  /// What the force of a contact adds where it turns or shifts; on ports from `first` on.
  void add(Eigen::Index first, double force, const ContactLinearisation& local) {
    block(stiffness_, first, local) = force * local.force_by_position;
    block(damping_, first, local) = force * local.force_by_velocity;
  }

  /// A substrate's force varies with indentation and slip instead of closing the gap: on the
  /// left-hand side b_nᵀ δF_k + b_tᵀ δT with b_n = ∂y/∂z and the friction T against the slip.
  void add_substrate(Eigen::Index first, const SubstrateContact& substrate,
                     const ContactEquilibrium& contact, const ContactLinearisation& local,
                     double friction_factor) {
    const SubstrateForces forces =
        substrate.at(-contact.gap, contact.slip_velocity, contact.direction);
    const auto pushed = [&](double normal, double tangential) -> PortVector {
      return normal * local.gap_row - friction_factor * tangential * local.tangent_row;
    };
    block(stiffness_, first, local) +=
        pushed(forces.normal.by_indentation, forces.tangential.by_indentation) *
        local.gap_row.transpose();
    block(normal_stiffness_, first, local) +=
        pushed(forces.normal.by_indentation, 0.0) * local.gap_row.transpose();
    block(damping_, first, local) +=
        pushed(forces.normal.by_slip, forces.tangential.by_slip) * local.tangent_row.transpose();
  }

  /// The terms on the ports kept; empty where they vanish.
  void move_to(Pencil& pencil, const std::vector<Eigen::Index>& kept) const {
    const auto on_kept = [&](const Eigen::MatrixXd& terms) -> Eigen::MatrixXd {
      if (terms.isZero(0.0)) return {};
      return terms(kept, kept);
    };
    pencil.port_stiffness = on_kept(stiffness_);
    pencil.port_damping = on_kept(damping_);
    pencil.normal_stiffness = on_kept(normal_stiffness_);
  }

 private:
  static Eigen::Block<Eigen::MatrixXd> block(Eigen::MatrixXd& terms, Eigen::Index first,
                                             const ContactLinearisation& local) {
    return terms.block(first, first, local.gap_row.size(), local.gap_row.size());
  }

  Eigen::MatrixXd stiffness_;
  Eigen::MatrixXd damping_;
  Eigen::MatrixXd normal_stiffness_;
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
  TermsOnPorts added(pencil);
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
    added.add(first, contact.force, local);
    if (point.substrate) {
      added.add_substrate(first, *point.substrate, contact, local,
                          equilibrium.state.friction_factor);
    } else {
      kept_constraints.push_back(static_cast<Eigen::Index>(i));
      compliance.push_back(point.compliance());
    }
    for (Eigen::Index k = 0; k < local.gap_row.size(); ++k) kept_ports.push_back(first + k);
  }
  const Eigen::Index num_ports = pencil.num_ports();
  for (Eigen::Index port = num_ports - pencil.num_body_ports; port < num_ports; ++port)
    kept_ports.push_back(port);
  pencil.ports = pencil.ports(kept_ports, Eigen::all).eval();
  pencil.compatibility = pencil.compatibility(kept_constraints, kept_ports).eval();
  pencil.equilibrium = pencil.equilibrium(kept_constraints, kept_ports).eval();
  const bool gives_way =
      std::any_of(compliance.begin(), compliance.end(), [](double c) { return c > 0.0; });
  if (gives_way) {
    pencil.compliance = Eigen::Map<const Eigen::VectorXd>(
        compliance.data(), static_cast<Eigen::Index>(compliance.size()));
  }
  added.move_to(pencil, kept_ports);
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
