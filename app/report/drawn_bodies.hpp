// Bodies as the page draws them: nodes, faces and lines.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "app/report/report_section.hpp"
#include "coupling/system/system.hpp"

namespace stridor {

/// What is drawn of a body.
struct DrawnBody {
  std::string name;
  Eigen::Index num_nodes = 0;
  std::vector<std::vector<int>> faces;  ///< nodes around each, as face_loops() gives them
  std::vector<std::vector<int>> lines;  ///< nodes in order; used where there are no faces
};

/// The nodes of the bodies that are drawn, and what is drawn between them.
struct DrawnNodes {
  struct Part {
    std::size_t body = 0;                 ///< of those given
    std::vector<int> nodes;               ///< of the body
    std::size_t first = 0;                ///< of its nodes, among all
    std::vector<std::vector<int>> faces;  ///< numbers among all
    std::vector<std::vector<int>> lines;
  };
  std::vector<Part> parts;
  std::size_t count = 0;
};

/// Numbers the nodes that faces or lines use; of a body without them all nodes, which are shown as
/// points.
DrawnNodes drawn_nodes(std::span<const DrawnBody> bodies);

/// "parts" of a view: name, first and count of nodes, faces and lines of each.
Json parts_json(const DrawnNodes& drawn, std::span<const DrawnBody> bodies, ReportPage& page);

/// The axis of space that a page shows upwards, x (0), y (1) or z (2): the one along which the
/// first contact is pressed; z without contacts.
int upward_axis(const System& system);

}  // namespace stridor
