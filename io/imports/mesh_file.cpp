#include "io/imports/mesh_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <utility>

#include "core/errors.hpp"
#include "io/imports/gmsh_mesh.hpp"
#include "io/imports/inp_mesh.hpp"
#include "io/imports/source_text.hpp"

namespace stridor {
namespace {

constexpr const char* mesh_formats = "a mesh of Gmsh (.msh) or of Abaqus or CalculiX (.inp)";

bool begins_with(std::string_view text, std::string_view beginning) {
  return text.substr(0, beginning.size()) == beginning;
}

/// The first letters behind blanks and empty lines.
std::string_view beginning_of(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin, 80);
}

SourceText read_included(const std::string& including_file, const std::string& file) {
  const std::filesystem::path path = std::filesystem::path(including_file).parent_path() / file;
  return read_source_text(path.string(), "nodes, elements or keywords of Abaqus or CalculiX");
}

}  // namespace

ImportedMesh read_mesh_file(const std::string& path) {
  SourceText source = read_source_text(path, mesh_formats);
  const std::string foreign = foreign_format(source.text);
  if (!foreign.empty())
    throw FileError(Refusal::other_kind_of_file, path, "",
                    fmt::format("is {}; expected {}", foreign, mesh_formats));
  const std::string_view beginning = beginning_of(source.text);
  const std::string ending = lower_case_of(std::filesystem::path(path).extension().string());
  const bool is_gmsh = begins_with(beginning, "$MeshFormat") || begins_with(beginning, "$NOD");
  const bool is_inp = begins_with(beginning, "*");
  if (is_gmsh || (!is_inp && ending == ".msh")) return read_gmsh_mesh(std::move(source));
  if (is_inp || ending == ".inp") return read_inp_mesh(std::move(source), read_included);
  throw FileError(
      Refusal::other_kind_of_file, path, "",
      fmt::format("begins with '{}'; expected {}",
                  shown(beginning.substr(0, beginning.find_first_of("\r\n"))), mesh_formats));
}

}  // namespace stridor
