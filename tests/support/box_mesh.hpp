// Boxes of bricks whose height is along y, as meshes of bodies in space, and their slices in the plane.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <numeric>
#include <vector>

#include "substructures/bodies/mesh_body.hpp"

namespace stridor::test {

/// Edges of a box from its lowest corner, and elements along each.
struct Box {
  std::array<double, 3> size{0.1, 0.02, 0.03};
  std::array<int, 3> elements{8, 2, 1};
  std::array<double, 3> corner{0.0, 0.0, 0.0};
};

/// Nodes numbered as they are asked for by their place on a grid of half elements.
class GridNodes {
 public:
  explicit GridNodes(const Box& box) : box_(box) {}
  int operator()(int i, int j, int k) {
    const auto [found, is_new] =
        numbers_.emplace(std::array{i, j, k}, static_cast<int>(places_.size()));
    if (is_new) {
      const std::array at{i, j, k};
      Eigen::RowVector3d place;
      for (std::size_t a = 0; a < 3; ++a) {
        place(static_cast<Eigen::Index>(a)) =
            box_.corner[a] + box_.size[a] * at[a] / (2.0 * box_.elements[a]);
      }
      places_.push_back(place);
    }
    return found->second;
  }
  void put(Mesh& mesh) const {
    mesh.nodes.resize(static_cast<Eigen::Index>(places_.size()), 3);
    for (std::size_t n = 0; n < places_.size(); ++n)
      mesh.nodes.row(static_cast<Eigen::Index>(n)) = places_[n];
    mesh.node_labels.resize(places_.size());
    std::iota(mesh.node_labels.begin(), mesh.node_labels.end(), 1);
  }

 private:
  Box box_;
  std::map<std::array<int, 3>, int> numbers_;
  std::vector<Eigen::RowVector3d> places_;
};

/// Of hex8 or hex20.
inline Mesh brick_mesh(const Box& box, ElementShape shape) {
  Mesh mesh;
  GridNodes node(box);
  for (int ey = 0; ey < box.elements[1]; ++ey) {
    for (int ez = 0; ez < box.elements[2]; ++ez) {
      for (int ex = 0; ex < box.elements[0]; ++ex) {
        // z, x, y are right-handed: the base lies below.
        const auto n = [&](int a, int b, int c) {
          return node(2 * ex + b, 2 * ey + c, 2 * ez + a);
        };
        std::vector<int> nodes{n(0, 0, 0), n(2, 0, 0), n(2, 2, 0), n(0, 2, 0),
                               n(0, 0, 2), n(2, 0, 2), n(2, 2, 2), n(0, 2, 2)};
        if (shape == ElementShape::hex20) {
          for (const int other : {n(1, 0, 0), n(2, 1, 0), n(1, 2, 0), n(0, 1, 0), n(1, 0, 2),
                                  n(2, 1, 2), n(1, 2, 2), n(0, 1, 2), n(0, 0, 1), n(2, 0, 1),
                                  n(2, 2, 1), n(0, 2, 1)})
            nodes.push_back(other);
        }
        mesh.add_element(shape, nodes, static_cast<std::int64_t>(mesh.num_elements()) + 1);
      }
    }
  }
  node.put(mesh);
  return mesh;
}

/// The slice of a box, of quad8.
inline Mesh slice_mesh(const Box& box) {
  Mesh mesh;
  GridNodes node(box);
  for (int ey = 0; ey < box.elements[1]; ++ey) {
    for (int ex = 0; ex < box.elements[0]; ++ex) {
      const auto n = [&](int a, int b) { return node(2 * ex + a, 2 * ey + b, 0); };
      const std::array nodes{n(0, 0), n(2, 0), n(2, 2), n(0, 2), n(1, 0), n(2, 1), n(1, 2), n(0, 1)};
      mesh.add_element(ElementShape::quad8, nodes,
                       static_cast<std::int64_t>(mesh.num_elements()) + 1);
    }
  }
  node.put(mesh);
  mesh.nodes.col(2).setZero();
  return mesh;
}

/// A body from a mesh of a box with its sides as surfaces.
inline MeshBodyParameters box_body(const Box& box, Mesh mesh) {
  MeshBodyParameters body;
  body.material = {7e10, 0.3, 2700.0};
  const bool is_spatial = facts_of(mesh.shapes.front()).dimension == 3;
  const auto side = [&](const char* name, std::size_t axis, double sign) {
    MeshPlaneParameters plane;
    plane.normal.assign(is_spatial ? 3 : 2, 0.0);
    plane.normal[axis] = sign;
    plane.offset = sign > 0.0 ? box.corner[axis] + box.size[axis] : -box.corner[axis];
    body.surfaces[name].plane = plane;
  };
  side("top", 1, 1.0);
  side("bottom", 1, -1.0);
  side("left", 0, -1.0);
  side("right", 0, 1.0);
  if (!is_spatial) {
    body.thickness = box.size[2];
    body.plane = PlaneState::strain;
  }
  body.mesh = std::make_shared<const Mesh>(std::move(mesh));
  return body;
}

}  // namespace stridor::test
