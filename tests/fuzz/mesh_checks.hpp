// What holds of every mesh that a reader accepts, and of every refusal.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

#include "core/errors.hpp"
#include "io/imports/mesh_draft.hpp"

namespace stridor::fuzz {

inline void expect_that(bool holds) {
  if (!holds) std::abort();
}

inline void expect_consistent(const ImportedMesh& read) {
  const Mesh& mesh = read.mesh;
  expect_that(mesh.num_elements() > 0 && mesh.dimension() >= 2);
  expect_that(mesh.nodes.array().isFinite().all());
  expect_that(mesh.node_labels.size() == mesh.num_nodes());
  expect_that(mesh.first_node.size() == mesh.num_elements() + 1);
  expect_that(mesh.first_node.back() == mesh.connectivity.size());
  const auto num_nodes = static_cast<int>(mesh.num_nodes());
  const auto num_elements = static_cast<int>(mesh.num_elements());
  for (const int node : mesh.connectivity) expect_that(node >= 0 && node < num_nodes);
  const auto expect_members = [](const auto& sets, int size) {
    for (const auto& [name, members] : sets) {
      int last = -1;
      for (const int member : members) {
        expect_that(member > last && member < size);
        last = member;
      }
    }
  };
  expect_members(mesh.node_sets, num_nodes);
  expect_members(mesh.element_sets, num_elements);
  for (const auto& [name, sides] : mesh.surfaces) {
    for (const ElementSide& side : sides) {
      expect_that(side.element >= 0 && side.element < num_elements);
      const ShapeFacts& facts = facts_of(mesh.shapes[static_cast<std::size_t>(side.element)]);
      expect_that(side.side >= 0 && side.side < static_cast<int>(facts.sides.size()));
    }
  }
}

/// Every refusal names the source and a place in it.
inline void expect_placed(const ConfigError& error, const std::string& source) {
  for (const Problem& problem : error.problems()) {
    expect_that(problem.source == source && !problem.message.empty());
    expect_that(problem.line >= 1 || problem.message.rfind("byte ", 0) == 0);
  }
}

}  // namespace stridor::fuzz
