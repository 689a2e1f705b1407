#include "io/imports/matrix_entries.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace stridor {

namespace {

/// Whether no entry off the diagonal has one at the mirror image of its place.
bool is_one_of_each_pair(const SparseMatrix& matrix) {
  SparseMatrix pattern = matrix;
  std::fill_n(pattern.valuePtr(), pattern.nonZeros(), 1.0);
  const SparseMatrix transposed = pattern.transpose();
  const SparseMatrix both = pattern.cwiseProduct(transposed);
  return static_cast<double>(both.nonZeros()) == both.diagonal().sum();
}

}  // namespace

void complete_symmetric(LabelledMatrix& read, const TextPlace& place) {
  const SparseMatrix transposed = read.matrix.transpose();
  if (read.stored == StoredPart::full && is_one_of_each_pair(read.matrix))
    read.stored = StoredPart::half;
  if (read.stored != StoredPart::full && read.stored != StoredPart::diagonal) {
    SparseMatrix whole = read.matrix + transposed;
    for (Eigen::Index column = 0; column < whole.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(whole, column); entry; ++entry)
        if (entry.row() == column) entry.valueRef() *= 0.5;
    }
    read.matrix = whole;
    return;
  }
  if (read.stored == StoredPart::diagonal) return;
  const double size = read.matrix.norm();
  if (!(size > 0.0)) return;
  read.symmetry_error = SparseMatrix(read.matrix - transposed).norm() / size;
  if (read.symmetry_error > LabelledMatrix::largest_rounding) {
    refuse_at(place, fmt::format("the matrix has both triangles, which differ by {:.1e} of it; "
                                 "expected a symmetric matrix, up to {:.0e}",
                                 read.symmetry_error, LabelledMatrix::largest_rounding));
  }
  read.matrix = 0.5 * (read.matrix + transposed);
}

LabelledMatrix MatrixEntries::finish(int size, std::string format, const TextPlace& place) && {
  LabelledMatrix read;
  read.format = std::move(format);
  read.matrix.resize(size, size);
  read.matrix.setFromTriplets(entries_.begin(), entries_.end());
  read.matrix.prune(0.0, 0.0);
  read.is_open = true;
  read.stored = has_upper_ && has_lower_ ? StoredPart::full
                : has_upper_             ? StoredPart::upper
                : has_lower_             ? StoredPart::lower
                                         : StoredPart::diagonal;
  complete_symmetric(read, place);
  return read;
}

LabelledMatrix LabelledEntries::finish(std::string format, const TextPlace& place) && {
  std::vector<NodeUnknown> unknowns;
  for (const Entry& entry : entries_) {
    // Entries come row by row or column by column.
    if (unknowns.empty() || unknowns.back() != entry.row) unknowns.push_back(entry.row);
    if (entry.column != entry.row) unknowns.push_back(entry.column);
  }
  std::sort(unknowns.begin(), unknowns.end());
  unknowns.erase(std::unique(unknowns.begin(), unknowns.end()), unknowns.end());
  unknowns.shrink_to_fit();
  const auto number = [&](const NodeUnknown& unknown) {
    return static_cast<int>(std::lower_bound(unknowns.begin(), unknowns.end(), unknown) -
                            unknowns.begin());
  };
  MatrixEntries numbered;
  for (const Entry& entry : entries_)
    numbered.add(number(entry.row), number(entry.column), entry.value);
  LabelledMatrix read =
      std::move(numbered).finish(static_cast<int>(unknowns.size()), std::move(format), place);
  read.unknowns = std::move(unknowns);
  read.is_open = false;
  return read;
}

}  // namespace stridor
