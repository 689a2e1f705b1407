#include "io/scene/matrix_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "io/imports/matrix_market.hpp"
#include "substructures/matrices/sparse_cholesky.hpp"

namespace stridor {
namespace {

using P = MatrixBodyParameters;
constexpr std::pair<const char*, MatrixText P::*> matrices_of_body[] = {
    {"mass", &P::mass},
    {"damping", &P::damping},
    {"gyroscopic", &P::gyroscopic},
    {"stiffness", &P::stiffness},
    {"circulatory", &P::circulatory}};

std::string key_of_term(std::size_t index) {
  return fmt::format("terms.{}.matrix", index);
}

/// Calls with the key below the body and the text of every matrix that it may name.
template <class Body, class Visit>
void for_each_matrix(Body& body, const Visit& visit) {
  for (const auto& [name, member] : matrices_of_body) visit(std::string(name), body.*member);
  for (std::size_t i = 0; i < body.terms.size(); ++i) visit(key_of_term(i), body.terms[i].matrix);
}

/// Whether a matrix is the name of a file, not rows.
bool is_file(const MatrixText& text) {
  return text.size() == 1 &&
         text.front().find_first_not_of("+-.eE0123456789 \t") != std::string::npos;
}

/// Whether two bodies name the same files and have the same rows; factors may differ.
bool have_same_matrices(const P& one, const P& other) {
  return std::all_of(std::begin(matrices_of_body), std::end(matrices_of_body),
                     [&](const auto& named) { return one.*named.second == other.*named.second; }) &&
         std::equal(
             one.terms.begin(), one.terms.end(), other.terms.begin(), other.terms.end(),
             [](const auto& a, const auto& b) { return a.role == b.role && a.matrix == b.matrix; });
}

/// The matrices of one body, with checks that name their keys.
class MatrixLoader {
 public:
  /// @param key  path of the body
  /// @param tree of the scene; must live longer
  MatrixLoader(std::string key, const SceneNode& tree) : key_(std::move(key)), tree_(&tree) {}

  NamedMatrices load(const MatrixBodyParameters& body) const {
    NamedMatrices parts;
    parts.mass = matrix("mass", body.mass, 0);
    const Eigen::Index n = parts.mass.rows();
    expect_symmetry("mass", parts.mass, 1.0);
    try {
      SparseCholesky(parts.mass, "the mass");
    } catch (const NumericalError&) {
      fail("mass", "must be positive definite");
    }
    parts.damping = matrix("damping", body.damping, n);
    parts.gyroscopic = matrix("gyroscopic", body.gyroscopic, n);
    expect_symmetry("gyroscopic", parts.gyroscopic, -1.0);
    parts.stiffness = matrix("stiffness", body.stiffness, n);
    parts.circulatory = matrix("circulatory", body.circulatory, n);
    expect_symmetry("circulatory", parts.circulatory, -1.0);
    for (std::size_t i = 0; i < body.terms.size(); ++i) {
      const MatrixRole role = body.terms[i].role;
      const std::string key = key_of_term(i);
      if (body.terms[i].matrix.empty()) fail(key, "is empty, expected a matrix");
      parts.terms.push_back(matrix(key, body.terms[i].matrix, n));
      if (role == MatrixRole::gyroscopic || role == MatrixRole::circulatory)
        expect_symmetry(key, parts.terms.back(), -1.0);
    }
    return parts;
  }

 private:
  [[noreturn]] void fail(const std::string& name, const std::string& message) const {
    throw ConfigError(key_ + "." + name, message);
  }

  /// @param size expected; 0: any
  SparseMatrix matrix(const std::string& name, const MatrixText& text, Eigen::Index size) const {
    if (text.empty() && size == 0) fail(name, "is empty, expected a matrix");
    if (text.empty()) return SparseMatrix(size, size);
    SparseMatrix read;
    if (is_file(text)) {
      read = read_matrix_file(path_of_file(*tree_, key_ + "." + name, text.front()));
    } else {
      try {
        read = parse_matrix_rows(text);
      } catch (const std::invalid_argument& error) {
        fail(name, error.what());
      }
    }
    const bool is_square = read.rows() == read.cols();
    if (!is_square || (size > 0 && read.rows() != size)) {
      fail(name, fmt::format("is {} x {}, expected {}", read.rows(), read.cols(),
                             size > 0 ? fmt::format("{} x {} as `mass` is", size, size)
                                      : std::string("as many rows as columns")));
    }
    return read;
  }

  /// @param sign 1 symmetric, −1 skew-symmetric
  void expect_symmetry(const std::string& name, const SparseMatrix& matrix, double sign) const {
    const SparseMatrix transposed = matrix.transpose();
    const SparseMatrix difference = matrix - sign * transposed;
    if (difference.norm() > 1e-12 * matrix.norm())
      fail(name, sign > 0.0 ? "must be symmetric" : "must be skew-symmetric");
  }

  std::string key_;
  const SceneNode* tree_;
};

}  // namespace

NamedMatrices read_matrices(const std::string& key, const SceneNode& tree,
                            const MatrixBodyParameters& body) {
  return MatrixLoader(key, tree).load(body);
}

std::vector<std::pair<std::string, std::string>> files_of(const std::string& key,
                                                          const BodyParameters& body) {
  const auto* given = dynamic_cast<const TouchedMatrixBodyParameters*>(&body);
  if (given == nullptr) return {};
  std::vector<std::pair<std::string, std::string>> files;
  for_each_matrix(given->body, [&](const std::string& name, const MatrixText& text) {
    if (is_file(text)) files.emplace_back(key + "." + name, text.front());
  });
  return files;
}

void make_files_absolute(const std::string& key, const SceneNode& tree, BodyParameters& body) {
  auto* given = dynamic_cast<TouchedMatrixBodyParameters*>(&body);
  if (given == nullptr) return;
  for_each_matrix(given->body, [&](const std::string& name, MatrixText& text) {
    if (!is_file(text)) return;
    const std::string path = path_of_file(tree, key + "." + name, text.front());
    text.front() = std::filesystem::absolute(path).lexically_normal().string();
  });
}

void read_files(const std::string& key, const SceneNode& tree, BodyParameters& body,
                BodyCache& cache) {
  auto* given = dynamic_cast<TouchedMatrixBodyParameters*>(&body);
  if (given == nullptr) return;
  BodyCache::ReadMatrices& last = cache.read[key];
  if (!last.matrices || !have_same_matrices(last.named, given->body)) {
    last.matrices = std::make_shared<const NamedMatrices>(read_matrices(key, tree, given->body));
    last.named = given->body;
  }
  given->matrices = last.matrices;
}

}  // namespace stridor
