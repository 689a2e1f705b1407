// Entries of a matrix as a program writes them, until it is whole.
#pragma once

#include <string>
#include <vector>

#include "io/imports/source_text.hpp"
#include "substructures/elements/labelled_matrix.hpp"

namespace stridor {

/// Unknowns of a matrix are at most this many.
inline constexpr std::int64_t largest_matrix = 20'000'000;

/// Entries by row and column from 0; one given twice counts as their sum.
class MatrixEntries {
 public:
  void add(int row, int column, double value) {
    entries_.emplace_back(row, column, value);
    has_upper_ |= row < column;
    has_lower_ |= row > column;
  }
  bool is_empty() const { return entries_.empty(); }

  /// The matrix; where only one triangle is there, the other one is its mirror image. Asymmetry up
  /// to LabelledMatrix::largest_rounding is taken out.
  /// @throws ConfigError at `place` if it is less symmetric
  LabelledMatrix finish(int size, std::string format, const TextPlace& place) &&;

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  bool has_upper_ = false, has_lower_ = false;
};

/// Entries between labelled unknowns, in any order.
class LabelledEntries {
 public:
  void add(const NodeUnknown& row, const NodeUnknown& column, double value) {
    entries_.push_back({row, column, value});
  }
  bool is_empty() const { return entries_.empty(); }

  /// As MatrixEntries::finish(); rows are the unknowns that entries name, ascending.
  LabelledMatrix finish(std::string format, const TextPlace& place) &&;

 private:
  struct Entry {
    NodeUnknown row, column;
    double value;
  };
  std::vector<Entry> entries_;
};

/// Adds the mirror image of a triangle, or takes rounding out of both, and fills in what was found.
/// @throws ConfigError at `place` if both are there and differ
void complete_symmetric(LabelledMatrix& read, const TextPlace& place);

}  // namespace stridor
