// Beams of rectangular section as plane-stress meshes.
#pragma once

#include "core/schema.hpp"
#include "substructures/bodies/body_parameters.hpp"
#include "substructures/bodies/surface_springs.hpp"
#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

enum class Support {
  free,
  clamped,  ///< all nodes of the end are held
  pinned,   ///< the node on the axis is held, the end may turn
  guided,   ///< all nodes share one vertical displacement, on which the drive's load acts, and
            ///< follow the drive's horizontal motion; the end cannot turn
};

struct MaterialParameters {
  double youngs_modulus = 0.0;  ///< E, Pa, > 0
  double poissons_ratio = 0.0;  ///< ν, in (−1, 0.5)
  double density = 0.0;         ///< ρ, kg/m³, > 0
  static const Schema& schema();
};

struct MeshParameters {
  int along = 0;    ///< elements along the axis, >= 1
  int through = 0;  ///< elements through the thickness, >= 1
  static const Schema& schema();
};

struct SupportParameters {
  Support start = Support::free;
  Support end = Support::free;
  static const Schema& schema();
};

struct InterfaceParameters {
  std::optional<double> spacing;  ///< distance of the master nodes kept, m; all nodes where absent
  std::optional<int> modes{};     ///< in which it moves; in all of its DoFs where absent
  static const Schema& schema();
};

struct ReductionParameters {
  int fixed_interface_modes = 0;  ///< number of Craig-Bampton modes kept, >= 0
  static const Schema& schema();
};

/// A point on a surface of a beam.
struct BeamPointParameters {
  std::string on;   ///< a surface
  double at = 0.0;  ///< along it from its first node, m, >= 0
  static const Schema& schema();
};

/// Motion of a beam across its plane.
enum class AcrossMotion {
  held,
  rigid,  ///< along z, all of it alike
};

struct BeamParameters : BodyParametersOf<BeamParameters> {
  static constexpr const char* type_name = "beam";

  double length = 0.0;     ///< along the axis, m, > 0
  double thickness = 0.0;  ///< in the plane, m, > 0
  double width = 0.0;      ///< out of the plane, m, > 0
  double angle = 0.0;      ///< of the axis from start to end against +x, rad
  MaterialParameters material;
  MeshParameters mesh;
  RayleighDamping damping;
  SupportParameters supports;
  std::map<std::string, BeamPointParameters> points;
  std::map<std::string, SurfaceSpringParameters> springs;
  AcrossMotion across = AcrossMotion::held;
  InterfaceParameters interface;
  ReductionParameters reduction;
  static const Schema& schema();

  BodyMatrices make() const override;
  RayleighDamping* own_damping() override { return &damping; }
  std::optional<int> num_modes() const override { return reduction.fixed_interface_modes; }
  std::optional<double> interface_spacing() const override { return interface.spacing; }
  std::optional<int> interface_modes() const override { return interface.modes; }
  bool is_filled() const override { return true; }
  std::vector<DrawnElement> elements() const override;
  double num_slave_nodes(const std::string& name) const override;
  double num_master_nodes(const std::string& name) const override;
  ReductionSize reduction_size(double interface_nodes) const override;
  SizeKey size_key() const override;
  std::vector<Problem> warnings() const override;
};

/// Size of the reduction of a mesh of a beam or an elastic pad.
/// @param interface_nodes kept, with two unknowns each
ReductionSize size_of(const MeshParameters& mesh, const ReductionParameters& reduction,
                      double interface_nodes);

/// Structured mesh of Q8 elements, supports applied.
///
/// The axis starts at the origin of the body's frame. Named points: `start_bottom`, `start_top`,
/// `end_bottom`, `end_top` (corners; "top" is on the left of the axis direction), `start`, `end`
/// (on the axis), `tip` (the lowest corner of the start; the bottom one on a tie) and, where
/// exactly one end is free, `free_end` (its top corner). Surfaces: `top`, `bottom`, `start_face`,
/// `end_face`. Points of the scene stand between nodes of the edge of an element as its shape
/// functions have it (docs/theory.md, 10.7).
///
/// A beam that moves across as a rigid body has one more DoF, its displacement along z, with its
/// whole mass. Springs add to the stiffness; spread over a surface each node has the share of an
/// even load, Simpson's weights.
///
/// @param parameters all within the ranges of the schema
/// @throws ConfigError for points and springs on what is not there
/// @throws std::invalid_argument if both ends are guided (the drive would have two loads to carry)
BodyMatrices make_beam(const BeamParameters& parameters);

}  // namespace stridor
