// Ports at the nodes of facets: shared between contacts, kept near them, used again behind them.
#include "solvers/contact/node_ports.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <memory>
#include <set>
#include <span>
#include <stdexcept>
#include <vector>

#include "solvers/integrators/dense_two_step.hpp"

namespace stridor {
namespace {

/// A strip of `length` square facets in a row, nodes 2 i and 2 i + 1 across it.
FacetSurface strip(int length) {
  FacetSurface surface;
  surface.name = "rail.top";
  for (int i = 0; i <= length; ++i) {
    for (int j = 0; j < 2; ++j) {
      const int row = 3 * surface.num_nodes();
      surface.positions.emplace_back(1.0 * i, 0.0, 1.0 * j);
      surface.rows.push_back({row, row + 1, row + 2});
    }
  }
  for (int i = 0; i < length; ++i)
    surface.facets.push_back({4, {2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2}});
  connect_facets(surface, SurfaceKind::polyline);
  return surface;
}

/// A mass on a spring for every displacement of a surface, with ports that watch others.
struct Body {
  explicit Body(const FacetSurface& surface) {
    const Eigen::Index size = 3 * surface.num_nodes();
    ReducedBody body;
    body.mass = Eigen::MatrixXd::Identity(size, size);
    body.stiffness = 100.0 * Eigen::MatrixXd::Identity(size, size);
    body.rows = Eigen::MatrixXd::Identity(size, size);
    marched = std::make_unique<FusedTwoStep>(body, Eigen::MatrixXd(size, 0), 1e-3, others, 0.0,
                                             std::span<const double>());
  }
  static constexpr int others = 2;
  std::unique_ptr<Propagator> marched;

  /// Whether three ports from one on watch the rows of a node.
  bool watches(int port, const std::array<int, 3>& rows) const {
    for (int i = 0; i < 3; ++i) {
      if (marched->row(port + i) != rows[static_cast<std::size_t>(i)]) return false;
    }
    return true;
  }
};

TEST(NodePorts, ContactsShareTheNodesBetweenTheirFacets) {
  const FacetSurface surface = strip(4);
  Body body(surface);
  NodePorts ports(*body.marched);
  const int left = ports.join(surface), right = ports.join(surface);
  const std::array<int, 4> of_left = ports.put(left, 0);
  EXPECT_EQ(body.marched->num_ports(), Body::others + 4 * 3);
  const std::array<int, 4> of_right = ports.put(right, 1);
  // Two of its four nodes are those of the facet beside it.
  EXPECT_EQ(body.marched->num_ports(), Body::others + 6 * 3);
  EXPECT_EQ(of_right[0], of_left[3]);
  EXPECT_EQ(of_right[1], of_left[2]);
  for (std::size_t k = 0; k < 4; ++k) {
    const auto node_of = [&](int facet) {
      return static_cast<std::size_t>(surface.facets[static_cast<std::size_t>(facet)].nodes[k]);
    };
    EXPECT_TRUE(body.watches(of_left[k], surface.rows[node_of(0)]));
    EXPECT_TRUE(body.watches(of_right[k], surface.rows[node_of(1)]));
  }
}

TEST(NodePorts, KeepNodesNearAContactAndUseThoseBehindItAgain) {
  const FacetSurface surface = strip(40);
  Body body(surface);
  NodePorts ports(*body.marched);
  const int contact = ports.join(surface);
  ports.put(contact, 10);
  const std::array<int, 4> before = ports.put(contact, 11);
  const int num_ports = body.marched->num_ports();
  // To and fro across an edge.
  ports.put(contact, 10);
  EXPECT_EQ(ports.put(contact, 11), before);
  EXPECT_EQ(body.marched->num_ports(), num_ports);
  // Along the whole strip: the facet, two behind it and the one that it comes to have ten nodes.
  for (int facet = 12; facet < 40; ++facet) {
    const std::array<int, 4> at = ports.put(contact, facet);
    EXPECT_EQ(std::set<int>(at.begin(), at.end()).size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) {
      const Facet& on = surface.facets[static_cast<std::size_t>(facet)];
      EXPECT_TRUE(body.watches(at[k], surface.rows[static_cast<std::size_t>(on.nodes[k])]));
    }
  }
  EXPECT_LE(body.marched->num_ports(), Body::others + 10 * 3);
  EXPECT_EQ(ports.first(), Body::others);
}

TEST(NodePorts, AreRestoredFromTheRowsThatABodyWatched) {
  const FacetSurface surface = strip(8);
  Body body(surface), resumed(surface);
  NodePorts ports(*body.marched), restored(*resumed.marched);
  const int contact = ports.join(surface);
  ports.put(contact, 3);
  ports.put(contact, 6);
  std::vector<double> rows;
  for (int port = 0; port < body.marched->num_ports(); ++port)
    rows.push_back(body.marched->row(port));
  ASSERT_EQ(restored.join(surface), contact);
  restored.restore(rows);
  EXPECT_EQ(resumed.marched->num_ports(), body.marched->num_ports());
  EXPECT_EQ(restored.put(contact, 6), ports.put(contact, 6));

  EXPECT_THROW(restored.restore(std::vector<double>(rows.begin(), rows.end() - 1)),
               std::invalid_argument);
  EXPECT_THROW(restored.restore(std::vector<double>(1, 0.0)), std::invalid_argument);
  std::vector<double> twice = rows;
  for (std::size_t i = 0; i < 3; ++i) twice[Body::others + 3 + i] = twice[Body::others + i];
  EXPECT_THROW(restored.restore(twice), std::invalid_argument);
}

}  // namespace
}  // namespace stridor
