// Shape of a master surface between its nodes.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>

namespace stridor {

enum class SurfaceKind {
  polyline,  ///< straight segments between the nodes
  smooth,    ///< cubic segments through the nodes, with a continuous tangent
};

/// Nodes that a place on a segment may depend on.
inline constexpr int max_stencil = 4;

/// The nodes that shape one segment of a surface, T1 to T2, one after the other.
struct Stencil {
  int first = 0;   ///< node of the surface
  int count = 2;   ///< 2: straight; 3 or 4: smooth
  int before = 0;  ///< how many of them come before T1
};

/// Number of nodes that shape a segment of a surface; the same for all its segments.
inline int stencil_size(SurfaceKind kind, int num_nodes) {
  return kind == SurfaceKind::polyline ? 2 : std::min(num_nodes, max_stencil);
}

/// Stencil of a segment. At the ends of a smooth surface it reaches further inwards, so that it
/// always has the same size.
inline Stencil make_stencil(SurfaceKind kind, int num_nodes, int segment) {
  const int count = stencil_size(kind, num_nodes);
  const int first = count == 2 ? segment : std::clamp(segment - 1, 0, num_nodes - count);
  return {first, count, segment - first};
}

/// Weights of the nodes of a stencil at a place ξ of its segment, 0 at T1 and 1 at T2, with their
/// first and second derivatives by ξ: M = Σ w_k x_k is a point of the surface, Σ w'_k x_k has the
/// direction of its tangent. Entries beyond the stencil are zero.
struct NodeWeights {
  std::array<double, max_stencil> value{1.0, 0.0, 0.0, 0.0};
  std::array<double, max_stencil> slope{-1.0, 1.0, 0.0, 0.0};
  std::array<double, max_stencil> curvature{};
};

/// Weights of a segment (docs/theory.md, 2.5).
///
/// A straight one has 1 − ξ and ξ. A smooth one is the cubic through T1 and T2 with the tangents
/// (T2 − T0)/2 at T1 and (T3 − T1)/2 at T2 (Catmull-Rom), T0 and T3 being the neighbours. Where one
/// is missing, the other is mirrored at the end node, T0 = 2 T1 − T2. Both reproduce straight lines
/// and sum to 1.
/// @param xi also outside [0, 1], where the cubic of this segment continues
inline NodeWeights weights_at(const Stencil& stencil, double xi) {
  NodeWeights weights;
  if (stencil.count == 2) {
    weights.value = {1.0 - xi, xi, 0.0, 0.0};
    return weights;
  }
  const double square = xi * xi;
  // Of T0, T1, T2, T3.
  const double value[] = {xi * (-0.5 + xi * (1.0 - 0.5 * xi)), 1.0 + square * (1.5 * xi - 2.5),
                          xi * (0.5 + xi * (2.0 - 1.5 * xi)), square * (0.5 * xi - 0.5)};
  const double slope[] = {-0.5 + xi * (2.0 - 1.5 * xi), xi * (4.5 * xi - 5.0),
                          0.5 + xi * (4.0 - 4.5 * xi), xi * (1.5 * xi - 1.0)};
  const double curvature[] = {2.0 - 3.0 * xi, 9.0 * xi - 5.0, 4.0 - 9.0 * xi, 3.0 * xi - 1.0};
  const auto T1 = static_cast<std::size_t>(stencil.before);
  const auto place = [&](const double(&of)[4], std::array<double, max_stencil>& on) {
    on = {};
    on[T1] = of[1];
    on[T1 + 1] = of[2];
    if (stencil.before > 0) {
      on[T1 - 1] = of[0];
    } else {
      on[T1] += 2.0 * of[0];
      on[T1 + 1] -= of[0];
    }
    if (stencil.before + 2 < stencil.count) {
      on[T1 + 2] = of[3];
    } else {
      on[T1 + 1] += 2.0 * of[3];
      on[T1] -= of[3];
    }
  };
  place(value, weights.value);
  place(slope, weights.slope);
  place(curvature, weights.curvature);
  return weights;
}

/// One segment of a surface with the nodes that shape it, wherever they are.
struct SurfacePiece {
  Stencil stencil;
  std::array<Eigen::Vector2d, max_stencil> nodes;

  /// Σ of the nodes with given weights.
  Eigen::Vector2d combine(const std::array<double, max_stencil>& weights) const {
    Eigen::Vector2d sum = weights[0] * nodes[0] + weights[1] * nodes[1];
    for (std::size_t k = 2; k < static_cast<std::size_t>(stencil.count); ++k)
      sum += weights[k] * nodes[k];
    return sum;
  }
  /// T2 − T1.
  Eigen::Vector2d chord() const {
    const auto T1 = static_cast<std::size_t>(stencil.before);
    return nodes[T1 + 1] - nodes[T1];
  }
};

}  // namespace stridor
