#include "solvers/equilibrium/equilibrium.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"

namespace stridor {
namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// The combination of ports that sees `vector` at the nodes of the master, with weights.
PortVector on_nodes(const Stencil& stencil, const std::array<double, max_stencil>& weights,
                    const Eigen::Vector2d& vector) {
  PortVector ports = PortVector::Zero(2 + 2 * stencil.count);
  for (int k = 0; k < stencil.count; ++k) ports.segment<2>(2 + 2 * k) = weights[at(k)] * vector;
  return ports;
}

/// The combination of ports that sees `vector` at the slave against the master below it.
PortVector relative(const Stencil& stencil, const NodeWeights& weights,
                    const Eigen::Vector2d& vector) {
  PortVector ports = on_nodes(stencil, weights.value, -vector);
  ports.head<2>() = vector;
  return ports;
}

double size_of(const BodyLoad& load, const EquilibriumState& state) {
  if (state.drives.empty()) return 0.0;
  const DriveState& drive = state.drives[at(load.drive)];
  return load.by == BodyLoad::By::force ? drive.load : drive.shift;
}

/// Segment and ξ of a position along the undeformed surface; at a node the segment before it.
/// @throws std::invalid_argument if it is off the surface
std::pair<int, double> place_on(const MasterSurface& surface, double position) {
  const double length = surface.arc_length.back();
  constexpr double rounding = 1e-12;
  if (!surface.is_endless && !(position >= 0.0 && position <= length * (1.0 + rounding))) {
    throw std::invalid_argument(fmt::format("position {:g} m is off the master {}, 0 to {:g} m",
                                            position, surface.name, length));
  }
  int segment = 0;
  while (segment + 1 < surface.num_segments() &&
         surface.arc_length[at(segment + 1)] < position - rounding * length)
    ++segment;
  const double start = surface.arc_length[at(segment)];
  return {segment, (position - start) / (surface.arc_length[at(segment + 1)] - start)};
}

/// Moves `segment` towards the place where xi lies in [0, 1], one segment at a time and never
/// turning back.
class SegmentSearch {
 public:
  enum class Step { stay, moved, lost };

  Step look(const MasterSurface& surface, double xi, int& segment) {
    const int wanted = xi > 1.0 ? 1 : xi < 0.0 ? -1 : 0;
    if (wanted == 0 || wanted == -heading_) return Step::stay;
    const int next = segment + wanted;
    if (next < 0 || next >= surface.num_segments()) {
      const double beyond = wanted > 0 ? xi - 1.0 : -xi;
      return surface.is_endless || beyond <= rounding ? Step::stay : Step::lost;
    }
    segment = next;
    heading_ = wanted;
    return Step::moved;
  }

 private:
  static constexpr double rounding = 1e-9;  ///< by which a slave on the very end may seem beyond it
  int heading_ = 0;
};

}  // namespace

ContactLinearisation linearise_contact(const ContactPositions& positions, const FrictionLaw& law,
                                       double friction_factor, const LinearisationTerms& terms) {
  const SurfacePiece& master = positions.master;
  const bool is_prescribed = positions.assumption == ContactAssumption::subs_a;
  const bool has_fixed_normal = positions.assumption == ContactAssumption::subs_c;

  ContactLinearisation contact;
  const double guess = positions.prescribed.xi;
  contact.projection = is_prescribed ? positions.prescribed
                       : has_fixed_normal
                           ? project_along(master, positions.slave, positions.undeformed, guess)
                           : project(master, positions.slave, guess);
  const double xi = contact.projection.xi;
  const Eigen::Vector2d& tangent = contact.projection.tangent;
  const Eigen::Vector2d& normal = contact.projection.normal;
  const NodeWeights weights = weights_at(master.stencil, xi);
  const Eigen::Vector2d arm = positions.slave - master.combine(weights.value);
  const Eigen::Vector2d along = master.combine(weights.slope);
  const double height = normal.dot(arm);
  contact.gap = height;
  contact.slip_velocity = positions.driven_velocity * tangent.x();
  contact.direction = contact.slip_velocity < 0.0 ? -1.0 : 1.0;
  contact.friction = friction_factor * sliding_friction(law, contact.slip_velocity);
  contact.friction_slope =
      contact.direction * friction_factor * sliding_friction_slope(law, contact.slip_velocity);

  const double coefficient = contact.direction * contact.friction;
  const Eigen::Vector2d push = normal - coefficient * tangent;
  const PortVector along_normal = relative(master.stencil, weights, normal);
  const PortVector along_tangent = relative(master.stencil, weights, tangent);
  contact.gap_row = -along_normal;
  contact.tangent_row = along_tangent;
  contact.force_row = -relative(master.stencil, weights, push);
  const Eigen::Index size = along_normal.size();
  contact.force_by_position.setZero(size, size);
  contact.force_by_velocity.setZero(size, size);

  // How ξ, the angle of the normal and v_r change with the displacements.
  PortVector& shift = contact.shift_row.setZero(size);
  PortVector turn = PortVector::Zero(size);
  if (has_fixed_normal) {
    // Curvature of the undeformed surface, by ξ.
    const double turning = normal.dot(positions.undeformed.combine(weights.curvature)) /
                           positions.undeformed.combine(weights.slope).norm();
    shift = along_tangent / (tangent.dot(along) - height * turning);
    turn = turning * shift;
    if (terms.slope) contact.gap_row += normal.dot(along) * shift;
  } else if (!is_prescribed) {
    const double length = along.norm();
    const double turning = normal.dot(master.combine(weights.curvature)) / length;
    turn = on_nodes(master.stencil, weights.slope, normal / length);
    shift = (along_tangent + height * turn) / (length - height * turning);
    turn += turning * shift;
  }
  if (positions.roughness != nullptr) {
    const auto arc = [&](const std::array<double, max_stencil>& of) {
      return std::inner_product(of.begin(), of.end(), positions.arc_length.begin(), 0.0);
    };
    const RoughnessHeight rough = positions.roughness->at(arc(weights.value));
    contact.gap -= rough.value;
    if (terms.roughness) contact.gap_row += rough.slope * arc(weights.slope) * shift;
  }
  if (terms.turning_normal) contact.force_by_position += along_tangent * turn.transpose();
  if (terms.turning_friction)
    contact.force_by_position += coefficient * along_normal * turn.transpose();
  if (terms.shift) {
    contact.force_by_position += on_nodes(master.stencil, weights.slope, push) * shift.transpose();
  }
  if (terms.friction_slope) {
    const PortVector friction_row = contact.direction * contact.friction_slope * along_tangent;
    contact.force_by_position +=
        positions.driven_velocity * normal.x() * friction_row * turn.transpose();
    contact.force_by_velocity += friction_row * along_tangent.transpose();
  }
  return contact;
}

void set_roughness(ContactPositions& positions, const MasterSurface& surface, int segment) {
  positions.roughness = surface.roughness.is_smooth() ? nullptr : &surface.roughness;
  const Stencil stencil = surface.stencil(segment);
  for (int k = 0; k < stencil.count; ++k)
    positions.arc_length[at(k)] = surface.arc_length[at(stencil.first + k)];
}

std::vector<DriveState> drive_states(const System& system, double time) {
  std::vector<DriveState> states;
  states.reserve(system.drives.size());
  for (const Drive& drive : system.drives)
    states.push_back(
        {drive.velocity.value(time), drive.load.value(time), drive.shift.value(time)});
  return states;
}

EquilibriumState sliding_state(const System& system, double drive_displacement,
                               ContactGeometry geometry) {
  const auto last = std::numeric_limits<double>::infinity();
  return {drive_displacement, drive_states(system, last), 1.0, geometry, {}};
}

double drive_displacement_at(const System& system, int contact, double position) {
  const ContactPoint& point = system.contacts[at(contact)];
  if (point.face) {
    throw std::invalid_argument(fmt::format(
        "drive_displacement_at: {} stays where it is on its face", point.name));
  }
  if (point.space) {
    throw std::invalid_argument(fmt::format(
        "drive_displacement_at: the place of {} on a surface in space is no length", point.name));
  }
  const MasterSurface& surface = system.surfaces[at(point.surface)];
  const auto [segment, xi] = place_on(surface, position);
  const Segment undeformed = surface.undeformed_segment(segment);
  const Projection start = project(undeformed, point.slave_position);
  const double rate = system.path_share(point) * start.tangent.x();
  constexpr double negligible = 1e-9;
  if (std::abs(rate) < negligible) {
    throw std::invalid_argument(fmt::format(
        "drive_displacement_at: the drive does not move {} along its master", point.name));
  }
  return (xi - start.xi) * (undeformed.second - undeformed.first).norm() / rate;
}

namespace {

/// A contact while its equilibrium is sought.
struct SoughtContact {
  const ContactPoint* point = nullptr;
  const MasterSurface* surface = nullptr;  ///< null with two tangents
  const FacetSurface* facets = nullptr;    ///< of a contact on facets
  double path_share = 0.0;  ///< System::path_share()
  bool is_unilateral = false;
  Eigen::Index first_port = 0;  ///< among all
  Eigen::Index num_ports = 0;
  SegmentSearch search;
  FacetSearch facet_search;
  ContactEquilibrium result;

  bool has_two_tangents() const { return surface == nullptr; }
};

/// Place on its master that a contact is to have.
struct Target {
  int contact = 0;
  int segment = 0;
  double xi = 0.0;
};

/// Where the ports and rigid modes of one body stand among all, and its rows there.
struct BodyPorts {
  std::vector<int> ports;
  Eigen::MatrixXd rows;  ///< ports x modes
  Eigen::Index num_rigid = 0;
  Eigen::Index first_rigid = 0;
};

class Search {
 public:
  /// @param target where a contact is to stand; the displacement of the drive is sought then, from
  ///               that in `state`
  Search(const System& system, const EquilibriumState& state,
         const EquilibriumParameters& parameters, std::optional<Target> target = {})
      : system_(system), parameters_(parameters), target_(target) {
    if (!(state.friction_factor >= 0.0))
      throw std::invalid_argument("find_equilibrium: the friction factor is negative");
    if (!state.drives.empty() && state.drives.size() != system.drives.size()) {
      throw std::invalid_argument(fmt::format(
          "find_equilibrium: the state is of {} drives, the system has {}", state.drives.size(),
          system.drives.size()));
    }
    answer_.state = state;
    if (state.geometry == ContactGeometry::undeformed)
      answer_.state.terms.friction_damping = answer_.state.terms.geometric = false;
    for (const SystemBody& body : system.bodies) {
      BodyPorts ports;
      ports.num_rigid = (body.modal.omega.array() == 0.0).count();
      ports.first_rigid = num_rigid_;
      num_rigid_ += ports.num_rigid;
      bodies_.push_back(std::move(ports));
    }
    for (const ContactPoint& point : system.contacts) {
      contacts_.push_back(make_contact(point));
      contacts_.back().first_port = num_ports_;
      contacts_.back().num_ports = system.num_contact_ports(point);
      num_ports_ += contacts_.back().num_ports;
    }
    num_contacts_ = static_cast<Eigen::Index>(contacts_.size());
    unknowns_ = Eigen::VectorXd::Zero(num_ports_ + num_contacts_ + num_rigid_ + num_targets());
    if (target_) {
      contacts_[at(target_->contact)].result.segment = target_->segment;
      unknowns_(unknowns_.size() - 1) = state.drive_displacement;
    }
  }

  Equilibrium run() {
    answer_.status = find();
    if (answer_.status == EquilibriumStatus::converged) answer_.failure.clear();
    finish();
    return std::move(answer_);
  }

 private:
  SoughtContact make_contact(const ContactPoint& point) const {
    const EquilibriumState& state = answer_.state;
    SoughtContact contact;
    contact.point = &point;
    contact.path_share = system_.path_share(point);
    contact.is_unilateral = point.unilateral_from() < std::numeric_limits<double>::infinity();
    contact.result.segment = point.first_segment;
    if (point.has_two_tangents()) {
      contact.facets = system_.facets_of(point);
      if (point.space) contact.result.segment = point.space->first_facet;
      contact.result.ports.setZero(system_.num_master_ports(point) + 3);
      contact.result.drawn =
          velocity_of(point.slave_body) - velocity_of(system_.master_of(point));
      require_sliding(contact);
    } else {
      contact.surface = &system_.surfaces[at(point.surface)];
    }
    contact.result.positions.assumption = state.geometry == ContactGeometry::undeformed
                                              ? ContactAssumption::subs_a
                                              : point.assumption;
    contact.result.positions.driven_velocity =
        velocity_of(point.slave_body) - velocity_of(system_.master_of(point));
    return contact;
  }

  /// Friction of a contact in space that does not slide has no direction.
  void require_sliding(const SoughtContact& contact) const {
    const ContactPoint& point = *contact.point;
    const EquilibriumState& state = answer_.state;
    const bool spins = contact.facets != nullptr && !contact.facets->spin.isZero(0.0);
    const bool has_friction = state.friction_factor > 0.0 && state.terms.friction &&
                              point.friction.static_coefficient > 0.0;
    if (!point.space || contact.result.drawn != 0.0 || spins || !has_friction ||
        !state.terms.friction_damping)
      return;
    throw NumericalError(fmt::format(
        "equilibrium: '{}' does not slide, so that its friction has no direction; let a drive move its "
        "slave or its master, or its master spin, or leave friction out",
        point.name));
  }

  /// By the drive that a body follows, m/s.
  double velocity_of(int body) const {
    const int drive = system_.bodies[at(body)].drive;
    return drive < 0 || answer_.state.drives.empty() ? 0.0 : answer_.state.drives[at(drive)].velocity;
  }

  Eigen::Index num_targets() const { return target_ ? 1 : 0; }
  bool is_target(const SoughtContact& contact) const {
    return target_ && &contact == &contacts_[at(target_->contact)];
  }

  EquilibriumStatus find() {
    for (SoughtContact& contact : contacts_) {
      if (contact.has_two_tangents()) {
        if (!stand_on_facets(contact)) return lose(contact);
        continue;
      }
      if (is_target(contact)) {
        prescribe(contact);
        continue;
      }
      SegmentSearch search;
      SegmentSearch::Step step = SegmentSearch::Step::moved;
      while (step == SegmentSearch::Step::moved) {
        prescribe(contact);
        step = search.look(*contact.surface, contact.result.positions.prescribed.xi,
                           contact.result.segment);
        if (step == SegmentSearch::Step::lost) return lose(contact);
      }
    }
    for (int pass = 0; pass < parameters_.max_passes; ++pass) {
      gather();
      if (!iterate()) return EquilibriumStatus::not_converged;
      bool has_moved = false;
      for (SoughtContact& contact : contacts_) {
        if (is_target(contact)) continue;
        if (contact.has_two_tangents()) {
          const FacetSearch::Step step = look_for_facet(contact);
          if (step == FacetSearch::Step::lost) return lose(contact);
          has_moved = has_moved || step == FacetSearch::Step::moved;
          continue;
        }
        switch (contact.search.look(*contact.surface, contact.result.projection.xi,
                                    contact.result.segment)) {
          case SegmentSearch::Step::lost:
            return lose(contact);
          case SegmentSearch::Step::moved:
            has_moved = true;
            break;
          case SegmentSearch::Step::stay:
            break;
        }
      }
      if (!has_moved && !switch_contacts()) return EquilibriumStatus::converged;
    }
    answer_.failure = fmt::format("segments or open contacts still change after {} passes",
                                  parameters_.max_passes);
    return EquilibriumStatus::not_converged;
  }

  /// Puts a contact on the undeformed facet to which drives alone take it. @returns false where there is
  /// none
  bool stand_on_facets(SoughtContact& contact) const {
    ContactEquilibrium& result = contact.result;
    result.displaced = contact.path_share * answer_.state.drive_displacement;
    if (contact.facets == nullptr) return true;
    const TangentPorts rest = TangentPorts::Zero(result.ports.size());
    FacetSearch search;
    while (true) {
      project_on_facet(contact, rest);
      FacetPlace place{result.segment, result.place.x(), result.place.y()};
      const FacetSearch::Step step = search.look(*contact.facets, place);
      result.segment = place.facet;
      if (step != FacetSearch::Step::moved) return step == FacetSearch::Step::stay;
    }
  }

  void project_on_facet(SoughtContact& contact, const TangentPorts& ports) const {
    ContactEquilibrium& result = contact.result;
    const SpaceInstant instant = space_instant(*contact.point->space, contact.facets, result.segment,
                                               result.displaced, ports);
    result.place = closest_on(instant.deformed, instant.slave, result.place);
  }

  /// Moves a contact to the next facet where it stands beyond the edge of its own.
  FacetSearch::Step look_for_facet(SoughtContact& contact) {
    if (contact.facets == nullptr || answer_.state.geometry == ContactGeometry::undeformed)
      return FacetSearch::Step::stay;
    ContactEquilibrium& result = contact.result;
    FacetPlace place{result.segment, result.place.x(), result.place.y()};
    const FacetSearch::Step step = contact.facet_search.look(*contact.facets, place);
    result.segment = place.facet;
    return step;
  }

  EquilibriumStatus lose(const SoughtContact& contact) {
    if (contact.has_two_tangents()) {
      answer_.failure = fmt::format("{}: the slave point stands beyond the edge of the surface {}",
                                    contact.point->name, system_.master_name(*contact.point));
      return EquilibriumStatus::master_lost;
    }
    answer_.failure =
        fmt::format("{}: the slave point stands beyond the end of the surface {} ({:.6g} m long)",
                    contact.point->name, contact.surface->name, contact.surface->arc_length.back());
    return EquilibriumStatus::master_lost;
  }

  void prescribe(SoughtContact& contact) const {
    const double displacement = contact.path_share * answer_.state.drive_displacement;
    contact.result.positions.prescribed = contact.surface->project_undeformed(
        contact.result.segment, contact.point->slave_position + Eigen::Vector2d(displacement, 0.0));
  }

  /// Rows and static flexibility at the ports of the present segments.
  void gather() {
    for (BodyPorts& body : bodies_) body.ports.clear();
    std::vector<std::vector<int>> watched(bodies_.size());
    const auto watch_row = [&](int body, int port, int row) {
      bodies_[at(body)].ports.push_back(port);
      watched[at(body)].push_back(row);
    };
    const auto watch = [&](int body, int port, const PointRows& rows) {
      watch_row(body, port, rows.x);
      watch_row(body, port + 1, rows.y);
    };
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const SoughtContact& contact = contacts_[i];
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
              contact.surface->rows[at(stencil.first + k)]);
      }
    }

    flexibility_ = Eigen::MatrixXd::Zero(num_ports_, num_ports_);
    rigid_rows_ = Eigen::MatrixXd::Zero(num_ports_, num_rigid_);
    loaded_ = Eigen::VectorXd::Zero(num_ports_);
    rigid_load_ = Eigen::VectorXd::Zero(num_rigid_);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const ModalBody& modal = system_.bodies[b].modal;
      BodyPorts& body = bodies_[b];
      // Rigid modes come first, ω ascending.
      const Eigen::Index num_elastic = modal.size() - body.num_rigid;
      const auto columns = Eigen::seqN(body.first_rigid, body.num_rigid);
      const Eigen::VectorXd load = load_on(system_.bodies[b]);
      rigid_load_(columns) = load.head(body.num_rigid);
      if (body.ports.empty()) continue;

      body.rows = modal.rows(watched[b], Eigen::all);
      rigid_rows_(body.ports, columns) = body.rows.leftCols(body.num_rigid);
      const auto elastic = body.rows.rightCols(num_elastic);
      flexibility_(body.ports, body.ports) = elastic * answer_of(modal, elastic.transpose());
      loaded_(body.ports) = elastic * answer_of(modal, load.tail(num_elastic));
    }
  }

  /// On the modes of a body: loads of drives and what it holds.
  Eigen::VectorXd load_on(const SystemBody& body) const {
    Eigen::VectorXd load = Eigen::VectorXd::Zero(body.modal.size());
    for (const BodyLoad& one : body.loads)
      load += size_of(one, answer_.state) * body.modal.rows.row(one.row).transpose();
    // BLAS takes no empty matrix.
    if (body.held_load.size() > 0) load += body.modal.shapes.transpose() * body.held_load;
    return load;
  }

  /// What constant forces do to the elastic modes of a body: (diag(ω²) + N)⁻¹ f.
  static Eigen::MatrixXd answer_of(const ModalBody& body, const Eigen::MatrixXd& forces) {
    const auto squares = body.omega.tail(forces.rows()).array().square();
    if (body.coupled.is_empty()) return squares.inverse().matrix().asDiagonal() * forces;
    // Circulatory terms do not act on rigid modes, which come first.
    Eigen::MatrixXd stiffness =
        body.coupled.position.bottomRightCorner(forces.rows(), forces.rows());
    stiffness.diagonal() += squares.matrix();
    return stiffness.partialPivLu().solve(forces);
  }

  /// Positions of a contact for given displacements of its ports.
  void place(SoughtContact& contact, const PortVector& ports) const {
    if (contact.has_two_tangents()) {
      contact.result.ports.head(ports.size()) = ports;
      contact.result.displaced = contact.path_share * answer_.state.drive_displacement;
      if (contact.facets != nullptr && answer_.state.geometry == ContactGeometry::deformed)
        project_on_facet(contact, contact.result.ports);
      return;
    }
    prescribe(contact);
    const Eigen::Vector2d& origin = contact.surface->positions[at(contact.result.segment)];
    ContactPositions& positions = contact.result.positions;
    positions.slave = contact.point->slave_position - origin + ports.head<2>();
    positions.slave.x() += contact.path_share * answer_.state.drive_displacement;
    positions.undeformed = contact.surface->undeformed_piece(contact.result.segment);
    positions.master = positions.undeformed;
    set_roughness(positions, *contact.surface, contact.result.segment);
    for (int k = 0; k < positions.master.stencil.count; ++k)
      positions.master.nodes[at(k)] += ports.segment<2>(2 + 2 * k);
  }

  /// The equations
  ///
  ///   z − z_load − S_r a + R B_Eᵀλ = 0,   gap = 0 (or λ = 0),   S_rᵀ B_Eᵀλ − load_r = 0
  ///
  /// for the displacements z of the ports, λ and the rigid amplitudes a, in this order; with a
  /// target, ξ of its contact for the displacement of the drive at the end.
  struct Equations {
    Eigen::VectorXd values;
    Eigen::VectorXd scale;       ///< what each of them is made of
    Eigen::MatrixXd derivative;  ///< with respect to the unknowns
    double residual = 0.0;       ///< largest value by scale
  };

  Equations evaluate(const Eigen::VectorXd& unknowns) {
    const Eigen::Index size = unknowns.size();
    const Eigen::Index first_rigid = num_ports_ + num_contacts_;
    if (target_) answer_.state.drive_displacement = unknowns(size - 1);
    Equations equations{Eigen::VectorXd::Zero(size), Eigen::VectorXd::Zero(size),
                        Eigen::MatrixXd::Zero(size, size), 0.0};
    equations.values.segment(first_rigid, num_rigid_) = -rigid_load_;
    equations.scale.segment(first_rigid, num_rigid_) = rigid_load_.cwiseAbs();
    double length = 0.0;
    if (num_contacts_ > 0) {
      equations.values.head(num_ports_) = unknowns.head(num_ports_) - loaded_ -
                                          rigid_rows_ * unknowns.segment(first_rigid, num_rigid_);
      equations.derivative.topLeftCorner(num_ports_, num_ports_).setIdentity();
      equations.derivative.block(0, first_rigid, num_ports_, num_rigid_) = -rigid_rows_;
      length = unknowns.head(num_ports_).cwiseAbs().maxCoeff();
    }
    for (Eigen::Index i = 0; i < num_contacts_; ++i)
      length = std::max(length, add_contact(equations, i, unknowns));
    equations.scale.head(first_rigid).setConstant(length);
    if (target_) equations.scale(size - 1) = length;
    for (Eigen::Index k = 0; k < size; ++k) {
      const double value = std::abs(equations.values(k));
      // Zero by zero where nothing loads the equation: it is satisfied.
      if (value > 0.0)
        equations.residual = std::max(equations.residual, value / equations.scale(k));
    }
    if (!equations.values.allFinite()) equations.residual = std::numeric_limits<double>::infinity();
    return equations;
  }

  /// A force law at a normal force; all zero where that is not positive, as if it were rigid.
  struct LawState {
    double indentation = 0.0;     ///< y(λ)
    double compliance = 0.0;      ///< dy/dλ
    double friction = 0.0;        ///< T/λ with the friction T
    double friction_slope = 0.0;  ///< dT/dλ − T/λ
  };

  LawState law_state(const SoughtContact& contact, double force) const {
    if (!(force > 0.0)) return {};
    const ContactPositions& positions = contact.result.positions;
    const double slip = positions.driven_velocity * positions.prescribed.tangent.x();
    const double direction = slip < 0.0 ? -1.0 : 1.0;
    const SubstrateForces found = contact.point->substrate->under(force, slip, direction);
    const double stiffness = found.normal.by_indentation;
    const double against = -direction * answer_.state.friction_factor;
    const double friction = against * found.tangential.value / force;
    return {found.indentation, 1.0 / stiffness, friction,
            against * found.tangential.by_indentation / stiffness - friction};
  }

  /// A contact with two tangents at its ports; the gap is less its overlap.
  ContactLinearisation linearised_face(const SoughtContact& contact) const {
    const EquilibriumState& state = answer_.state;
    ContactLinearisation local = linearise_face(
        tangent_kinematics(system_, *contact.point, contact.result, state.geometry, state.terms),
        contact.num_ports, contact.point->friction, state.friction_factor, state.terms);
    local.gap -= contact.point->overlap;
    return local;
  }

  /// Adds what a contact contributes and notes its state. @returns the largest length in it, m
  double add_contact(Equations& equations, Eigen::Index index, const Eigen::VectorXd& unknowns) {
    const Eigen::Index row = num_ports_ + index;
    const Eigen::Index last = unknowns.size() - 1;
    SoughtContact& contact = contacts_[static_cast<std::size_t>(index)];
    const Eigen::Index first = contact.first_port;
    const Eigen::Index width = contact.num_ports;
    place(contact, unknowns.segment(first, width));
    const ContactPositions& positions = contact.result.positions;
    const double force = unknowns(row);
    const bool has_law = contact.point->substrate.has_value();
    LawState law = has_law ? law_state(contact, force) : LawState();
    if (!has_law) {
      law.compliance = contact.point->compliance();
      law.indentation = law.compliance * force;
    }
    const ContactLinearisation local =
        contact.has_two_tangents() ? linearised_face(contact)
        : has_law
            ? linearise_contact(positions, constant_friction(law.friction), 1.0)
            : linearise_contact(positions, contact.point->friction, answer_.state.friction_factor);
    ContactEquilibrium& result = contact.result;
    result.projection = local.projection;
    result.gap = local.gap;
    result.force = force;
    result.friction = local.friction;
    result.direction = local.direction;
    result.friction_force = local.direction * local.friction * force * local.sliding_direction.x();
    result.friction_across = local.friction * force * local.sliding_direction.y();
    result.slip_velocity = local.slip_velocity;
    result.velocity = local.velocity;

    auto& [values, scale, derivative, residual] = equations;
    const PortMatrix by_position = force * local.force_by_position;
    const PortVector by_drive = contact.path_share * by_position.col(0);
    const auto flexibility = flexibility_.middleCols(first, width);
    values.head(num_ports_) += flexibility * (force * local.force_row);
    derivative.block(0, first, num_ports_, width) += flexibility * by_position;
    // ∂(λ b_E)/∂λ: the friction of a force law is not proportional to λ.
    const PortVector by_force =
        local.force_row + local.direction * law.friction_slope * local.tangent_row;
    derivative.col(row).head(num_ports_) = flexibility * by_force;
    if (target_) derivative.col(last).head(num_ports_) += flexibility * by_drive;

    const Eigen::Index first_rigid = num_ports_ + num_contacts_;
    const auto rigid = rigid_rows_.middleRows(first, width).transpose();
    values.segment(first_rigid, num_rigid_) += rigid * (force * local.force_row);
    scale.segment(first_rigid, num_rigid_) +=
        rigid.cwiseAbs() * (force * local.force_row).cwiseAbs();
    derivative.block(first_rigid, first, num_rigid_, width) = rigid * by_position;
    derivative.col(row).segment(first_rigid, num_rigid_) = rigid * by_force;
    if (target_) derivative.col(last).segment(first_rigid, num_rigid_) += rigid * by_drive;

    if (result.is_closed) {
      values(row) = local.gap + law.indentation;
      derivative.block(row, first, 1, width) = -local.gap_row.transpose();
      derivative(row, row) = law.compliance;
      if (target_) derivative(row, last) = -local.gap_row[0] * contact.path_share;
    } else {
      values(row) = force;
      derivative(row, row) = 1.0;
    }
    if (contact.has_two_tangents())
      return std::max({contact.point->overlap, std::abs(law.indentation),
                       loaded_.segment(first, width).cwiseAbs().maxCoeff(), length_of(contact)});
    const double segment_length = positions.master.chord().norm();
    if (is_target(contact)) {
      values(last) = segment_length * (local.projection.xi - target_->xi);
      derivative.block(last, first, 1, width) = segment_length * local.shift_row.transpose();
      derivative(last, last) = segment_length * local.shift_row[0] * contact.path_share;
    }
    const Eigen::Vector2d& T1 = positions.master.nodes[at(positions.master.stencil.before)];
    return std::max(segment_length, (positions.slave - T1).norm());
  }

  /// By which the rounding of gaps in space is measured: the distance of the slave from the place that
  /// it is seen from. On faces gaps are those of displacements alone.
  double length_of(const SoughtContact& contact) const {
    if (!contact.point->space) return 0.0;
    const SpaceInstant instant =
        space_instant(*contact.point->space, contact.facets, contact.result.segment,
                      contact.result.displaced, contact.result.ports);
    return instant.slave.norm();
  }

  /// Newton's method for the present segments and open contacts. Goes one step further than the
  /// tolerance asks for, which is cheap and takes the error down to rounding.
  /// @returns false where it does not converge; `failure` says how
  bool iterate() {
    constexpr double smallest_fraction = 1e-4;
    Equations present = evaluate(unknowns_);
    for (int iteration = 0; iteration < parameters_.max_iterations; ++iteration) {
      const bool is_converged = present.residual <= parameters_.tolerance;
      const Eigen::VectorXd step = solve(present);
      ++answer_.iterations;
      double fraction = 1.0;
      Equations next = evaluate(unknowns_ - step);
      while (!(next.residual < present.residual) && !is_converged && fraction > smallest_fraction) {
        fraction *= 0.5;
        next = evaluate(unknowns_ - fraction * step);
      }
      const bool has_improved = next.residual < present.residual;
      if (has_improved) {
        unknowns_ -= fraction * step;
        present = std::move(next);
      } else {
        evaluate(unknowns_);
      }
      answer_.residual = present.residual;
      if (is_converged) return true;
      if (!has_improved) break;
    }
    answer_.failure = fmt::format("the residual stays at {:.3g} after {} Newton steps",
                                  answer_.residual, answer_.iterations);
    return false;
  }

  /// Newton step. Rows and columns are brought to the same size first: they mix m, N and m kg^½.
  Eigen::VectorXd solve(const Equations& equations) const {
    const Eigen::Index size = unknowns_.size();
    if (size == 0) return {};
    Eigen::MatrixXd matrix = equations.derivative;
    Eigen::VectorXd row_scale = Eigen::VectorXd::Ones(size);
    Eigen::VectorXd column_scale = Eigen::VectorXd::Ones(size);
    const auto inverse_root = [](double largest) {
      return largest > 0.0 ? 1.0 / std::sqrt(largest) : 1.0;
    };
    constexpr int num_balancings = 4;
    for (int k = 0; k < num_balancings; ++k) {
      const Eigen::VectorXd rows = matrix.cwiseAbs().rowwise().maxCoeff().unaryExpr(inverse_root);
      const Eigen::VectorXd columns =
          matrix.cwiseAbs().colwise().maxCoeff().transpose().unaryExpr(inverse_root);
      matrix = rows.asDiagonal() * matrix * columns.asDiagonal();
      row_scale.array() *= rows.array();
      column_scale.array() *= columns.array();
    }
    const Eigen::PartialPivLU<Eigen::MatrixXd> factor(matrix);
    constexpr double singular_below = 1e-14;
    // The estimate of the condition is not made for pivots that vanish.
    const double smallest_pivot = factor.matrixLU().diagonal().cwiseAbs().minCoeff();
    if (!(smallest_pivot > singular_below) || !(factor.rcond() > singular_below))
      refuse_singular(matrix);
    return column_scale.cwiseProduct(factor.solve(row_scale.cwiseProduct(equations.values)).eval());
  }

  [[noreturn]] void refuse_singular(const Eigen::MatrixXd& matrix) const {
    if (!matrix.allFinite()) throw NumericalError("equilibrium: the equations are not finite");
    // The direction of the smallest pivot, however small that is.
    Eigen::FullPivLU<Eigen::MatrixXd> factor(matrix);
    const double smallest = std::abs(factor.matrixLU().diagonal().tail<1>().value());
    factor.setThreshold(smallest > 0.0 ? 2.0 * smallest / factor.maxPivot() : 0.0);
    const Eigen::VectorXd free = factor.kernel().col(0).cwiseAbs();
    const Eigen::VectorXd rigid = free.segment(num_ports_ + num_contacts_, num_rigid_);
    constexpr double negligible = 1e-3;
    if (num_rigid_ > 0 && rigid.maxCoeff() > negligible * free.maxCoeff()) {
      Eigen::Index mode = 0;
      rigid.maxCoeff(&mode);
      std::size_t b = 0;
      while (mode >= bodies_[b].first_rigid + bodies_[b].num_rigid) ++b;
      throw NumericalError(
          fmt::format("equilibrium: the body '{}' is free to move: neither its supports nor closed "
                      "contacts hold it, or friction jams them",
                      system_.bodies[b].name));
    }
    Eigen::Index contact = 0;
    free.segment(num_ports_, num_contacts_).maxCoeff(&contact);
    throw NumericalError(
        fmt::format("equilibrium: the force of {} is undetermined: friction jams it, or other "
                    "contacts hold the same motion",
                    contacts_[static_cast<std::size_t>(contact)].point->name));
  }

  /// Opens unilateral contacts that pull and closes those that penetrate. All at once as long as
  /// that may lead somewhere, then only the worst one, so that it does not go in circles.
  /// @returns whether there was any
  bool switch_contacts() {
    constexpr int free_switches = 10;
    double largest_force = 0.0;
    double largest_length = 0.0;
    for (const SoughtContact& contact : contacts_) {
      largest_force = std::max(largest_force, std::abs(contact.result.force));
      largest_length = std::max(
          largest_length, contact.has_two_tangents()
                              ? std::max(contact.result.ports.cwiseAbs().maxCoeff(), length_of(contact))
                              : contact.result.positions.master.chord().norm());
    }
    SoughtContact* worst = nullptr;
    double worst_violation = 0.0;
    for (SoughtContact& contact : contacts_) {
      if (!contact.is_unilateral) continue;
      const double violation = contact.result.is_closed ? -contact.result.force / largest_force
                                                        : -contact.result.gap / largest_length;
      if (!(violation > 100.0 * parameters_.tolerance)) continue;
      if (num_switches_ < free_switches) toggle(contact);
      if (violation > worst_violation) {
        worst = &contact;
        worst_violation = violation;
      }
    }
    if (worst == nullptr) return false;
    if (num_switches_ >= free_switches) toggle(*worst);
    ++num_switches_;
    for (SoughtContact& contact : contacts_) {
      contact.search = {};
      contact.facet_search = {};
    }
    return true;
  }

  void toggle(SoughtContact& contact) {
    contact.result.is_closed = !contact.result.is_closed;
    unknowns_(num_ports_ + (&contact - contacts_.data())) = 0.0;
  }

  /// Along the first tangent in space, radius times angle on a face, m.
  double position_of(const SoughtContact& contact) const {
    const ContactPoint& point = *contact.point;
    if (point.face) return point.face->radius * point.face->angle;
    const SpaceInstant instant = space_instant(*point.space, contact.facets, contact.result.segment,
                                               contact.result.displaced, contact.result.ports);
    const Eigen::Vector3d material = space_geometry(instant, contact.result.place).material;
    const Eigen::Vector3d from = contact.facets == nullptr
                                     ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                     : Eigen::Vector3d(contact.facets->origin(contact.result.segment) -
                                                       contact.facets->positions.front());
    return (from + material).dot(point.space->reference);
  }

  /// Displacements of all modes, and the places on the masters.
  void finish() {
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(num_ports_);
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      ContactEquilibrium& result = contacts_[i].result;
      const SoughtContact& contact = contacts_[i];
      if (contact.has_two_tangents()) {
        result.position = position_of(contact);
        forces.segment(contact.first_port, contact.num_ports) =
            -result.force * linearised_face(contact).force_row;
        answer_.contacts.push_back(result);
        continue;
      }
      result.position = contact.surface->arc_at(result.segment, result.projection.weights);
      const ContactRows rows = make_rows(result.projection, result.friction, result.direction);
      const ContactRow& pushed = rows.equilibrium;
      auto ports = forces.segment(contact.first_port, contact.num_ports);
      ports.head<2>() << pushed.slave[0], pushed.slave[1];
      for (Eigen::Index k = 2; k < contact.num_ports; ++k)
        ports(k) = pushed.master[at(static_cast<int>(k) - 2)];
      ports *= -result.force;
      result.positions.roughness = nullptr;  // of a system that the answer may outlive
      answer_.contacts.push_back(result);
    }
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const ModalBody& modal = system_.bodies[b].modal;
      const BodyPorts& body = bodies_[b];
      Eigen::VectorXd modes = Eigen::VectorXd::Zero(modal.size());
      if (!body.ports.empty() && body.rows.size() > 0)
        modes = body.rows.transpose() * forces(body.ports);
      modes += load_on(system_.bodies[b]);
      const Eigen::Index num_elastic = modal.size() - body.num_rigid;
      modes.tail(num_elastic) = answer_of(modal, modes.tail(num_elastic));
      modes.head(body.num_rigid) =
          unknowns_.segment(num_ports_ + num_contacts_ + body.first_rigid, body.num_rigid);
      answer_.displacement.push_back(std::move(modes));
    }
  }

  const System& system_;
  EquilibriumParameters parameters_;
  std::optional<Target> target_;
  Equilibrium answer_;
  std::vector<SoughtContact> contacts_;
  std::vector<BodyPorts> bodies_;
  Eigen::Index num_contacts_ = 0;
  Eigen::Index num_ports_ = 0;
  Eigen::Index num_rigid_ = 0;
  int num_switches_ = 0;
  Eigen::VectorXd unknowns_;     ///< displacements of the ports, contact forces, rigid amplitudes
  Eigen::MatrixXd flexibility_;  ///< R = S diag(1/ω²) Sᵀ over the elastic modes, m/N
  Eigen::MatrixXd rigid_rows_;   ///< S_r
  Eigen::VectorXd loaded_;       ///< displacements of the ports by the load, elastic, m
  Eigen::VectorXd rigid_load_;   ///< load on the rigid modes
};

}  // namespace

namespace {

/// Bodies that nothing touches or loads: at rest where they are, even where nothing holds them.
std::optional<Equilibrium> at_rest(const System& system, const EquilibriumState& state) {
  const bool is_loaded = std::any_of(
      system.bodies.begin(), system.bodies.end(), [&](const SystemBody& body) {
        return body.held_load.size() > 0 ||
               std::any_of(body.loads.begin(), body.loads.end(),
                           [&](const BodyLoad& load) { return size_of(load, state) != 0.0; });
      });
  if (!system.contacts.empty() || is_loaded) return std::nullopt;
  Equilibrium rest;
  rest.status = EquilibriumStatus::converged;
  rest.state = state;
  for (const SystemBody& body : system.bodies)
    rest.displacement.push_back(Eigen::VectorXd::Zero(body.modal.size()));
  return rest;
}

}  // namespace

Equilibrium find_equilibrium(const System& system, const EquilibriumState& state,
                             const EquilibriumParameters& parameters) {
  if (std::optional<Equilibrium> rest = at_rest(system, state)) return *std::move(rest);
  return Search(system, state, parameters).run();
}

Equilibrium find_equilibrium_at(const System& system, int contact, double position,
                                const EquilibriumState& state,
                                const EquilibriumParameters& parameters) {
  EquilibriumState start = state;
  start.drive_displacement = drive_displacement_at(system, contact, position);
  const bool is_prescribed = state.geometry == ContactGeometry::undeformed ||
                             system.contacts[at(contact)].assumption == ContactAssumption::subs_a;
  if (is_prescribed) return find_equilibrium(system, start, parameters);
  const auto [segment, xi] =
      place_on(system.surfaces[at(system.contacts[at(contact)].surface)], position);
  return Search(system, start, parameters, Target{contact, segment, xi}).run();
}

void apply_initial_motion(System& system, const Equilibrium& equilibrium) {
  if (equilibrium.status != EquilibriumStatus::converged)
    throw std::invalid_argument("apply_initial_motion: the equilibrium has not converged");
  if (equilibrium.state.drive_displacement != 0.0) {
    throw std::invalid_argument(fmt::format(
        "apply_initial_motion: a run starts with the drive at 0, the equilibrium has it "
        "at {:g} m",
        equilibrium.state.drive_displacement));
  }
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    SystemBody& body = system.bodies[b];
    // BLAS takes no empty matrix.
    if (body.modal.size() > 0)
      body.initial_displacement = body.modal.shapes * equilibrium.displacement[b];
    body.initial_velocity = Eigen::VectorXd::Zero(body.initial_displacement.size());
  }
}

}  // namespace stridor
