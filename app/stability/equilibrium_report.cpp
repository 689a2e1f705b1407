#include "app/stability/equilibrium_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>

namespace stridor {
namespace {

/// Displacement of a point of a body, without that of the drive.
Json displacement_json(const System& system, const Equilibrium& equilibrium, int body,
                       const PointRows& rows) {
  const auto b = static_cast<std::size_t>(body);
  const Eigen::MatrixXd& shapes = system.bodies[b].modal.rows;
  const Eigen::VectorXd& modal = equilibrium.displacement[b];
  return {number(shapes.row(rows.x).dot(modal)), number(shapes.row(rows.y).dot(modal))};
}

const char* range_text(LawRange range) {
  switch (range) {
    case LawRange::inside:
      return "inside";
    case LawRange::no_contact:
      return "no contact";
    case LawRange::too_deep:
      return "deeper than the contact law was made for (y/R > 0.3)";
    case LawRange::beyond_data:
      return "at a speed or indentation beyond the data of the contact law";
  }
  return "";
}

/// On the face of a body.
Json face_contact_json(const System& system, const Equilibrium& equilibrium, std::size_t i) {
  const ContactEquilibrium& contact = equilibrium.contacts[i];
  const ContactPoint& point = system.contacts[i];
  const FacePlace& face = *point.face;
  return {
      {"closed", contact.is_closed},
      {"force", number(contact.force)},
      {"friction_force", number(contact.friction_force)},
      {"friction_across", number(contact.friction_across)},
      {"friction", number(contact.friction)},
      {"velocity", {number(contact.velocity.x()), number(contact.velocity.y())}},
      {"slip_velocity", number(contact.slip_velocity)},
      {"gap", number(contact.gap)},
      {"radius", face.radius},
      {"angle", face.angle},
      {"displacement", displacement_json(system, equilibrium, point.slave_body, point.slave_rows)}};
}

/// In space, with forces, velocity and displacement as vectors.
Json space_contact_json(const System& system, const Equilibrium& equilibrium, std::size_t i) {
  const ContactEquilibrium& contact = equilibrium.contacts[i];
  const ContactPoint& point = system.contacts[i];
  const SpaceInstant instant =
      space_instant(*point.space, system.facets_of(point), contact.segment, contact.displaced,
                    contact.ports, contact.drawn);
  const SpaceFrame frame = space_geometry(instant, contact.place).frame;
  const auto vector = [](const Eigen::Vector3d& v) -> Json {
    return {number(v.x()), number(v.y()), number(v.z())};
  };
  const auto tangential = [&](double along, double across) {
    return vector(along * frame.tangents[0] + across * frame.tangents[1]);
  };
  return {{"closed", contact.is_closed},
          {"force", number(contact.force)},
          {"friction_force", number(contact.friction_force)},
          {"friction_across", number(contact.friction_across)},
          {"friction", number(contact.friction)},
          {"slip_velocity", number(contact.slip_velocity)},
          {"position", number(contact.position)},
          {"gap", number(contact.gap)},
          {"normal", vector(frame.normal)},
          {"friction_on_slave", tangential(contact.friction_force, contact.friction_across)},
          {"sliding_velocity", tangential(-contact.velocity.x(), -contact.velocity.y())},
          {"displacement", vector(contact.ports.tail<3>())}};
}

Json contact_json(const System& system, const Equilibrium& equilibrium, std::size_t i) {
  const ContactEquilibrium& contact = equilibrium.contacts[i];
  const ContactPoint& point = system.contacts[i];
  if (point.face) return face_contact_json(system, equilibrium, i);
  if (point.space) return space_contact_json(system, equilibrium, i);
  Json object = {
      {"closed", contact.is_closed},
      {"force", number(contact.force)},
      {"friction_force", number(contact.friction_force)},
      {"friction", number(contact.friction)},
      {"direction", contact.direction},
      {"slip_velocity", number(contact.slip_velocity)},
      {"position", number(contact.position)},
      {"gap", number(contact.gap)},
      {"angle", number(std::atan2(contact.projection.tangent.y(), contact.projection.tangent.x()))},
      {"displacement", displacement_json(system, equilibrium, point.slave_body, point.slave_rows)}};
  if (!point.substrate || !contact.is_closed) return object;
  const SubstrateContact& law = *point.substrate;
  const SubstrateForces forces = law.at(-contact.gap, contact.slip_velocity, contact.direction);
  object["indentation"] = number(-contact.gap / law.indentation_unit);
  object["area"] = number(law.area(-contact.gap, contact.slip_velocity));
  object["damping"] = number(-forces.tangential.by_slip);
  object["law_range"] = range_text(forces.range);
  return object;
}

}  // namespace

Json equilibrium_json(const Model& model, const Equilibrium& equilibrium) {
  const System& system = model.system;
  Json object;
  if (system.contacts.size() == 1) {
    object = contact_json(system, equilibrium, 0);
  } else {
    for (std::size_t i = 0; i < system.contacts.size(); ++i)
      object["contacts"][system.contacts[i].name] = contact_json(system, equilibrium, i);
  }
  object["drive_displacement"] = number(equilibrium.state.drive_displacement);
  object["residual"] = number(equilibrium.residual);
  object["points"] = Json::object();
  for (const auto& [name, point] : model.points) {
    object["points"][name.body + "." + name.point] =
        displacement_json(system, equilibrium, point.body, point.rows);
  }
  return object;
}

namespace {

void print_contact(const ContactPoint& point, const ContactEquilibrium& contact) {
  if (!contact.is_closed) {
    fmt::print("{:<20}open, gap {:.4g} m\n", point.name, contact.gap);
    return;
  }
  const std::optional<FacePlace>& face = point.face;
  const std::string place =
      face ? fmt::format("at radius {:.6g} m and {:.4g} rad of {}", face->radius, face->angle,
                         face->name)
      : point.space ? fmt::format("{:.6g} m along {}", contact.position, point.space->name)
                    : fmt::format("{:.6g} m along the master", contact.position);
  fmt::print("{:<20}{}, force {:.6g} N, friction {:.6g} N, sliding at {:.4g} m/s{}\n", point.name,
             place, contact.force, std::hypot(contact.friction_force, contact.friction_across),
             contact.slip_velocity,
             contact.force < 0.0    ? " (pulls: no equilibrium of real bodies)"
             : contact.force == 0.0 ? " (nothing presses: give a load, or normal.preload)"
                                    : "");
}

/// Many points of a pair in two lines.
void print_pair(const std::string& name, std::span<const ContactEquilibrium> contacts) {
  struct {
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    void include(double value) {
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
  } force, speed;
  double whole_force = 0.0;
  double friction = 0.0;
  std::size_t num_closed = 0;
  std::size_t num_pulling = 0;
  for (const ContactEquilibrium& contact : contacts) {
    if (!contact.is_closed) continue;
    ++num_closed;
    if (contact.force < 0.0) ++num_pulling;
    force.include(contact.force);
    speed.include(contact.slip_velocity);
    whole_force += contact.force;
    friction += std::hypot(contact.friction_force, contact.friction_across);
  }
  fmt::print("{:<20}{} of {} points closed", name, num_closed, contacts.size());
  if (num_closed > 0) {
    fmt::print(
        ", force {:.6g} N in all, {:.4g} to {:.4g} N each, friction {:.6g} N,\n"
        "{:<20}sliding at {:.4g} to {:.4g} m/s",
        whole_force, force.lowest, force.highest, friction, "", speed.lowest, speed.highest);
  }
  if (num_pulling > 0) fmt::print("; {} of them pull: no equilibrium of real bodies", num_pulling);
  if (num_closed > 0 && force.lowest == 0.0 && force.highest == 0.0)
    fmt::print(" (nothing presses: give a load, or normal.preload)");
  fmt::print("\n");
}

}  // namespace

void print_equilibrium(const System& system, const Equilibrium& equilibrium) {
  constexpr std::size_t most_listed = 20;  // points of a pair
  const std::span<const ContactEquilibrium> contacts = equilibrium.contacts;
  for (std::size_t first = 0; first < contacts.size();) {
    const std::string pair = system.contacts[first].pair();
    std::size_t end = first + 1;
    while (end < contacts.size() && system.contacts[end].pair() == pair) ++end;
    if (end - first > most_listed) {
      print_pair(pair, contacts.subspan(first, end - first));
    } else {
      for (std::size_t i = first; i < end; ++i) print_contact(system.contacts[i], contacts[i]);
    }
    first = end;
  }
}

/// Where a contact law is used beyond its range.
void print_law_ranges(const Json& equilibrium) {
  const auto print = [](const Json& contact) {
    if (!contact.contains("law_range") || contact["law_range"] == "inside") return;
    fmt::print("{:<20}is {}\n", "", contact["law_range"].get<std::string>());
  };
  print(equilibrium);
  if (!equilibrium.contains("contacts")) return;
  for (const Json& contact : equilibrium["contacts"]) print(contact);
}

}  // namespace stridor
