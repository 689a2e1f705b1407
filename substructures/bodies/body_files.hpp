// Files that bodies name in a scene.
#pragma once

#include <string>
#include <vector>

#include "substructures/bodies/modal_test.hpp"
#include "substructures/elements/mesh.hpp"
#include "substructures/matrices/body_matrices.hpp"
#include "substructures/elements/labelled_matrix.hpp"

namespace stridor {

/// A file that a body names.
struct NamedFile {
  std::string key;              ///< below that of the body
  std::string* name = nullptr;  ///< as written, or from the root once that has been made so
};

/// How a geometry is divided into elements.
struct MeshingOptions {
  double size = 0.0;  ///< of the largest elements, in the unit of the file
  int order = 2;      ///< 1 or 2
};

/// Whether a file is a geometry by the ending of its name: .geo, .step, .stp, .brep, .iges, .igs.
bool is_geometry(const std::string& name);

/// What the files of one body hold. Whoever knows scenes and formats reads them.
class BodyFiles {
 public:
  virtual ~BodyFiles() = default;

  /// @param key  that names the file, below that of the body
  /// @param name as written
  /// @throws ConfigError with the place in the file; FileError
  virtual LabelledMatrix matrix(const std::string& key, const std::string& name,
                                MatrixPurpose purpose) const = 0;
  /// A finite element mesh. Parameters and errors as matrix().
  virtual Mesh mesh(const std::string& key, const std::string& name) const = 0;
  /// What the rows of matrices are, and a table of places. Parameters and errors as matrix().
  virtual UnknownTable unknowns(const std::string& key, const std::string& name) const = 0;
  virtual NodeTable nodes(const std::string& key, const std::string& name) const = 0;
  /// File of the mesh of a geometry, which is made where it is not there. Errors as matrix().
  virtual std::string mesh_of_geometry(const std::string& key, const std::string& name,
                                       const MeshingOptions& options) const = 0;
  /// A square matrix from rows of numbers, given in the place of a file.
  /// @throws std::invalid_argument saying which row is wrong
  virtual SparseMatrix matrix(const std::vector<std::string>& rows) const = 0;
  /// Modes and places of a modal test. Parameters and errors as matrix().
  virtual ModalTest modal_test(const std::string& key, const std::string& name) const = 0;
};

}  // namespace stridor
