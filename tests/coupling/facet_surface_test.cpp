// Facets of surfaces in space: shape, closest points and the search from one to the next.
#include "coupling/kinematics/facet_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using ::testing::HasSubstr;

/// n x n facets over the unit square with given heights, as quadrilaterals or pairs of triangles.
template <class Height>
FacetSurface grid(int n, int corners, const Height& height, SurfaceKind kind) {
  FacetSurface surface;
  surface.name = "block.top";
  const auto node = [&](int i, int j) { return j * (n + 1) + i; };
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = 1.0 * i / n, z = 1.0 * j / n;
      surface.positions.emplace_back(x, height(x, z), z);
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      // Seen from above, +y, z points down when x points to the right.
      const int a = node(i, j), b = node(i, j + 1), c = node(i + 1, j + 1), d = node(i + 1, j);
      if (corners == 4) {
        surface.facets.push_back({4, {a, b, c, d}});
      } else {
        surface.facets.push_back({3, {a, b, c, 0}});
        surface.facets.push_back({3, {a, c, d, 0}});
      }
    }
  }
  connect_facets(surface, kind);
  return surface;
}

const auto flat = [](double, double) { return 0.0; };

TEST(FacetPatch, SlopesAndCurvaturesAreDerivatives) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const int count : {3, 4}) {
    FacetPatch patch;
    patch.count = count;
    patch.is_bulged = true;
    patch.nodes = {Eigen::Vector3d(0, 0, 0), {0, 0.1, 1}, {1, 0, 1.2}, {1.1, 0.2, 0}};
    for (Eigen::Vector3d& bulge : patch.bulges) bulge << unit(random), unit(random), unit(random);
    constexpr double h = 1e-4;
    const auto at = [&](double xi, double eta) { return patch.at(xi, eta); };
    const PatchPoint here = at(0.3, 0.2);
    // The patch is at most cubic: central differences are wrong by h² times its third derivatives.
    const double allowed = 50.0 * h * h;
    EXPECT_LT(((at(0.3 + h, 0.2).place - at(0.3 - h, 0.2).place) / (2 * h) - here.slopes[0]).norm(),
              allowed);
    EXPECT_LT(((at(0.3, 0.2 + h).place - at(0.3, 0.2 - h).place) / (2 * h) - here.slopes[1]).norm(),
              allowed);
    for (const std::size_t k : {0u, 1u}) {
      const Eigen::Vector3d by_xi =
          (at(0.3 + h, 0.2).slopes[k] - at(0.3 - h, 0.2).slopes[k]) / (2 * h);
      const Eigen::Vector3d by_eta =
          (at(0.3, 0.2 + h).slopes[k] - at(0.3, 0.2 - h).slopes[k]) / (2 * h);
      EXPECT_LT((by_xi - here.curvatures[k]).norm(), allowed) << count << " " << k;
      EXPECT_LT((by_eta - here.curvatures[k + 1]).norm(), allowed) << count << " " << k;
    }
  }
}

TEST(FacetPatch, ClosestPointIsOrthogonal) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const int count : {3, 4}) {
    FacetPatch patch;
    patch.count = count;
    patch.nodes = {Eigen::Vector3d(0, 0, 0), {0, 0.1, 1}, {1, 0, 1.2}, {1.1, 0.2, 0}};
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d point(0.5 + 0.4 * unit(random), 0.2 * unit(random),
                                  0.5 + 0.4 * unit(random));
      const Eigen::Vector2d place = closest_on(patch, point, {0.5, 0.5});
      const PatchPoint on = patch.at(place.x(), place.y());
      EXPECT_NEAR(on.slopes[0].dot(point - on.place), 0.0, 1e-13);
      EXPECT_NEAR(on.slopes[1].dot(point - on.place), 0.0, 1e-13);
    }
  }
}

/// Largest distance of a surface from the sphere that its nodes are on, and largest angle between
/// normals on both sides of an edge.
std::pair<double, double> errors_on_sphere(int n, int corners, SurfaceKind kind) {
  constexpr double radius = 1.5;
  const Eigen::Vector3d centre(0.4, -1.2, 0.45);
  const FacetSurface surface = grid(
      n, corners,
      [&](double x, double z) {
        return centre.y() + std::sqrt(radius * radius - std::pow(x - centre.x(), 2) -
                                      std::pow(z - centre.z(), 2));
      },
      kind);
  double distance = 0.0, kink = 0.0;
  const auto normal_at = [](const FacetPatch& patch, double xi, double eta) -> Eigen::Vector3d {
    const PatchPoint on = patch.at(xi, eta);
    return on.slopes[0].cross(on.slopes[1]).normalized();
  };
  // Normals at the edge of the mesh are those of one side.
  const auto is_inner = [&](const Eigen::Vector3d& place) {
    const double margin = 1.5 / n;
    return std::abs(place.x() - 0.5) < 0.5 - margin && std::abs(place.z() - 0.5) < 0.5 - margin;
  };
  for (int f = 0; f < static_cast<int>(surface.facets.size()); ++f) {
    const FacetPatch patch = surface.patch(f);
    const Eigen::Vector3d middle = surface.origin(f) + patch.at(0.3, 0.4).place;
    if (!is_inner(middle)) continue;
    distance = std::max(distance, std::abs((middle - centre).norm() - radius));
    // The edge from the first node to the second, at its middle.
    const int other = surface.neighbours[static_cast<std::size_t>(f)][0];
    if (other < 0) continue;
    const Eigen::Vector3d on_edge = surface.origin(f) + patch.at(0.5, 0.0).place;
    if (!is_inner(on_edge)) continue;
    const FacetPatch next = surface.patch(other);
    const Eigen::Vector2d place = closest_on(next, on_edge - surface.origin(other), {0.5, 0.5});
    kink = std::max(kink, (normal_at(patch, 0.5, 0.0) - normal_at(next, place.x(), place.y())).norm());
  }
  return {distance, kink};
}

TEST(FacetSurface, SmoothSurfacesApproachASphereFasterThanFlatFacets) {
  for (const int corners : {3, 4}) {
    const auto [flat_coarse, flat_kink] = errors_on_sphere(12, corners, SurfaceKind::polyline);
    const auto [flat_fine, flat_fine_kink] = errors_on_sphere(24, corners, SurfaceKind::polyline);
    const auto [coarse, kink] = errors_on_sphere(12, corners, SurfaceKind::smooth);
    const auto [fine, fine_kink] = errors_on_sphere(24, corners, SurfaceKind::smooth);
    // Flat: h² of the height, h of the normals. Bulges take the first term away.
    EXPECT_NEAR(std::log2(flat_coarse / flat_fine), 2.0, 0.25) << corners;
    EXPECT_NEAR(std::log2(flat_kink / flat_fine_kink), 1.0, 0.25) << corners;
    EXPECT_GT(std::log2(coarse / fine), 2.2) << corners;
    EXPECT_LT(std::log2(coarse / fine), 4.6) << corners;
    EXPECT_GT(std::log2(kink / fine_kink), 1.7) << corners;
    EXPECT_LT(fine, 0.05 * flat_fine) << corners;
    EXPECT_LT(fine_kink, 0.05 * flat_fine_kink) << corners;
  }
}

TEST(FacetSurface, ASmoothSurfaceOfFlatFacetsIsFlat) {
  const FacetSurface surface = grid(3, 4, flat, SurfaceKind::smooth);
  for (const auto& bulges : surface.bulges)
    for (const Eigen::Vector3d& bulge : bulges) EXPECT_EQ(bulge, Eigen::Vector3d::Zero());
}

TEST(FacetSurface, RefusesEdgesOfThreeFacetsAndFacetsWithoutArea) {
  FacetSurface surface = grid(2, 4, flat, SurfaceKind::polyline);
  surface.facets.push_back(surface.facets.front());
  EXPECT_THAT(test::message_of<std::invalid_argument>(
                  [&] { connect_facets(surface, SurfaceKind::polyline); }),
              HasSubstr("more than two of them meet"));
  surface.facets.back() = {3, {0, 1, 2, 0}};
  EXPECT_THAT(test::message_of<std::invalid_argument>(
                  [&] { connect_facets(surface, SurfaceKind::polyline); }),
              HasSubstr("without area"));
}

TEST(FacetSearch, FollowsAPathOverManyFacetsAndLosesItBeyondTheEdge) {
  for (const int corners : {3, 4}) {
    const FacetSurface surface = grid(
        9, corners, [](double x, double z) { return 0.1 * x * x - 0.05 * z * z; },
        SurfaceKind::polyline);
    FacetPlace place = locate_on(surface, {0.05, 0.02, 0.07});
    ASSERT_GE(place.facet, 0);
    const auto follow = [&](const Eigen::Vector3d& point) {
      FacetSearch search;
      FacetSearch::Step step = FacetSearch::Step::moved;
      while (step == FacetSearch::Step::moved) {
        const Eigen::Vector2d found = closest_on(
            surface.patch(place.facet), point - surface.origin(place.facet), {place.xi, place.eta});
        place.xi = found.x();
        place.eta = found.y();
        step = search.look(surface, place);
      }
      return step;
    };
    for (int i = 0; i <= 200; ++i) {
      const double s = i / 200.0;
      const Eigen::Vector3d point(0.05 + 0.9 * s, 0.02, 0.07 + 0.85 * s * s);
      ASSERT_EQ(follow(point), FacetSearch::Step::stay);
      const FacetPlace anew = locate_on(surface, point);
      ASSERT_GE(anew.facet, 0) << corners << " " << s;
      const auto place_on = [&](const FacetPlace& on) -> Eigen::Vector3d {
        return surface.origin(on.facet) + surface.patch(on.facet).at(on.xi, on.eta).place;
      };
      // At a kink either facet may be the closer one.
      EXPECT_LT((place_on(anew) - place_on(place)).norm(), 2e-3) << corners << " " << s;
    }
    EXPECT_EQ(follow({1.01, 0.05, 0.5}), FacetSearch::Step::lost);
    // From one end to the other in one go.
    place = {0, 0.5, 0.5};
    EXPECT_EQ(follow({0.95, 0.05, 0.9}), FacetSearch::Step::stay);
    EXPECT_EQ(place.facet, locate_on(surface, {0.95, 0.05, 0.9}).facet);
    EXPECT_EQ(locate_on(surface, {1.5, 0.0, 0.5}).facet, -1);
  }
}

}  // namespace
}  // namespace stridor
