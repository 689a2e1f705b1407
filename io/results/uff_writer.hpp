// Universal files, as programs for tests read them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/hdf5/part_file.hpp"
#include "io/imports/uff_functions.hpp"
#include "substructures/bodies/modal_test.hpp"

namespace stridor {

/// A node that functions name.
struct UffNode {
  std::int64_t number = 0;
  std::string name;  ///< "<body>.<point>"
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< m
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
  std::vector<TestElement> elements{};
  std::vector<UffMode> modes{};
  std::vector<UffFunction> functions;  ///< in SI units, abscissas ascending

  /// Date and time from "2024-05-17T08:30:00Z".
  void stamp(const std::string& utc);
};

/// How the numbers of functions are written: datasets 58 or 58b.
enum class UffForm { text, binary };
/// In text 6 or 13 digits, in binary 4 or 8 bytes.
enum class UffPrecision { single_precision, double_precision };

struct UffNumbers {
  UffForm form = UffForm::text;
  UffPrecision precision = UffPrecision::double_precision;
};

/// Hands the text of a file on, piece by piece: dataset 151 (head), 164 (SI), 2411 (nodes), 2412
/// (elements), 82 (lines), a 55 for each mode (complex displacements, modal a and b unknown and 0),
/// and a 58 for each function.
///
/// Elements are there to be drawn: planar ones are called plane stress, all have property and
/// material 1.
/// @throws std::invalid_argument if a mode has not a value for each node, or an element not the
/// nodes
///         of its shape; and as write_uff_function()
void write_uff(const UffContents& contents, const std::string& key, const TextSink& sink,
               UffNumbers numbers = {});

/// One dataset 58 more, behind those of write_uff(): real where the values are, at even abscissas
/// where first one and increment, which have six digits (E13.5), give them to 1e-9; else at uneven
/// ones, which have six digits in text and those of the precision in binary.
/// @param number   of the function in the file, from 1
/// @param contents its program, date and time
/// @throws std::invalid_argument if abscissas and values are not as many, or none
/// @throws ConfigError at `key` if neighbouring abscissas are the same in the digits they have
void write_uff_function(const UffFunction& function, std::size_t number,
                        const UffContents& contents, const std::string& key, const TextSink& sink,
                        UffNumbers numbers);

}  // namespace stridor
