// Shapes of modes for programs of modal tests, and beside those that a test has measured.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "app/stability/analysed_spectrum.hpp"
#include "app/stability/measured_responses.hpp"
#include "io/imports/uff_file.hpp"
#include "io/results/uff_writer.hpp"
#include "models/mode_shape.hpp"

namespace stridor {

/// A mode on the nodes of all bodies, one body after the other.
struct ShapedMode {
  std::size_t place = 0;  ///< in the list of the spectrum
  Eigenvalue eigenvalue;
  Eigen::MatrixX3cd displacement;  ///< m; the largest is 1 and real
};

/// The vibrating modes of a spectrum with their shapes.
struct ShapedModes {
  std::vector<std::string> bodies;  ///< of the nodes
  Eigen::MatrixX3d places;          ///< m
  std::vector<std::vector<int>> lines;  ///< what is drawn between nodes
  std::vector<DrawnElement> elements;   ///< of those bodies that have them
  std::vector<ShapedMode> modes;
};

/// @param option that asked for shapes, for messages
/// @throws ConfigError if the bodies have no shapes, or no nodes
ShapedModes shaped_modes(const Analysis& analysis, const std::string& option);

/// As a universal file: 2411 (nodes from 1), 2412 (elements), 82 (lines) and a 55 for each mode.
UffContents uff_contents(const ShapedModes& shapes, const std::string& scene);

/// A measured node whose place several nodes of the scene share.
struct UnclearNode {
  std::int64_t label = 0;
  std::vector<std::string> bodies;  ///< of those nodes; the first is that of the node taken
};

/// Modal assurance criterion |φᴴψ|²/(φᴴφ ψᴴψ) of computed and measured modes over the nodes that were
/// measured.
struct ShapeComparison {
  std::vector<TestMode> measured;
  Eigen::MatrixXd assurance;  ///< [computed mode][measured mode]
  double farthest = 0.0;      ///< of a measured node from the node of the scene taken for it, m
  std::size_t num_nodes = 0;
  /// Measured nodes that stand where more nodes of the scene do than were measured there.
  std::vector<UnclearNode> unclear;
};

/// Rows of `shapes` by the label of a measured node.
using NodesByLabel = std::map<std::int64_t, Eigen::Index>;

/// The nodes at named points of bodies; of a point between nodes the nearest node of its body.
/// @throws ConfigError at --node if there is no such body with nodes, or no such point
NodesByLabel nodes_at_points(const ShapedModes& shapes, const LoadedScene& loaded,
                             const std::vector<NodeName>& names);

/// A measured node is what `named` says, else the node of the scene that is nearest to it. Where
/// nodes of the scene coincide, as in a contact, as many measured nodes that coincide take one
/// each, in the order of their labels; of any others it is unclear.
/// @param path of the measured shapes, for messages
/// @throws ConfigError if a measured node without a name is farther from every node than 5 % of the
///         extent of the bodies or the file has no place of it, or a named node has not been
///         measured
ShapeComparison compared_shapes(const ShapedModes& shapes, const ModalTest& measured,
                                const NodesByLabel& named, const std::string& path);

}  // namespace stridor
