// One contact while an equilibrium is sought.
#pragma once

#include <utility>

#include "coupling/system/system.hpp"
#include "solvers/equilibrium/equilibrium.hpp"

namespace stridor {

/// Segment and ξ of a position along the undeformed surface; at a node the segment before it.
/// @throws std::invalid_argument if it is off the surface
std::pair<int, double> place_on(const MasterSurface& surface, double position);

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

/// A contact while its equilibrium is sought.
struct SoughtContact {
  const ContactPoint* point = nullptr;
  const MasterSurface* surface = nullptr;  ///< null with two tangents
  const FacetSurface* facets = nullptr;    ///< of a contact on facets
  double path_share = 0.0;                 ///< System::path_share()
  bool is_unilateral = false;
  Eigen::Index first_port = 0;  ///< among all
  Eigen::Index num_ports = 0;
  SegmentSearch search;
  FacetSearch facet_search;
  ContactEquilibrium result;

  bool has_two_tangents() const { return surface == nullptr; }
};

/// A contact at its first segment or facet.
/// @throws NumericalError if its friction has no direction
SoughtContact sought_contact(const System& system, const EquilibriumState& state,
                             const ContactPoint& point);

/// Puts a contact where the drive alone takes it.
void prescribe(SoughtContact& contact, double drive_displacement);

/// Puts a contact on the undeformed facet to which drives alone take it. @returns false where there
/// is none
bool stand_on_facets(SoughtContact& contact, double drive_displacement);

/// Moves a contact to the next facet where it stands beyond the edge of its own.
FacetSearch::Step look_for_facet(SoughtContact& contact, ContactGeometry geometry);

/// Positions of a contact for given displacements of its ports.
void place(SoughtContact& contact, const EquilibriumState& state, const PortVector& ports);

/// A force law at a normal force; all zero where that is not positive, as if it were rigid.
struct LawState {
  double indentation = 0.0;     ///< y(λ)
  double compliance = 0.0;      ///< dy/dλ
  double friction = 0.0;        ///< T/λ with the friction T
  double friction_slope = 0.0;  ///< dT/dλ − T/λ
};

LawState law_state(const SoughtContact& contact, double force, double friction_factor);

/// A contact with two tangents at its ports; the gap is less its overlap.
ContactLinearisation linearised_face(const System& system, const EquilibriumState& state,
                                     const SoughtContact& contact);

/// By which the rounding of gaps in space is measured: the distance of the slave from the place
/// that it is seen from, m. On faces gaps are those of displacements alone.
double length_of(const SoughtContact& contact);

/// Along the first tangent in space, radius times angle on a face, m.
double position_of(const SoughtContact& contact);

}  // namespace stridor
