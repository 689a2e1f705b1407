// What joins the nodes of a universal file: trace lines (82) and elements (2412).
#pragma once

#include <optional>
#include <vector>

#include "io/imports/uff_lines.hpp"
#include "substructures/bodies/modal_test.hpp"
#include "substructures/elements/mesh.hpp"

namespace stridor {

/// How a universal file holds a shape: the number of its kind, and its nodes in the order there,
/// which goes around the lower side from corner to middle to corner, up the edges, and around the
/// upper side.
struct UffElementRecord {
  int kind = 0;
  std::vector<int> order;  ///< empty where it is that of the shape
};

UffElementRecord element_record(ElementShape shape);

/// The shape of a kind: plane, plate, membrane, axisymmetric and shell elements are drawn alike.
/// @return nothing where it is none of ElementShape
std::optional<ElementShape> shape_of_kind(std::int64_t kind);

/// Adds the trace line of a dataset 82, in pieces where a 0 lifts the pen.
///
/// Tolerated, besides what read_uff() does: a name that is missing (with a remark; of the only line
/// of a dataset), a padded last line, fewer nodes than announced (with a remark), several lines in
/// one dataset.
/// @throws ConfigError with the place in the file and what was expected
void read_trace_lines(const UffDataset& dataset, ModalTest& test);

/// Adds the elements of a dataset 2412; rods, beams and rigid bars as lines, with or without the
/// record of a beam's orientation. Others are passed over, with a remark.
/// @throws ConfigError with the place in the file and what was expected
void read_elements(const UffDataset& dataset, ModalTest& test);

}  // namespace stridor
