#include "io/scene/body_reader.hpp"

#include <filesystem>
#include <memory>
#include <vector>

#include "core/errors.hpp"
#include "io/imports/gmsh_program.hpp"
#include "io/imports/matrix_market.hpp"
#include "io/imports/mesh_file.hpp"

namespace stridor {
namespace {

class FilesOfScene : public BodyFiles {
 public:
  /// @param key of the body; referenced, as the tree is
  FilesOfScene(const std::string& key, const SceneNode& tree) : key_(key), tree_(tree) {}

  SparseMatrix matrix(const std::string& key, const std::string& name) const override {
    return read_matrix_file(path_of_file(tree_, key_ + "." + key, name));
  }
  Mesh mesh(const std::string& key, const std::string& name) const override {
    return read_mesh_file(path_of_file(tree_, key_ + "." + key, name)).mesh;
  }
  std::string mesh_of_geometry(const std::string& key, const std::string& name,
                               const MeshingOptions& options) const override {
    return mesh_with_gmsh(path_of_file(tree_, key_ + "." + key, name), options);
  }
  SparseMatrix matrix(const std::vector<std::string>& rows) const override {
    return parse_matrix_rows(rows);
  }

 private:
  const std::string& key_;
  const SceneNode& tree_;
};

}  // namespace

void make_files_absolute(const std::string& key, const SceneNode& tree, BodyParameters& body) {
  for (const NamedFile& file : body.files()) {
    const std::string path = path_of_file(tree, key + "." + file.key, *file.name);
    *file.name = std::filesystem::absolute(path).lexically_normal().string();
  }
}

void read_files(const std::string& key, const SceneNode& tree, BodyParameters& body,
                BodyCache& cache) {
  std::shared_ptr<const BodyParameters>& last = cache.read[key];
  if (last && body.take_contents(*last)) return;
  try {
    body.read(FilesOfScene(key, tree));
  } catch (const ConfigError& error) {
    const Problem& problem = error.problems().front();
    if (!problem.source.empty()) throw;  // it names the place in a file
    throw ConfigError(key + "." + problem.key, problem.message);
  }
  last = body.clone();
}

}  // namespace stridor
