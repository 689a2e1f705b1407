// Measured frequency responses beside those of a scene.
#pragma once

#include <string>
#include <vector>

#include "app/stability/response_study.hpp"
#include "app/terminal/command.hpp"
#include "io/imports/uff_functions.hpp"
#include "io/results/response_file.hpp"
#include "io/results/uff_writer.hpp"

namespace stridor {

/// Which point of the scene a node of a universal file is: "12=pad.tip".
struct NodeName {
  std::int64_t node = 0;
  PointName point;
};

/// @throws ConfigError at --node
std::vector<NodeName> parse_node_names(const std::vector<std::string>& words);

/// The frequency responses of a universal file between nodes that have names, in a range.
///
/// Of a file with one response and a study of one, they are taken to be the same where no node has a
/// name. Directions may be negative: the sign of the response follows.
/// @param from, to Hz
/// @param remarks gets what was passed over
/// @throws ConfigError if nothing can be compared, or a name or a direction does not fit the scene
std::vector<ComparedResponse> compared_responses(const ResponseStudy& study,
                                                 const UffFunctions& measured,
                                                 const std::vector<NodeName>& names, double from,
                                                 double to, std::vector<std::string>& remarks);

/// The response of the scene that belongs to a measured one, at any frequencies.
ResponseCurve computed_beside(const ResponseStudy& study, const ComparedResponse& compared,
                              const std::vector<double>& frequencies);

/// The deflection shapes that compared responses show: for every force to which two points or more
/// respond at the same frequencies, MAC at each of these, and of the shapes at peaks of the
/// mobility, √Σ|v|² over the points, that stand out by a factor of two (at most 60).
/// @param compared with different outputs for one force
std::vector<ComparedShapes> response_shapes(const std::vector<ComparedResponse>& compared);

/// Curves as functions of a universal file, their points as nodes from 1.
UffContents uff_contents(const ResponseStudy& study, const std::vector<double>& frequencies,
                         const std::vector<ResponseCurve>& curves);

}  // namespace stridor
