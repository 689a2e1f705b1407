// What drives do in an equilibrium, and how a run starts from one.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/sought_contact.hpp"

namespace stridor {

std::vector<DriveState> drive_states(const System& system, double time) {
  std::vector<DriveState> states;
  states.reserve(system.drives.size());
  for (const Drive& drive : system.drives)
    states.push_back({drive.velocity.value(time), drive.load.value(time), drive.shift.value(time)});
  return states;
}

EquilibriumState sliding_state(const System& system, double drive_displacement,
                               ContactGeometry geometry) {
  const auto last = std::numeric_limits<double>::infinity();
  return {drive_displacement, drive_states(system, last), 1.0, geometry, {}};
}

double drive_displacement_at(const System& system, int contact, double position) {
  const ContactPoint& point = system.contacts[static_cast<std::size_t>(contact)];
  if (point.face) {
    throw std::invalid_argument(
        fmt::format("drive_displacement_at: {} stays where it is on its face", point.name));
  }
  if (point.space) {
    throw std::invalid_argument(fmt::format(
        "drive_displacement_at: the place of {} on a surface in space is no length", point.name));
  }
  const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(point.surface)];
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
