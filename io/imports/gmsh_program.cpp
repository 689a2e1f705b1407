#include "io/imports/gmsh_program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

#include "core/activity.hpp"
#include "core/checksum.hpp"
#include "core/errors.hpp"
#include "core/helper_program.hpp"
#include "io/hdf5/part_file.hpp"
#include "io/imports/source_text.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

constexpr const char* geometry_formats = "a geometry: a script of Gmsh (.geo), STEP, BREP or IGES";

/// The checksum of a geometry and of the files that it names, if it is a script.
std::uint64_t sum_of_geometry(const fs::path& path, std::uint64_t sum, std::set<fs::path>& seen) {
  if (!seen.insert(path).second) return sum;
  const SourceText source = read_source_text(path.string(), geometry_formats);
  sum = fnv1a(source.text, sum);
  if (lower_case_of(path.extension().string()) != ".geo") return sum;
  // Whatever stands in quotation marks and is a file there: of Include, Merge, ShapeFromFile.
  const std::string& text = source.text;
  for (std::size_t open = text.find('"'); open != std::string::npos;) {
    const std::size_t close = text.find('"', open + 1);
    if (close == std::string::npos) break;
    const fs::path named = path.parent_path() / text.substr(open + 1, close - open - 1);
    std::error_code ignored;
    if (close > open + 1 && fs::is_regular_file(named, ignored))
      sum = sum_of_geometry(named.lexically_normal(), sum, seen);
    open = text.find('"', close + 1);
  }
  return sum;
}

/// A script that reads the geometry and then has the last word on sizes.
std::string script_of(const std::string& geometry, const MeshingOptions& options) {
  return fmt::format(
      "mesh_size = {0:.17g};\n"
      "Merge \"{1}\";\n"
      "Mesh.MeshSizeMax = {0:.17g};\n"
      "Mesh.ElementOrder = {2};\n"
      "Mesh.SecondOrderIncomplete = 1;\n",
      options.size, geometry, options.order);
}

/// What gmsh printed: its errors on one line, else its last line.
std::string complaint_of(const fs::path& path, bool errors_alone) {
  std::ifstream file(path);
  std::string errors;
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (trimmed(line).empty()) continue;
    last = std::string(trimmed(line));
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("Error") || colon == std::string::npos) continue;
    if (!errors.empty()) errors += "; ";
    errors += trimmed(std::string_view(line).substr(colon + 2));
  }
  constexpr std::size_t longest = 600;
  std::string text = errors.empty() && !errors_alone ? last : errors;
  if (text.size() > longest) text = text.substr(0, longest) + " …";
  return text;
}

[[noreturn]] void refuse_start(const std::string& geometry, int reason) {
  if (reason == ENOENT)
    throw FileError(Refusal::helper_program, geometry, "",
                    "is a geometry, and gmsh, which divides it into elements, is not "
                    "installed; install the package gmsh, or name a mesh");
  throw FileError(Refusal::helper_program, geometry, "",
                  fmt::format("cannot start gmsh: {}", std::strerror(reason)));
}

std::string version_of_gmsh(const std::string& geometry, const fs::path& file) {
  const HelperOutcome outcome = run_helper({"gmsh", "--version"}, file.string(), file.string());
  if (outcome.spawn_error != 0) refuse_start(geometry, outcome.spawn_error);
  std::ifstream text(file);
  std::string version;
  std::getline(text, version);
  return version;
}

/// The folder of the user for what can be made again, or "".
fs::path cache_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && fs::path(cache).is_absolute()) return fs::path(cache) / "stridor";
  const char* home = std::getenv("HOME");
  if (home != nullptr && fs::path(home).is_absolute()) return fs::path(home) / ".cache" / "stridor";
  return "";
}

/// The folder in which a new mesh is kept: that of the geometry, where this user may write there.
fs::path folder_to_keep(const fs::path& beside) {
  if (faccessat(AT_FDCWD, beside.c_str(), W_OK, AT_EACCESS) == 0) return beside;
  const fs::path cache = cache_folder();
  if (cache.empty()) return beside;
  std::error_code error;
  fs::create_directories(cache, error);
  return error ? beside : cache;
}

}  // namespace

std::string mesh_with_gmsh(const std::string& geometry, const MeshingOptions& options) {
  const fs::path path = fs::absolute(geometry).lexically_normal();
  if (path.string().find_first_of("\"\n\\") != std::string::npos)
    throw FileError(Refusal::helper_program, geometry, "",
                    "has a name that gmsh cannot be told; rename it");
  std::set<fs::path> seen;
  const std::uint64_t sum =
      sum_of_geometry(path, fnv1a(fmt::format("{:.17g} {}", options.size, options.order)), seen);
  const std::string name = fmt::format("{}-{:016x}.msh", path.stem().string(), sum);
  std::error_code ignored;
  for (const fs::path& folder : {path.parent_path(), cache_folder()}) {
    const fs::path kept = folder / name;
    if (!folder.empty() && fs::is_regular_file(kept, ignored)) return kept.string();
  }
  const fs::path mesh = folder_to_keep(path.parent_path()) / name;

  const Activity meshing(fmt::format("meshing {} with gmsh", path.filename().string()));
  const ScratchFolder scratch("mesh", {"mesh.geo", "messages", "version"}, geometry);
  const std::string version = version_of_gmsh(geometry, scratch / "version");
  {
    std::ofstream file(scratch / "mesh.geo", std::ios::binary);
    file << script_of(path.string(), options);
    file.close();
    if (!file)
      throw FileError(Refusal::cannot_write, geometry, "",
                      "cannot write a temporary script; is the disk full?");
  }
  PartFile part(mesh.string());
  part.made();
  const std::string messages = (scratch / "messages").string();
  const HelperOutcome outcome = run_helper({"gmsh", "-3", "-v", "2", "-format", "msh41", "-o",
                                            part.path(), (scratch / "mesh.geo").string()},
                                           messages, messages);
  if (outcome.spawn_error != 0) refuse_start(geometry, outcome.spawn_error);
  if (WIFSIGNALED(outcome.status))
    throw FileError(Refusal::helper_program, geometry, "",
                    fmt::format("gmsh was ended by signal {}", WTERMSIG(outcome.status)));
  const bool has_failed = WEXITSTATUS(outcome.status) != 0;
  const std::string complaint = complaint_of(messages, !has_failed);
  if (has_failed || !complaint.empty())
    throw FileError(
        Refusal::helper_program, geometry, "",
        fmt::format("gmsh failed: {}", complaint.empty() ? "no reason given" : complaint));
  if (!fs::is_regular_file(part.path(), ignored))
    throw FileError(Refusal::helper_program, mesh.string(), "",
                    "gmsh has written no mesh; is the folder writable?");
  std::ofstream file(part.path(), std::ios::binary | std::ios::app);
  file << fmt::format("$Comments\ngmsh {}: {}, mesh_size {:.17g}, mesh_order {}\n$EndComments\n",
                      version, path.filename().string(), options.size, options.order);
  file.close();
  if (!file)
    throw FileError(Refusal::cannot_write, mesh.string(), "",
                    "cannot be written; is the disk full?");
  part.replace();
  return mesh.string();
}

}  // namespace stridor
