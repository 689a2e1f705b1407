// What of a modal test is drawn on a body that is made of its modes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "substructures/bodies/modal_test.hpp"

namespace stridor {

/// The lines of a test and the edges of its elements, each edge once: labels of nodes in order.
std::vector<std::vector<std::int64_t>> drawn_lines(const ModalTest& test);

/// Nodes that lines of a test join and that have a place and values in every mode.
struct DrawnTest {
  std::map<std::int64_t, std::size_t> numbers;  ///< of nodes of the body, by label
  std::vector<std::int64_t> labels;             ///< of those behind the ports, in order
  std::vector<std::vector<int>> lines;  ///< numbers in order; a line ends where a node is not known
};

/// @param modes of the test that make the body; none: nothing is drawn
/// @param ports numbers of nodes that stand for measured ones already
/// @param first number that is free
DrawnTest drawn_test(const ModalTest& test, std::span<const TestMode* const> modes,
                     std::map<std::int64_t, std::size_t> ports, std::size_t first);

}  // namespace stridor
