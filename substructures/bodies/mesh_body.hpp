// Bodies from meshes.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/beam.hpp"
#include "substructures/bodies/body_parameters.hpp"
#include "substructures/bodies/mesh_attachments.hpp"
#include "substructures/bodies/mesh_material.hpp"
#include "substructures/bodies/mesh_spin.hpp"
#include "substructures/bodies/mesh_surface_parameters.hpp"
#include "substructures/bodies/surface_springs.hpp"
#include "substructures/elements/elastic_law.hpp"
#include "substructures/elements/mesh.hpp"

namespace stridor {

/// All elements of a mesh as they are drawn.
std::vector<DrawnElement> drawn_elements(const Mesh& mesh);

/// A linear elastic body from a mesh file (docs/theory.md, 1.7). Places, regions and surfaces are
/// in the frame of the mesh, which `angle` turns about z into that of the body.
struct MeshBodyParameters : BodyParametersOf<MeshBodyParameters> {
  static constexpr const char* type_name = "mesh";

  std::string file;
  std::string length_unit = "m";    ///< of the coordinates in the file
  std::optional<double> mesh_size;  ///< of the elements of a geometry that is meshed, m
  int mesh_order = 2;               ///< 1: linear elements, 2: with nodes in the middle of edges
  std::optional<double> thickness;  ///< of a planar mesh, m
  PlaneState plane = PlaneState::stress;
  double angle = 0.0;  ///< rad
  MeshMaterialParameters material;
  std::map<std::string, MeshMaterialParameters> materials;  ///< by element set
  RayleighDamping damping;
  std::map<std::string, MeshSurfaceParameters> surfaces;
  std::map<std::string, MeshSupportParameters> supports;
  std::optional<MeshGuideParameters> guided;
  std::optional<MeshSpinParameters> spin;
  std::map<std::string, MeshPointParameters> points;
  std::map<std::string, MeshRigidRegionParameters> rigid_regions;
  std::map<std::string, MeshTieParameters> ties;
  std::map<std::string, MeshMassParameters> masses;
  std::map<std::string, MeshLoadParameters> loads;
  std::map<std::string, SurfaceSpringParameters> springs;
  InterfaceParameters interface;
  std::optional<ReductionParameters> reduction;  ///< absent: every unknown is kept
  std::shared_ptr<const Mesh> mesh;              ///< of `file`, as it is there
  std::string kept_mesh;                         ///< file of the mesh of a geometry; else empty
  static const Schema& schema();

  /// @throws ConfigError
  double metres_per_unit() const;

  std::vector<NamedFile> files() override;
  void read(const BodyFiles& files) override;
  bool take_contents(const BodyParameters& other) override;
  BodyMatrices make() const override;
  RayleighDamping* own_damping() override { return &damping; }
  double* own_spin() override { return spin ? &spin->speed : nullptr; }
  std::vector<Problem> warnings() const override;
  std::optional<int> num_modes() const override;
  std::optional<double> interface_spacing() const override { return interface.spacing; }
  std::optional<int> interface_modes() const override { return interface.modes; }
  bool is_filled() const override;
  bool is_spatial() const override;
  std::vector<DrawnElement> elements() const override;
  double num_slave_nodes(const std::string& name) const override;
  ReductionSize reduction_size(double interface_nodes) const override;
  SizeKey size_key() const override;
  std::optional<ImportFacts> import_facts() const override;
};

}  // namespace stridor
