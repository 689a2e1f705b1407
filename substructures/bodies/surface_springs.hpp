// Loads and springs on surfaces of bodies.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/spring_stiffness.hpp"
#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// A node with its part in a load, a spring, or the displacement of a point.
struct NodeShare {
  int node = 0;
  double share = 0.0;
};
using NodeShares = std::vector<NodeShare>;

/// A spring to the ground, with a damper or without, spread evenly over a surface or at a point.
struct SurfaceSpringParameters {
  std::string on;  ///< a surface or point
  SpringMatrixParameters stiffness;
  std::optional<DamperMatrixParameters> damping{};  ///< of a damper beside it
  std::optional<SpringDirectionParameters> direction{};  ///< of a stiffness along one
  static const Schema& schema();
};

/// Every DoF once, ascending, with the sum of its weights.
DofSum merged(DofSum all);

/// Σ share u of nodes along x (0), y (1) or z (2); every DoF once.
DofSum sum_of(const BodyMatrices& body, const NodeShares& shares, std::size_t axis);

/// A point that moves as Σ share u of nodes.
/// @param at its place in the frame of the body, m
void add_dependent_point(const std::string& name, const Eigen::Vector3d& at,
                         const NodeShares& shares, BodyMatrices& body);

/// A point of which the displacements along x, y and z are given as sums.
void add_dependent_point(const std::string& name, const Eigen::Vector3d& at,
                         std::array<DofSum, 3> sums, BodyMatrices& body);

/// Loads of 1 N along x, y and z that nodes share, BodyMatrices::loads: "<name>.<x|y|z>".
void add_surface_loads(const std::string& name, const NodeShares& shares, BodyMatrices& body);

/// Adds the stiffness of springs, the damping of dampers (to BodyMatrices::velocity), and what the
/// springs exert when their ground ends move.
/// @param shares_of the nodes that a spring on a surface or point holds; empty where there is none
///                  of this name
/// @throws ConfigError, with keys below that of the body, where there is no such surface or point
void add_surface_springs(const std::map<std::string, SurfaceSpringParameters>& springs,
                         const std::function<NodeShares(const std::string& on)>& shares_of,
                         const std::vector<std::string>& known_names, BodyMatrices& body);

}  // namespace stridor
