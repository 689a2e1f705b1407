// Any text as a matrix of another program, as a table of unknowns and as one of nodes: it is read or
// refused with a place.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/errors.hpp"
#include "io/imports/matrix_file.hpp"
#include "io/imports/unknown_tables.hpp"
#include "tests/fuzz/mesh_checks.hpp"

namespace {

/// What was read is square, finite and symmetric unless a Matrix Market file says otherwise, and
/// says what its rows are or nothing of them.
void expect_consistent(const stridor::LabelledMatrix& read) {
  const auto rows = static_cast<std::size_t>(read.matrix.rows());
  if (!read.unknowns.empty() && read.unknowns.size() != rows) std::abort();
  if (read.nodes.labels.size() != static_cast<std::size_t>(read.nodes.positions.rows()))
    std::abort();
  for (Eigen::Index column = 0; column < read.matrix.outerSize(); ++column) {
    for (stridor::SparseMatrix::InnerIterator entry(read.matrix, column); entry; ++entry)
      if (!std::isfinite(entry.value())) std::abort();
  }
  if (read.format == "Matrix Market") return;
  const stridor::SparseMatrix transposed = read.matrix.transpose();
  if (stridor::SparseMatrix(read.matrix - transposed).norm() != 0.0) std::abort();
}

template <class Read>
void try_to(Read&& read) {
  try {
    read();
  } catch (const stridor::ConfigError& error) {
    stridor::fuzz::expect_placed(error, "fuzz");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const stridor::SourceText source{"fuzz", std::string(reinterpret_cast<const char*>(data), size)};
  if (source.text.empty()) return 0;  // refused before it is a text
  for (const auto purpose : {stridor::MatrixPurpose::any, stridor::MatrixPurpose::stiffness})
    try_to([&] { expect_consistent(stridor::read_matrix_text(source, purpose)); });
  try_to([&] { stridor::read_unknown_table(source); });
  try_to([&] { stridor::read_node_table(source); });
  return 0;
}
