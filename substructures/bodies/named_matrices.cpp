// The matrices that a body names, read and checked.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/errors.hpp"
#include "substructures/bodies/matrix_body.hpp"
#include "substructures/matrices/sparse_cholesky.hpp"

namespace stridor {
namespace {

using NamedText = std::pair<const char*, MatrixText MatrixBodyParameters::*>;
constexpr NamedText matrices_of_body[] = {{"mass", &MatrixBodyParameters::mass},
                                          {"damping", &MatrixBodyParameters::damping},
                                          {"gyroscopic", &MatrixBodyParameters::gyroscopic},
                                          {"stiffness", &MatrixBodyParameters::stiffness},
                                          {"circulatory", &MatrixBodyParameters::circulatory}};

std::string key_of_term(std::size_t index) {
  return fmt::format("terms.{}.matrix", index);
}

/// Whether a matrix is the name of a file, not rows.
bool is_file(const MatrixText& text) {
  return text.size() == 1 &&
         text.front().find_first_not_of("+-.eE0123456789 \t") != std::string::npos;
}

/// @param size expected; 0: any
SparseMatrix read_matrix(const std::string& key, const MatrixText& text, Eigen::Index size,
                         const BodyFiles& files) {
  if (text.empty() && size == 0) throw ConfigError(key, "is empty, expected a matrix");
  if (text.empty()) return SparseMatrix(size, size);
  SparseMatrix read;
  if (is_file(text)) {
    read = files.matrix(key, text.front());
  } else {
    try {
      read = files.matrix(text);
    } catch (const std::invalid_argument& error) {
      throw ConfigError(key, error.what());
    }
  }
  const bool is_square = read.rows() == read.cols();
  if (!is_square || (size > 0 && read.rows() != size)) {
    throw ConfigError(key, fmt::format("is {} x {}, expected {}", read.rows(), read.cols(),
                                       size > 0 ? fmt::format("{} x {} as `mass` is", size, size)
                                                : std::string("as many rows as columns")));
  }
  return read;
}

/// @param sign 1 symmetric, −1 skew-symmetric
void expect_symmetry(const std::string& key, const SparseMatrix& matrix, double sign) {
  const SparseMatrix transposed = matrix.transpose();
  const SparseMatrix difference = matrix - sign * transposed;
  if (difference.norm() > 1e-12 * matrix.norm())
    throw ConfigError(key, sign > 0.0 ? "must be symmetric" : "must be skew-symmetric");
}

}  // namespace

NamedMatrices read_matrices(const MatrixBodyParameters& body, const BodyFiles& files) {
  NamedMatrices parts;
  parts.mass = read_matrix("mass", body.mass, 0, files);
  const Eigen::Index n = parts.mass.rows();
  expect_symmetry("mass", parts.mass, 1.0);
  try {
    SparseCholesky(parts.mass, "the mass");
  } catch (const NumericalError&) {
    throw ConfigError("mass", "must be positive definite");
  }
  parts.damping = read_matrix("damping", body.damping, n, files);
  parts.gyroscopic = read_matrix("gyroscopic", body.gyroscopic, n, files);
  expect_symmetry("gyroscopic", parts.gyroscopic, -1.0);
  parts.stiffness = read_matrix("stiffness", body.stiffness, n, files);
  parts.circulatory = read_matrix("circulatory", body.circulatory, n, files);
  expect_symmetry("circulatory", parts.circulatory, -1.0);
  for (std::size_t i = 0; i < body.terms.size(); ++i) {
    const MatrixRole role = body.terms[i].role;
    const std::string key = key_of_term(i);
    if (body.terms[i].matrix.empty()) throw ConfigError(key, "is empty, expected a matrix");
    parts.terms.push_back(read_matrix(key, body.terms[i].matrix, n, files));
    if (role == MatrixRole::gyroscopic || role == MatrixRole::circulatory)
      expect_symmetry(key, parts.terms.back(), -1.0);
  }
  return parts;
}

std::vector<NamedFile> matrix_files(MatrixBodyParameters& body) {
  std::vector<NamedFile> files;
  const auto add = [&](const std::string& key, MatrixText& text) {
    if (is_file(text)) files.push_back({key, &text.front()});
  };
  for (const auto& [name, member] : matrices_of_body) add(name, body.*member);
  for (std::size_t i = 0; i < body.terms.size(); ++i) add(key_of_term(i), body.terms[i].matrix);
  return files;
}

bool have_same_matrices(const MatrixBodyParameters& one, const MatrixBodyParameters& other) {
  return std::all_of(std::begin(matrices_of_body), std::end(matrices_of_body),
                     [&](const auto& named) { return one.*named.second == other.*named.second; }) &&
         std::equal(
             one.terms.begin(), one.terms.end(), other.terms.begin(), other.terms.end(),
             [](const auto& a, const auto& b) { return a.role == b.role && a.matrix == b.matrix; });
}

}  // namespace stridor
