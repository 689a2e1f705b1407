// Annuli about z, as meshes of bodies of revolution.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "substructures/bodies/mesh_body.hpp"
#include "tests/support/element_meshes.hpp"

namespace stridor::test {

struct Annulus {
  double inner_radius = 0.08, outer_radius = 0.16, thickness = 0.012;
  std::array<int, 3> elements{2, 24, 1};  ///< along the radius, around, across
};

/// Of elements of one shape; nodes lie on circles about z, the middle plane is z = 0.
inline Mesh annulus_mesh(const Annulus& annulus, ElementShape shape) {
  // Unrolled: radius, angle in turns, height.
  Mesh mesh = box_mesh(shape, annulus.elements,
                       {annulus.outer_radius - annulus.inner_radius, 1.0, annulus.thickness});
  std::vector<int> number(mesh.num_nodes());
  std::vector<Eigen::RowVector3d> places;
  const auto at = [&](const Eigen::RowVector3d& unrolled) -> Eigen::RowVector3d {
    const double angle = 2.0 * std::numbers::pi * unrolled.y();
    const double radius = annulus.inner_radius + unrolled.x();
    return {radius * std::cos(angle), radius * std::sin(angle),
            unrolled.z() - 0.5 * annulus.thickness};
  };
  for (std::size_t node = 0; node < mesh.num_nodes(); ++node) {
    const Eigen::RowVector3d place = at(mesh.nodes.row(static_cast<Eigen::Index>(node)));
    std::size_t same = 0;
    while (same < places.size() && (places[same] - place).norm() > 1e-9) ++same;
    number[node] = static_cast<int>(same);
    if (same == places.size()) places.push_back(place);
  }
  for (int& node : mesh.connectivity) node = number[static_cast<std::size_t>(node)];
  mesh.nodes.resize(static_cast<Eigen::Index>(places.size()), 3);
  mesh.node_labels.clear();
  for (std::size_t node = 0; node < places.size(); ++node) {
    mesh.nodes.row(static_cast<Eigen::Index>(node)) = places[node];
    mesh.node_labels.push_back(static_cast<std::int64_t>(node) + 1);
  }
  return mesh;
}

/// A body of steel from it, with its sides as surfaces.
inline MeshBodyParameters annulus_body(const Annulus& annulus, ElementShape shape) {
  MeshBodyParameters body;
  body.material = {2.1e11, 0.3, 7850.0};
  for (const auto& [name, radius] : {std::pair("bore", annulus.inner_radius),
                                     std::pair("rim", annulus.outer_radius)}) {
    MeshCylinderParameters cylinder;
    cylinder.radius = radius;
    body.surfaces[name].cylinder = cylinder;
  }
  for (const auto& [name, sign] : {std::pair("top", 1.0), std::pair("bottom", -1.0)}) {
    MeshPlaneParameters plane;
    plane.normal = {0.0, 0.0, sign};
    plane.offset = 0.5 * annulus.thickness;
    body.surfaces[name].plane = plane;
  }
  body.mesh = std::make_shared<const Mesh>(annulus_mesh(annulus, shape));
  return body;
}

}  // namespace stridor::test
