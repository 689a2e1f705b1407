#include "io/scene/body_reader.hpp"

#include <filesystem>
#include <memory>
#include <vector>

#include "core/errors.hpp"
#include "io/imports/named_files.hpp"

namespace stridor {

void make_files_absolute(const std::string& key, const SceneNode& tree, BodyParameters& body) {
  for (const NamedFile& file : body.files()) {
    const std::string path = path_of_file(tree, key + "." + file.key, *file.name);
    *file.name = std::filesystem::absolute(path).lexically_normal().string();
  }
}

void read_files(const std::string& key, const SceneNode& tree, BodyParameters& body,
                BodyCache& cache) {
  if (body.take_contents(body)) return;  // it holds them already
  std::shared_ptr<const BodyParameters>& last = cache.read[key];
  if (last && body.take_contents(*last)) return;
  try {
    body.read(NamedFiles([&](const std::string& of, const std::string& name) {
      return path_of_file(tree, key + "." + of, name);
    }));
  } catch (const ConfigError& error) {
    const Problem& problem = error.problems().front();
    if (!problem.source.empty()) throw;  // it names the place in a file
    throw ConfigError(problem.refusal, key + "." + problem.key, problem.message);
  }
  last = body.clone();
}

}  // namespace stridor
