// Any text as a Matrix Market file, or as rows of numbers: it is read or refused with a place.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/imports/matrix_market.hpp"

namespace {

/// A matrix that was read holds finite numbers only.
void expect_finite(const stridor::SparseMatrix& matrix) {
  for (int k = 0; k < matrix.outerSize(); ++k) {
    for (stridor::SparseMatrix::InnerIterator entry(matrix, k); entry; ++entry)
      if (!std::isfinite(entry.value())) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    std::istringstream stream(text);
    expect_finite(stridor::read_matrix_market(stream, "fuzz.mtx"));
  } catch (const stridor::ConfigError& error) {
    for (const stridor::Problem& problem : error.problems())
      if (problem.source != "fuzz.mtx" || problem.line < 1 || problem.message.empty()) std::abort();
  }
  std::vector<std::string> rows;
  std::istringstream stream(text);
  for (std::string row; std::getline(stream, row);) rows.push_back(row);
  try {
    expect_finite(stridor::parse_matrix_rows(rows));
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
