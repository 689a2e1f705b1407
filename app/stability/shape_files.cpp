#include "app/stability/shape_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "analysis/assurance.hpp"
#include "app/results/universal_file.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "io/figures/mesh_picture.hpp"
#include "io/run_file/run_file.hpp"
#include "models/placed_model.hpp"

namespace stridor {
namespace {

/// The shapes of all bodies, one below the other, with the largest displacement 1 and real.
Eigen::MatrixX3cd stacked_shape(const std::vector<BodyShape>& bodies, Eigen::Index num_nodes) {
  Eigen::MatrixX3cd all(num_nodes, 3);
  Eigen::Index first = 0;
  for (const BodyShape& body : bodies) {
    all.middleRows(first, body.displacement.rows()) = body.displacement;
    first += body.displacement.rows();
  }
  std::complex<double> largest = 0.0;
  for (const std::complex<double>& u : all.reshaped())
    if (std::abs(u) > std::abs(largest)) largest = u;
  if (std::abs(largest) > 0.0) all /= largest;
  return all;
}

void keep_nodes(const std::vector<BodyShape>& bodies, ShapedModes& shapes) {
  Eigen::Index num_nodes = 0;
  for (const BodyShape& body : bodies) num_nodes += body.nodes.rows();
  shapes.places.resize(num_nodes, 3);
  int first = 0;
  for (const BodyShape& body : bodies) {
    shapes.places.middleRows(first, body.nodes.rows()) = body.nodes;
    shapes.bodies.insert(shapes.bodies.end(), static_cast<std::size_t>(body.nodes.rows()), body.name);
    std::vector<std::vector<int>> lines = face_loops(body.elements);
    for (std::vector<int>& loop : lines) loop.push_back(loop.front());
    lines.insert(lines.end(), body.outlines.begin(), body.outlines.end());
    for (std::vector<int>& line : lines) {
      for (int& node : line) node += first;
      shapes.lines.push_back(std::move(line));
    }
    for (DrawnElement element : body.elements) {
      for (int& node : element.nodes) node += first;
      shapes.elements.push_back(std::move(element));
    }
    first += static_cast<int>(body.nodes.rows());
  }
}

constexpr double coincident = 1e-9;  // distance of nodes at one place, of the extent

/// The row of the node nearest to a place, with those that coincide with it.
std::vector<Eigen::Index> nearest_nodes(const Eigen::MatrixX3d& places,
                                        const Eigen::Vector3d& place, double extent) {
  Eigen::Index nearest = 0;
  (places.rowwise() - place.transpose()).rowwise().norm().minCoeff(&nearest);
  std::vector<Eigen::Index> nodes;
  for (Eigen::Index node = 0; node < places.rows(); ++node)
    if ((places.row(node) - places.row(nearest)).norm() <= coincident * extent)
      nodes.push_back(node);
  return nodes;
}

/// Nodes of the scene that coincide, with the places of the measured nodes to which they are
/// nearest.
struct SharedPlace {
  std::vector<Eigen::Index> nodes;
  std::map<std::int64_t, Eigen::Vector3d> measured;
};

/// Measured nodes that coincide as those of the scene do take one of them each; of any others it is
/// unclear which is meant, and they take the first.
void share_nodes(const ShapedModes& shapes, const SharedPlace& place, double extent,
                 NodesByLabel& node_of, std::vector<UnclearNode>& unclear) {
  const Eigen::Vector3d& first = place.measured.begin()->second;
  const bool is_clear =
      place.nodes.size() == 1 || (place.measured.size() == place.nodes.size() &&
                                  std::ranges::all_of(place.measured, [&](const auto& one) {
                                    return (one.second - first).norm() <= coincident * extent;
                                  }));
  std::size_t next = 0;
  for (const auto& [label, where] : place.measured) {
    const bool takes_next = is_clear && place.nodes.size() > 1;
    node_of.emplace(label, place.nodes[takes_next ? next++ : 0]);
    if (is_clear) continue;
    UnclearNode one{label, {}};
    for (const Eigen::Index node : place.nodes)
      one.bodies.push_back(shapes.bodies[static_cast<std::size_t>(node)]);
    unclear.push_back(std::move(one));
  }
}

/// The row of every measured node. Sets what of a comparison tells of the match.
NodesByLabel matched_nodes(const ShapedModes& shapes, const ModalTest& measured,
                           const NodesByLabel& named, const std::string& path,
                           ShapeComparison& comparison) {
  const Eigen::RowVector3d low = shapes.places.colwise().minCoeff();
  const Eigen::RowVector3d high = shapes.places.colwise().maxCoeff();
  const double extent = (high - low).norm();
  NodesByLabel node_of;
  std::map<Eigen::Index, SharedPlace> shared;  // by the first of their nodes
  std::set<std::int64_t> seen;
  for (const TestMode& mode : measured.modes) {
    for (const auto& entry : mode.shape) {
      const std::int64_t label = entry.first;
      if (!seen.insert(label).second) continue;
      if (const auto name = named.find(label); name != named.end()) {
        node_of.insert(*name);
        continue;
      }
      const auto place = measured.nodes.find(label);
      if (place == measured.nodes.end()) {
        throw ConfigError(Refusal::wrong_value, "--compare",
                          fmt::format("{} has no place of node {} (dataset 15 or 2411); "
                                      "name it with --node {}=BODY.POINT",
                                      path, label, label));
      }
      const std::vector<Eigen::Index> nearest = nearest_nodes(shapes.places, place->second, extent);
      const double distance =
          (shapes.places.row(nearest.front()) - place->second.transpose()).norm();
      if (!(distance <= 0.05 * extent)) {
        throw ConfigError(
            Refusal::off_the_surface, "--compare",
            fmt::format("node {} of {} at ({:.4g}, {:.4g}, {:.4g}) m is {:.3g} m away from every "
                        "node of the bodies, whose extent is {:.3g} m; the test and the scene "
                        "are to have the same coordinates, or --node {}=BODY.POINT names the point",
                        label, path, place->second.x(), place->second.y(), place->second.z(),
                        distance, extent, label));
      }
      comparison.farthest = std::max(comparison.farthest, distance);
      shared[nearest.front()].nodes = nearest;
      shared[nearest.front()].measured.emplace(label, place->second);
    }
  }
  for (auto& [first, place] : shared) {
    // Nodes that names have taken are no choice, unless nothing else is left.
    const auto is_taken = [&](Eigen::Index node) {
      return std::ranges::any_of(named, [&](const auto& one) { return one.second == node; });
    };
    if (!std::ranges::all_of(place.nodes, is_taken)) std::erase_if(place.nodes, is_taken);
  }
  for (const auto& [first, place] : shared)
    share_nodes(shapes, place, extent, node_of, comparison.unclear);
  for (const auto& [label, node] : named) {
    if (!node_of.contains(label))
      throw ConfigError(Refusal::unknown_name, "--node",
                        fmt::format("no mode of {} has a node {}", path, label));
  }
  return node_of;
}

/// Over the directions of the nodes of the measured mode.
double modal_assurance(const ShapedMode& computed, const TestMode& measured, const NodesByLabel& node_of) {
  std::vector<std::complex<double>> here, there;
  for (const auto& [label, values] : measured.shape) {
    for (Eigen::Index d = 0; d < 3; ++d) {
      here.push_back(computed.displacement(node_of.at(label), d));
      there.push_back(values[static_cast<std::size_t>(d)]);
    }
  }
  return assurance_criterion(here, there);
}

}  // namespace

ShapedModes shaped_modes(const Analysis& analysis, const std::string& option) {
  const FoundSpectrum& found = analysis.found;
  if (!found.shape) {
    throw ConfigError(Refusal::cannot_reduce, option,
                      "needs bodies that are reduced (reduction), or fewer unknowns than these");
  }
  BodyCache cache;
  const ShapeRecovery recovery(*analysis.member.model, cache);
  ShapedModes shapes;
  for (std::size_t i = 0; i < found.eigenvalues.size(); ++i) {
    if (!(found.eigenvalues[i].s.imag() > 0.0)) continue;
    if (stop_requested()) throw Interrupted("nothing has been written");
    const std::vector<BodyShape> bodies =
        recovery.mode(analysis.state.equilibrium, found.shape(i));
    if (shapes.modes.empty()) keep_nodes(bodies, shapes);
    if (shapes.places.rows() == 0)
      throw ConfigError(Refusal::wrong_value, option, "no body of the scene has nodes");
    shapes.modes.push_back({i, found.eigenvalues[i], stacked_shape(bodies, shapes.places.rows())});
  }
  if (shapes.modes.empty()) throw ConfigError(Refusal::wrong_value, option, "no mode vibrates");
  return shapes;
}

UffContents uff_contents(const ShapedModes& shapes, const std::string& scene) {
  UffContents contents = headed_contents("modes of " + scene);
  for (Eigen::Index i = 0; i < shapes.places.rows(); ++i)
    contents.nodes.push_back({i + 1, shapes.bodies[static_cast<std::size_t>(i)],
                              shapes.places.row(i).transpose()});
  for (const std::vector<int>& line : shapes.lines) {
    contents.lines.emplace_back();
    for (const int node : line) contents.lines.back().push_back(node + 1);
  }
  for (const DrawnElement& element : shapes.elements) {
    contents.elements.push_back({element.shape, {}});
    for (const int node : element.nodes) contents.elements.back().nodes.push_back(node + 1);
  }
  std::int64_t number = 0;
  for (const ShapedMode& mode : shapes.modes) {
    UffMode one;
    one.number = ++number;
    one.eigenvalue = mode.eigenvalue.s;
    for (Eigen::Index i = 0; i < mode.displacement.rows(); ++i)
      one.shape.push_back({mode.displacement(i, 0), mode.displacement(i, 1), mode.displacement(i, 2)});
    contents.modes.push_back(std::move(one));
  }
  return contents;
}

NodesByLabel nodes_at_points(const ShapedModes& shapes, const LoadedScene& loaded,
                             const std::vector<NodeName>& names) {
  NodesByLabel nodes;
  if (names.empty()) return nodes;
  BodyCache cache;
  const ModelParameters parameters = parameters_with_files(loaded, cache);
  const PlacedModel placed = place_model(parameters, cache);
  for (const NodeName& name : names) {
    const auto body = std::find_if(placed.bodies.begin(), placed.bodies.end(),
                                   [&](const ModelBody& one) { return one.name == name.point.body; });
    const auto first = std::find(shapes.bodies.begin(), shapes.bodies.end(), name.point.body);
    if (body == placed.bodies.end() || first == shapes.bodies.end()) {
      const std::set<std::string> known(shapes.bodies.begin(), shapes.bodies.end());
      throw ConfigError(Refusal::unknown_name, "--node",
                        fmt::format("no body '{}' has nodes (these have: {})", name.point.body,
                                    fmt::join(known, ", ")));
    }
    const int node = node_at(*body, name.point.point, "--node");
    const Eigen::Index start = first - shapes.bodies.begin();
    const Eigen::Index size = std::count(first, shapes.bodies.end(), name.point.body);
    Eigen::Index row = node;
    if (row >= size) {
      (shapes.places.middleRows(start, size).rowwise() - body->place_of(node).transpose())
          .rowwise()
          .norm()
          .minCoeff(&row);
    }
    nodes[name.node] = start + row;
  }
  return nodes;
}

ShapeComparison compared_shapes(const ShapedModes& shapes, const ModalTest& measured,
                                const NodesByLabel& named, const std::string& path) {
  ShapeComparison comparison;
  comparison.measured = measured.modes;
  const NodesByLabel node_of = matched_nodes(shapes, measured, named, path, comparison);
  comparison.num_nodes = node_of.size();
  comparison.assurance.resize(static_cast<Eigen::Index>(shapes.modes.size()),
                              static_cast<Eigen::Index>(measured.modes.size()));
  for (std::size_t c = 0; c < shapes.modes.size(); ++c) {
    for (std::size_t m = 0; m < measured.modes.size(); ++m) {
      comparison.assurance(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(m)) =
          modal_assurance(shapes.modes[c], measured.modes[m], node_of);
    }
  }
  return comparison;
}

}  // namespace stridor
