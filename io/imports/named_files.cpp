#include "io/imports/named_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "core/errors.hpp"
#include "core/suggestion.hpp"
#include "io/imports/gmsh_program.hpp"
#include "io/imports/matrix_file.hpp"
#include "io/imports/matrix_market.hpp"
#include "io/imports/mesh_file.hpp"
#include "io/imports/nastran_punch.hpp"
#include "io/imports/text_words.hpp"
#include "io/imports/uff_file.hpp"
#include "io/imports/unknown_tables.hpp"

namespace stridor {

LabelledMatrix NamedFiles::matrix(const std::string& key, const std::string& name,
                                  MatrixPurpose purpose) const {
  return read_matrix_file(path_of_(key, name), purpose);
}

Mesh NamedFiles::mesh(const std::string& key, const std::string& name) const {
  return read_mesh_file(path_of_(key, name)).mesh;
}

UnknownTable NamedFiles::unknowns(const std::string& key, const std::string& name) const {
  return read_unknown_file(path_of_(key, name));
}

NodeTable NamedFiles::nodes(const std::string& key, const std::string& name) const {
  return read_node_file(path_of_(key, name));
}

ModalTest NamedFiles::modal_test(const std::string& key, const std::string& name) const {
  return read_uff_file(path_of_(key, name));
}

std::string NamedFiles::mesh_of_geometry(const std::string& key, const std::string& name,
                                         const MeshingOptions& options) const {
  return mesh_with_gmsh(path_of_(key, name), options);
}

SparseMatrix NamedFiles::matrix(const std::vector<std::string>& rows) const {
  return parse_matrix_rows(rows);
}

namespace {

using Member = std::string ImportedFiles::*;
constexpr std::array<std::pair<const char*, Member>, 7> kinds{
    {{"mass", &ImportedFiles::mass},
     {"damping", &ImportedFiles::damping},
     {"stiffness", &ImportedFiles::stiffness},
     {"unknowns", &ImportedFiles::unknowns},
     {"mesh", &ImportedFiles::mesh},
     {"nodes", &ImportedFiles::nodes},
     {"universal", &ImportedFiles::universal}}};

void set(ImportedFiles& all, Member member, const std::string& file) {
  std::string& slot = all.*member;
  if (!slot.empty() && slot != file) {
    const char* kind = "";
    for (const auto& [name, known] : kinds)
      if (known == member) kind = name;
    throw ConfigError(Refusal::doubled_name, "files",
                      fmt::format("'{}' and '{}' would both be {}; say what they are: "
                                  "mass=FILE, stiffness=FILE and the like",
                                  slot, file, kind));
  }
  slot = file;
}

/// Refuses "mas=FILE", unless it is the name of a file.
void refuse_unknown_kind(const std::string& given) {
  const std::string written = given.substr(0, given.find('='));
  const bool is_word = !written.empty() && std::ranges::all_of(written, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  });
  std::error_code unreadable;
  if (written == given || !is_word || std::filesystem::exists(given, unreadable)) return;
  std::vector<std::string> names;
  for (const auto& [name, member] : kinds) names.emplace_back(name);
  throw ConfigError(Refusal::unknown_key, "files",
                    fmt::format("'{}' has the unknown key '{}'{} (there are: {})", given, written,
                                did_you_mean(written, names), fmt::join(names, ", ")));
}

/// Whether a table has a row of a matrix in each line, not a node alone.
bool is_of_unknowns(const std::string& file) {
  const SourceText source = read_source_text(file, "a table of nodes or of unknowns");
  TextLines lines(source);
  lines.skip_lines_with("#");
  if (!lines.next()) return false;
  if (!integer_in(lines.words().front()) && !lines.next()) return false;
  const std::size_t count = lines.words().size();
  return count == 1 || count == 2 || count == 5;
}

bool has_part(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

void sort_out_matrix(ImportedFiles& all, const std::string& file, const std::string& name,
                     const std::string& ending) {
  if (ending == ".sti" || has_part(name, "stif")) return set(all, &ImportedFiles::stiffness, file);
  if (ending == ".mas" || has_part(name, "mass")) return set(all, &ImportedFiles::mass, file);
  if (has_part(name, "damp")) return set(all, &ImportedFiles::damping, file);
  if (ending == ".pch") {
    set(all, &ImportedFiles::stiffness, file);
    return set(all, &ImportedFiles::mass, file);
  }
  throw ConfigError(Refusal::wrong_value, "files",
                    fmt::format("cannot tell what '{}' is; say it: mass=FILE, stiffness=FILE, "
                                "damping=FILE, unknowns=FILE, mesh=FILE, nodes=FILE or "
                                "universal=FILE",
                                file));
}

}  // namespace

ImportedFiles sort_out_files(const std::vector<std::string>& files) {
  ImportedFiles all;
  for (const std::string& given : files) {
    bool is_said = false;
    for (const auto& [kind, member] : kinds) {
      const std::string prefix = std::string(kind) + "=";
      if (given.compare(0, prefix.size(), prefix) != 0) continue;
      set(all, member, given.substr(prefix.size()));
      is_said = true;
    }
    if (is_said) continue;
    refuse_unknown_kind(given);
    const std::filesystem::path path(given);
    const std::string ending = lower_case_of(path.extension().string());
    const std::string name = lower_case_of(path.stem().string());
    if (ending == ".msh" || ending == ".inp") {
      set(all, &ImportedFiles::mesh, given);
    } else if (ending == ".uff" || ending == ".unv" || ending == ".uf") {
      set(all, &ImportedFiles::universal, given);
    } else if (ending == ".dof" || ending == ".mapping") {
      set(all, &ImportedFiles::unknowns, given);
    } else if (ending == ".csv" || ending == ".txt" || ending == ".tsv") {
      set(all, is_of_unknowns(given) ? &ImportedFiles::unknowns : &ImportedFiles::nodes, given);
    } else {
      sort_out_matrix(all, given, name, ending);
    }
  }
  return all;
}

}  // namespace stridor
