// Universal files, as programs for tests read them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include "io/imports/uff_functions.hpp"
#include "substructures/elements/mesh.hpp"

namespace stridor {

/// A node that functions name.
struct UffNode {
  std::int64_t number = 0;
  std::string name;  ///< "<body>.<point>"
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< m
};

/// An element, with the labels of its nodes in the order of its shape.
struct UffElement {
  ElementShape shape = ElementShape::quad8;
  std::vector<std::int64_t> nodes;
};

/// A complex mode at all nodes, in their order.
struct UffMode {
  std::int64_t number = 0;
  std::complex<double> eigenvalue;  ///< 1/s
  std::vector<std::array<std::complex<double>, 3>> shape;  ///< x, y, z
};

/// Contents of a universal file.
struct UffContents {
  std::string title;
  std::string program;  ///< that wrote it, with its version
  std::string date;     ///< "26-NOV-26" and "17:24:09", as record 3 of 151 has them
  std::string time;
  std::vector<UffNode> nodes;
  std::vector<std::vector<std::int64_t>> lines{};  ///< labels of nodes in order
  std::vector<UffElement> elements{};
  std::vector<UffMode> modes{};
  std::vector<UffFunction> functions;  ///< in SI units, abscissas ascending

  /// Date and time from "2024-05-17T08:30:00Z".
  void stamp(const std::string& utc);
};

/// How the numbers of functions are written: datasets 58 or 58b.
enum class UffForm { text, binary };

/// The text of a file: dataset 151 (head), 164 (SI), 2411 (nodes), 2412 (elements), 82 (lines), a
/// 55 for each mode (complex displacements, modal a and b unknown and 0), and a 58 for each
/// function, in double precision.
///
/// Elements are there to be drawn: planar ones are called plane stress, all have property and
/// material 1. Functions are written at even abscissas where first one and increment, which have
/// six digits (E13.5), give them to 1e-9; else at uneven ones, which have six digits in text and
/// are whole in binary.
/// @throws std::invalid_argument if abscissas and values of a function are not as many, a mode has
/// not a
///         value for each node, or an element not the nodes of its shape
/// @throws ConfigError at `key` if neighbouring abscissas are the same in six digits
std::string uff_text(const UffContents& contents, const std::string& key,
                     UffForm form = UffForm::text);

}  // namespace stridor
