#include "coupling/kinematics/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "coupling/system/system.hpp"

namespace stridor {
namespace {

using Eigen::Vector2d;

/// A surface through nodes that lie anywhere near a line, at uneven distances.
MasterSurface wavy_surface(SurfaceKind kind, int num_nodes, std::mt19937& generator) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  MasterSurface surface;
  surface.kind = kind;
  double arc = 0.0;
  for (int k = 0; k < num_nodes; ++k) {
    // One after the other: the order in which arguments are evaluated is the compiler's.
    const double x = k + 0.2 * unit(generator);
    surface.positions.emplace_back(x, 0.3 * unit(generator));
    surface.rows.push_back({2 * k, 2 * k + 1});
    if (k > 0)
      arc += (surface.positions.back() - surface.positions[surface.rows.size() - 2]).norm();
    surface.arc_length.push_back(arc);
  }
  return surface;
}

Vector2d point_of(const MasterSurface& surface, int segment, double xi) {
  const SurfacePiece piece = surface.undeformed_piece(segment);
  return surface.positions[static_cast<std::size_t>(segment)] +
         piece.combine(weights_at(piece.stencil, xi).value);
}

Vector2d slope_of(const MasterSurface& surface, int segment, double xi) {
  const SurfacePiece piece = surface.undeformed_piece(segment);
  return piece.combine(weights_at(piece.stencil, xi).slope);
}

TEST(SmoothSurface, PositionAndNormalAreContinuousAtEveryNode) {
  // A few roundings on numbers of order 10.
  constexpr double rounding = 1e-14;
  std::mt19937 generator(1);
  for (const int num_nodes : {3, 4, 5, 9}) {
    const MasterSurface surface = wavy_surface(SurfaceKind::smooth, num_nodes, generator);
    for (int s = 0; s < surface.num_segments(); ++s) {
      const auto node = static_cast<std::size_t>(s);
      EXPECT_LT((point_of(surface, s, 0.0) - surface.positions[node]).norm(), rounding);
      EXPECT_LT((point_of(surface, s, 1.0) - surface.positions[node + 1]).norm(), rounding);
      if (s == 0) continue;
      // One-sided limits of the whole derivative, so of the normal, too.
      EXPECT_LT((slope_of(surface, s - 1, 1.0) - slope_of(surface, s, 0.0)).norm(), rounding)
          << num_nodes << " nodes, at node " << s;
      const auto arc = [&](int segment, double xi) {
        const NodeWeights weights = weights_at(surface.stencil(segment), xi);
        return Vector2d(surface.arc_at(segment, weights.value),
                        surface.arc_slope(segment, weights.slope));
      };
      EXPECT_LT((arc(s - 1, 1.0) - arc(s, 0.0)).norm(), rounding);
    }
  }
}

TEST(SmoothSurface, APolylineHasAKinkThere) {
  std::mt19937 generator(1);
  const MasterSurface surface = wavy_surface(SurfaceKind::polyline, 5, generator);
  EXPECT_GT((slope_of(surface, 0, 1.0) - slope_of(surface, 1, 0.0)).norm(), 0.01);
}

TEST(SmoothSurface, EndsLieAlongTheirSegments) {
  // The mirrored neighbour T0 = 2 T1 − T2 makes the tangent at T1 that of the segment.
  std::mt19937 generator(2);
  for (const int num_nodes : {3, 4, 7}) {
    const MasterSurface surface = wavy_surface(SurfaceKind::smooth, num_nodes, generator);
    const int last = surface.num_segments() - 1;
    const auto chord = [&](int s) { return surface.undeformed_piece(s).chord(); };
    EXPECT_LT((slope_of(surface, 0, 0.0) - chord(0)).norm(), 1e-14);
    EXPECT_LT((slope_of(surface, last, 1.0) - chord(last)).norm(), 1e-14);
  }
}

TEST(NodeWeights, HaveTheirDerivatives) {
  // A cubic is its Taylor polynomial; the third derivative is the slope of the second.
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> place(-0.5, 1.5);
  for (const Stencil stencil : {Stencil{0, 2, 0}, Stencil{0, 3, 0}, Stencil{0, 3, 1},
                                Stencil{0, 4, 0}, Stencil{0, 4, 1}, Stencil{0, 4, 2}}) {
    const NodeWeights start = weights_at(stencil, 0.0);
    const NodeWeights end = weights_at(stencil, 1.0);
    for (int i = 0; i < 20; ++i) {
      const double xi = place(generator);
      const double step = place(generator);
      const NodeWeights here = weights_at(stencil, xi);
      const NodeWeights there = weights_at(stencil, xi + step);
      double sum = 0.0;
      for (std::size_t k = 0; k < max_stencil; ++k) {
        const double third = end.curvature[k] - start.curvature[k];
        EXPECT_NEAR(there.value[k],
                    here.value[k] + step * (here.slope[k] +
                                            step * (here.curvature[k] / 2.0 + step * third / 6.0)),
                    1e-13);
        EXPECT_NEAR(there.slope[k], here.slope[k] + step * (here.curvature[k] + step * third / 2.0),
                    1e-13);
        EXPECT_NEAR(there.curvature[k], here.curvature[k] + step * third, 1e-13);
        sum += here.value[k];
        if (static_cast<int>(k) >= stencil.count) {
          EXPECT_EQ(here.value[k], 0.0);
        }
      }
      EXPECT_NEAR(sum, 1.0, 1e-14);
    }
  }
}

TEST(Stencil, HasTheSameSizeOnEverySegment) {
  for (const int num_nodes : {2, 3, 4, 5, 101}) {
    const int size = stencil_size(SurfaceKind::smooth, num_nodes);
    EXPECT_EQ(size, std::min(num_nodes, 4));
    EXPECT_EQ(stencil_size(SurfaceKind::polyline, num_nodes), 2);
    for (int segment = 0; segment + 1 < num_nodes; ++segment) {
      for (const SurfaceKind kind : {SurfaceKind::polyline, SurfaceKind::smooth}) {
        const Stencil stencil = make_stencil(kind, num_nodes, segment);
        EXPECT_EQ(stencil.count, stencil_size(kind, num_nodes));
        EXPECT_EQ(stencil.first + stencil.before, segment);
        EXPECT_GE(stencil.first, 0);
        EXPECT_LE(stencil.first + stencil.count, num_nodes);
      }
    }
  }
}

/// A straight surface with a node every 1 mm, inclined.
MasterSurface straight_surface(SurfaceKind kind, int num_nodes) {
  MasterSurface surface;
  surface.kind = kind;
  for (int k = 0; k < num_nodes; ++k) {
    surface.positions.emplace_back(8e-4 * k, 6e-4 * k);
    surface.rows.push_back({2 * k, 2 * k + 1});
    surface.arc_length.push_back(1e-3 * k);
  }
  return surface;
}

TEST(SmoothSurface, AStraightOneIsThePolyline) {
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const int num_nodes : {2, 3, 4, 8}) {
    const MasterSurface smooth = straight_surface(SurfaceKind::smooth, num_nodes);
    const MasterSurface polyline = straight_surface(SurfaceKind::polyline, num_nodes);
    for (int s = 0; s < smooth.num_segments(); ++s) {
      const auto T1 = static_cast<std::size_t>(s);
      const Vector2d slave = smooth.positions[T1] + unit(generator) * Vector2d(8e-4, 6e-4) +
                             1e-5 * unit(generator) * Vector2d(-0.6, 0.8);
      const Projection curve = smooth.project_undeformed(s, slave);
      const Projection line = polyline.project_undeformed(s, slave);
      // Positions of 1e-2 m are rounded to 1e-18, 1e-15 of a segment.
      EXPECT_NEAR(curve.xi, line.xi, 1e-14);
      EXPECT_LT((curve.tangent - line.tangent).norm(), 1e-14);
      EXPECT_NEAR(smooth.arc_at(s, curve.weights), polyline.arc_at(s, line.weights), 1e-17);
    }
  }
}

TEST(SmoothSurface, ProjectionIsOrthogonalFromAnyGuess) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 5000; ++trial) {
    const MasterSurface surface = wavy_surface(SurfaceKind::smooth, 5, generator);
    const int s = trial % 4;
    const SurfacePiece piece = surface.undeformed_piece(s);
    const double xi = unit(generator);
    const NodeWeights weights = weights_at(piece.stencil, xi);
    const Vector2d tangent = piece.combine(weights.slope).normalized();
    const double gap = 0.02 * (unit(generator) - 0.5);
    const Vector2d slave = piece.combine(weights.value) + gap * turned_left(tangent);
    for (const double guess : {0.0, xi, 1.0, 7.0}) {
      const Projection projection = project(piece, slave, guess);
      EXPECT_NEAR(projection.xi, xi, 1e-13);
      EXPECT_LT((projection.tangent - tangent).norm(), 1e-12);
      EXPECT_NEAR(projection.normal.dot(slave - piece.combine(projection.weights)), gap, 1e-14);
    }
  }
}

TEST(SmoothSurface, NeighboursAgreeOnWhichSideOfANodeASlaveStands) {
  // The function that vanishes at the projection is continuous there; on a polyline it is not.
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int disagreements_of_polyline = 0;
  for (int trial = 0; trial < 500; ++trial) {
    MasterSurface surface = wavy_surface(SurfaceKind::smooth, 6, generator);
    const Vector2d slave =
        surface.positions[3] + Vector2d(0.1 * unit(generator), 0.1 * unit(generator));
    const auto is_beyond_left = [&] { return surface.project_undeformed(2, slave).xi > 1.0; };
    const auto is_before_right = [&] { return surface.project_undeformed(3, slave).xi < 0.0; };
    EXPECT_NE(is_beyond_left(), is_before_right());
    surface.kind = SurfaceKind::polyline;
    disagreements_of_polyline += is_beyond_left() == is_before_right() ? 1 : 0;
  }
  EXPECT_GT(disagreements_of_polyline, 0);
}

TEST(SmoothSurface, BeyondItsSegmentAProjectionSaysOnWhichSide) {
  std::mt19937 generator(7);
  const MasterSurface surface = wavy_surface(SurfaceKind::smooth, 9, generator);
  for (int s = 0; s < surface.num_segments(); ++s) {
    for (int other = 0; other < surface.num_segments(); ++other) {
      const double xi = surface.project_undeformed(s, point_of(surface, other, 0.5)).xi;
      EXPECT_EQ(xi > 1.0, other > s);
      EXPECT_EQ(xi < 0.0, other < s);
    }
  }
}

TEST(SmoothSurface, RowsShareTheForceAmongTheNodes) {
  // Forces on the master add up to the opposite of that on the slave, and have the same moment
  // about any point where the slave touches: the weights reproduce straight lines and the point.
  std::mt19937 generator(8);
  const MasterSurface surface = wavy_surface(SurfaceKind::smooth, 6, generator);
  for (int s = 0; s < surface.num_segments(); ++s) {
    const SurfacePiece piece = surface.undeformed_piece(s);
    const Vector2d slave = piece.combine(weights_at(piece.stencil, 0.3).value);
    const ContactRows rows = make_rows(project(piece, slave, 0.5), 0.3, 1.0);
    for (const ContactRow& row : {rows.compatibility, rows.equilibrium}) {
      Vector2d force(row.slave[0], row.slave[1]);
      double moment = slave.x() * row.slave[1] - slave.y() * row.slave[0];
      for (std::size_t k = 0; k < static_cast<std::size_t>(piece.stencil.count); ++k) {
        const Vector2d share(row.master[2 * k], row.master[2 * k + 1]);
        force += share;
        moment += piece.nodes[k].x() * share.y() - piece.nodes[k].y() * share.x();
      }
      EXPECT_LT(force.norm(), 1e-14);
      EXPECT_NEAR(moment, 0.0, 1e-13);
    }
  }
}

}  // namespace
}  // namespace stridor
