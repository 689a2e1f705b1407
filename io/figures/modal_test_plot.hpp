// Pictures of what a modal test measured at: nodes, and what joins them.
#pragma once

#include <string>

#include "io/figures/mesh_picture.hpp"
#include "substructures/bodies/modal_test.hpp"

namespace stridor {

/// The nodes of a test, its trace lines, and the faces of its elements; in the plane where all
/// nodes have the same z, else from a direction between the axes. A line ends at a node without a
/// place, elements with such a node are left out.
/// @throws std::invalid_argument if it has no nodes
MeshPicture modal_test_picture(const ModalTest& test, const std::string& caption);

}  // namespace stridor
