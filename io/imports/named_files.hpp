// Files of bodies by their paths, without a scene.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "io/imports/mesh_draft.hpp"
#include "substructures/bodies/body_files.hpp"

namespace stridor {

/// Reads what bodies ask for from files.
class NamedFiles : public BodyFiles {
 public:
  /// @param path_of the path of a file, from its key and its name as written
  explicit NamedFiles(
      std::function<std::string(const std::string& key, const std::string& name)> path_of)
      : path_of_(std::move(path_of)) {}

  LabelledMatrix matrix(const std::string& key, const std::string& name,
                        MatrixPurpose purpose) const override;
  Mesh mesh(const std::string& key, const std::string& name) const override;
  UnknownTable unknowns(const std::string& key, const std::string& name) const override;
  NodeTable nodes(const std::string& key, const std::string& name) const override;
  ModalTest modal_test(const std::string& key, const std::string& name) const override;
  std::string mesh_of_geometry(const std::string& key, const std::string& name,
                               const MeshingOptions& options) const override;
  SparseMatrix matrix(const std::vector<std::string>& rows) const override;

 private:
  std::function<std::string(const std::string&, const std::string&)> path_of_;
};

/// Files that are given together, by what they are.
struct ImportedFiles {
  std::string mass, damping, stiffness, unknowns, mesh, nodes, universal;  ///< paths; may be empty
  bool has_matrices() const { return !mass.empty() || !stiffness.empty(); }
};

/// Tells what files are by their names and first lines: meshes (.msh, .inp), matrices (.sti and
/// .mas of CalculiX, .mtx with STIF or MASS in the name as Abaqus has them, .pch of Nastran, which
/// holds both), tables of unknowns (.dof, .mapping, .csv) and of nodes (.csv, .txt), universal
/// files of tests
/// (.uff, .unv, .uf). "mass=FILE" and the like say it.
/// @throws ConfigError where it cannot be told, two files would be the same, or "KEY=FILE" has
///         another KEY; FileError
ImportedFiles sort_out_files(const std::vector<std::string>& files);

}  // namespace stridor
