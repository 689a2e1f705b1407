// The matrices that a body names, read and checked.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "substructures/bodies/matrix_body.hpp"
#include "substructures/matrices/definiteness.hpp"

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

/// @param sign 1 symmetric, −1 skew-symmetric
void expect_symmetry(const std::string& key, const SparseMatrix& matrix, double sign) {
  const SparseMatrix transposed = matrix.transpose();
  const SparseMatrix difference = matrix - sign * transposed;
  if (difference.norm() > 1e-12 * matrix.norm())
    throw ConfigError(Refusal::wrong_matrix, key,
                      sign > 0.0 ? "must be symmetric" : "must be skew-symmetric");
}

/// Matrices of a body on their way from files to one order of unknowns.
class MatrixReader {
 public:
  MatrixReader(const MatrixBodyParameters& body, const MatrixNodesParameters& nodes,
               const BodyFiles& files)
      : body_(body), nodes_(nodes), files_(files) {}

  NamedMatrices read() {
    read_all();
    find_unknowns();
    check_sizes();
    NamedMatrices parts;
    parts.unknowns = unknowns_;
    parts.files = std::move(facts_);
    parts.mass = take("mass");
    parts.damping = take("damping");
    parts.gyroscopic = take("gyroscopic");
    parts.stiffness = take("stiffness");
    parts.circulatory = take("circulatory");
    for (std::size_t i = 0; i < body_.terms.size(); ++i)
      parts.terms.push_back(take(key_of_term(i)));
    find_places(parts);
    return parts;
  }

 private:
  static MatrixPurpose purpose_of(const std::string& key) {
    if (key == "mass") return MatrixPurpose::mass;
    if (key == "damping") return MatrixPurpose::damping;
    return key == "stiffness" ? MatrixPurpose::stiffness : MatrixPurpose::any;
  }

  void read_all() {
    for (const auto& [name, member] : matrices_of_body) read_one(name, body_.*member);
    if (body_.mass.empty())
      throw ConfigError(Refusal::missing, "mass", "is empty, expected a matrix");
    for (std::size_t i = 0; i < body_.terms.size(); ++i) {
      if (body_.terms[i].matrix.empty())
        throw ConfigError(Refusal::missing, key_of_term(i), "is empty, expected a matrix");
      read_one(key_of_term(i), body_.terms[i].matrix);
    }
  }

  void read_one(const std::string& key, const MatrixText& text) {
    if (text.empty()) return;
    keys_.push_back(key);
    if (is_file(text)) {
      // A mass matrix may be damping too, with a factor; of a file of several matrices the reader
      // says that it has to be told which.
      const std::string name = text.front();
      const auto first = std::find_if(names_.begin(), names_.end(),
                                      [&](const auto& known) { return known.second == name; });
      const auto count = std::count_if(names_.begin(), names_.end(),
                                       [&](const auto& known) { return known.second == name; });
      if (count == 1 && purpose_of(key) == MatrixPurpose::any) {
        read_[key] = read_.at(first->first);
      } else {
        read_[key] = files_.matrix(key, name, purpose_of(key));
      }
      names_[key] = name;
      const LabelledMatrix& read = read_[key];
      facts_.push_back({key, read.format, read.stored, read.symmetry_error});
    } else {
      try {
        read_[key].matrix = files_.matrix(text);
      } catch (const std::invalid_argument& error) {
        throw ConfigError(Refusal::wrong_matrix, key, error.what());
      }
    }
    const SparseMatrix& matrix = read_[key].matrix;
    if (matrix.rows() != matrix.cols()) {
      throw ConfigError(Refusal::wrong_size, key,
                        fmt::format("is {} x {}, expected as many rows as columns", matrix.rows(),
                                    matrix.cols()));
    }
  }

  /// The order of unknowns: that of a table, of the mesh, or of all that the matrices name.
  void find_unknowns() {
    if (!nodes_.mesh.empty()) mesh_ = files_.mesh("mesh", nodes_.mesh);
    const bool have_labels = std::any_of(read_.begin(), read_.end(), [](const auto& read) {
      return !read.second.unknowns.empty();
    });
    if (!nodes_.unknowns.empty() && have_labels)
      throw ConfigError(Refusal::contradiction, "unknowns",
                        "is not used: the matrices name the nodes of their rows; leave "
                        "it out");
    if (nodes_.unknowns == MatrixNodesParameters::all_of_mesh) {
      number_mesh();
    } else if (!nodes_.unknowns.empty()) {
      table_ = files_.unknowns("unknowns", nodes_.unknowns);
      unknowns_ = table_.unknowns;
    } else if (have_labels) {
      for (const auto& [key, read] : read_) {
        if (read.unknowns.empty()) {
          throw ConfigError(Refusal::missing, key,
                            "does not name the nodes of its rows, as others of the body do; "
                            "give all in one format");
        }
        unknowns_.insert(unknowns_.end(), read.unknowns.begin(), read.unknowns.end());
      }
      std::sort(unknowns_.begin(), unknowns_.end());
      unknowns_.erase(std::unique(unknowns_.begin(), unknowns_.end()), unknowns_.end());
      for (auto& [key, read] : read_) spread(read);
    } else {
      for (const auto* name : {&nodes_.mesh, &nodes_.nodes}) {
        if (!name->empty())
          throw ConfigError(Refusal::missing, name == &nodes_.mesh ? "mesh" : "nodes",
                            "needs to know which rows of the matrices are which nodes; give "
                            "`unknowns`");
      }
    }
  }

  void number_mesh() {
    if (nodes_.mesh.empty())
      throw ConfigError(Refusal::contradiction, "unknowns",
                        "all_of_mesh goes with a mesh; give `mesh`");
    std::vector<std::int64_t> labels = mesh_.node_labels;
    std::sort(labels.begin(), labels.end());
    for (const std::int64_t label : labels)
      for (int direction = 1; direction <= mesh_.dimension(); ++direction)
        unknowns_.push_back({label, direction});
  }

  /// Rows and columns of a matrix to their places among all unknowns.
  void spread(LabelledMatrix& read) const {
    std::vector<int> place;
    for (const NodeUnknown& unknown : read.unknowns) {
      place.push_back(static_cast<int>(
          std::lower_bound(unknowns_.begin(), unknowns_.end(), unknown) - unknowns_.begin()));
    }
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(read.matrix.nonZeros()));
    for (Eigen::Index column = 0; column < read.matrix.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(read.matrix, column); entry; ++entry) {
        entries.emplace_back(place[static_cast<std::size_t>(entry.row())],
                             place[static_cast<std::size_t>(column)], entry.value());
      }
    }
    const auto n = static_cast<Eigen::Index>(unknowns_.size());
    read.matrix.resize(n, n);
    read.matrix.setFromTriplets(entries.begin(), entries.end());
  }

  /// All n x n, with n from the unknowns or else from the largest of them.
  void check_sizes() {
    const bool has_table = !unknowns_.empty();
    size_ = has_table ? static_cast<Eigen::Index>(unknowns_.size()) : read_.at("mass").matrix.rows();
    if (!has_table && read_.at("mass").is_open) {
      for (const auto& [key, read] : read_) size_ = std::max(size_, read.matrix.rows());
    }
    for (const std::string& key : keys_) {
      LabelledMatrix& read = read_.at(key);
      const Eigen::Index n = read.matrix.rows();
      // Every unknown has a stiffness; the last ones may have no mass.
      const bool may_be_less = read.is_open && !(has_table && key == "stiffness");
      if (may_be_less && n < size_) read.matrix.conservativeResize(size_, size_);
      if (read.matrix.rows() == size_) continue;
      throw ConfigError(Refusal::wrong_size, key,
                        fmt::format("is {} x {}, expected {} x {} as {}", n, n, size_, size_,
                                    has_table ? "`unknowns` says" : "`mass` is"));
    }
  }

  SparseMatrix take(const std::string& key) {
    const auto found = read_.find(key);
    return found == read_.end() ? SparseMatrix(size_, size_) : std::move(found->second.matrix);
  }

  /// Nodes with their places: of the mesh, or of a table.
  void find_places(NamedMatrices& parts) {
    if (unknowns_.empty()) return;
    if (!nodes_.mesh.empty()) {
      if (!nodes_.nodes.empty())
        throw ConfigError(Refusal::contradiction, "nodes",
                          "is not used: the mesh has the places of nodes; leave it out");
      parts.mesh = std::move(mesh_);
    } else {
      NodeTable table = std::move(table_.nodes);
      for (auto& [key, read] : read_)
        if (table.labels.empty()) table = std::move(read.nodes);
      if (!nodes_.nodes.empty()) table = files_.nodes("nodes", nodes_.nodes);
      parts.mesh.node_labels = std::move(table.labels);
      parts.mesh.nodes = std::move(table.positions);
    }
    check_places(parts);
  }

  void check_places(const NamedMatrices& parts) const {
    const bool is_planar = parts.mesh.num_elements() > 0 && parts.mesh.dimension() == 2;
    const std::set<std::int64_t> labels(parts.mesh.node_labels.begin(),
                                        parts.mesh.node_labels.end());
    bool is_any_there = false;
    for (const NodeUnknown& unknown : parts.unknowns) {
      is_any_there |= labels.contains(unknown.node);
      if (is_planar && unknown.direction == 3) {
        throw ConfigError(
            Refusal::wrong_mesh, "mesh",
            fmt::format("is planar, but the matrices move node {} along z: the "
                        "program has made volumes of planar elements (CalculiX does); "
                        "make the body of volumes, or of `type: mesh`",
                        unknown.node));
      }
    }
    if (is_any_there) return;
    if (labels.empty())
      throw ConfigError(Refusal::missing, "mesh",
                        "is missing: where the nodes are is not known; give `mesh`, or "
                        "`nodes`, a table 'node, x, y, z'");
    throw ConfigError(Refusal::unknown_name, nodes_.mesh.empty() ? "nodes" : "mesh",
                      "has none of the nodes of the matrices; give that with which they were made");
  }

  const MatrixBodyParameters& body_;
  const MatrixNodesParameters& nodes_;
  const BodyFiles& files_;
  std::vector<std::string> keys_;                ///< in the order of the scene
  std::map<std::string, LabelledMatrix> read_;   ///< by key
  std::map<std::string, std::string> names_;     ///< files by key
  std::vector<MatrixFileFacts> facts_;
  Mesh mesh_;
  UnknownTable table_;
  std::vector<NodeUnknown> unknowns_;
  Eigen::Index size_ = 0;
};

}  // namespace

NamedMatrices read_matrices(const MatrixBodyParameters& body, const MatrixNodesParameters& nodes,
                            const BodyFiles& files) {
  NamedMatrices parts = MatrixReader(body, nodes, files).read();
  expect_symmetry("mass", parts.mass, 1.0);
  if (!is_positive_semidefinite(parts.mass))
    throw ConfigError(Refusal::wrong_matrix, "mass", "must be positive semidefinite");
  expect_symmetry("gyroscopic", parts.gyroscopic, -1.0);
  expect_symmetry("circulatory", parts.circulatory, -1.0);
  for (std::size_t i = 0; i < body.terms.size(); ++i) {
    const MatrixRole role = body.terms[i].role;
    if (role == MatrixRole::gyroscopic || role == MatrixRole::circulatory)
      expect_symmetry(key_of_term(i), parts.terms[i], -1.0);
    if (role == MatrixRole::structural) expect_symmetry(key_of_term(i), parts.terms[i], 1.0);
  }
  return parts;
}

std::vector<NamedFile> matrix_files(MatrixBodyParameters& body, MatrixNodesParameters& nodes) {
  std::vector<NamedFile> files;
  const auto add = [&](const std::string& key, MatrixText& text) {
    if (is_file(text)) files.push_back({key, &text.front()});
  };
  for (const auto& [name, member] : matrices_of_body) add(name, body.*member);
  for (std::size_t i = 0; i < body.terms.size(); ++i) add(key_of_term(i), body.terms[i].matrix);
  const auto add_name = [&](const char* key, std::string& name) {
    if (!name.empty() && name != MatrixNodesParameters::all_of_mesh) files.push_back({key, &name});
  };
  add_name("unknowns", nodes.unknowns);
  add_name("mesh", nodes.mesh);
  add_name("nodes", nodes.nodes);
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
