// Any text as a scene, with `--set` assignments after a zero byte: it is read or refused with
// problems, and what is read is the same scene when its resolved form is read. The scene has every
// kind of key that there is (tests/io/example_scene.hpp).
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/errors.hpp"
#include "io/scene/assignment.hpp"
#include "io/scene/resolved_scene.hpp"
#include "io/scene/scene_reader.hpp"
#include "io/scene/scene_tree.hpp"
#include "tests/io/example_scene.hpp"

namespace {

using namespace stridor;

template <class S>
void read_and_resolve(const SceneNode& tree) {
  std::string resolved;
  try {
    resolved = resolved_yaml(read_as<S>(tree));
  } catch (const ConfigError& error) {
    for (const Problem& problem : error.problems())
      if (problem.message.empty() || problem.source.empty()) std::abort();
    return;
  }
  // Refusing what the program itself has written would be a fault of its own.
  if (resolved_yaml(read_as<S>(read_scene_text(resolved, "resolved.yaml"))) != resolved)
    std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string text(reinterpret_cast<const char*>(data), size);
  std::string assignments;
  if (const std::size_t end = text.find('\0'); end != std::string::npos) {
    assignments = text.substr(end + 1);
    text.resize(end);
  }
  try {
    SceneNode tree = read_scene_text(text, "fuzz.yaml");
    for (std::size_t begin = 0; begin < assignments.size();) {
      const std::size_t end = std::min(assignments.find('\0', begin), assignments.size());
      set_value(tree, assignments.substr(begin, end - begin));
      begin = end + 1;
    }
    read_and_resolve<test::Example>(tree);
  } catch (const ConfigError& error) {
    if (error.problems().empty()) std::abort();
  }
  return 0;
}
