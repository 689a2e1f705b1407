#include "io/imports/gmsh_contents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/imports/gmsh_cursor.hpp"
#include "io/imports/gmsh_sections.hpp"

namespace stridor {
namespace {

constexpr const char* save_as_41 = "save it as 4.1: gmsh FILE -save -format msh41 -o NEW.msh";

/// $MeshFormat, of which the first line was read.
/// @return whether the version is 4.1
bool read_gmsh_format(GmshCursor& cursor, SourceText& source, GmshContents& contents) {
  const std::size_t begin = cursor.offset();
  const std::string_view words = cursor.line();
  const std::string_view version = words.substr(0, words.find_first_of(" \t"));
  const std::string_view rest = trimmed(words.substr(version.size()));
  const bool is_41 = version == "4.1";
  if (!is_41 && version != "2.2") {
    cursor.refuse(begin, fmt::format("a Gmsh mesh of version {}; expected 4.1 or 2.2: {}",
                                     shown(version), save_as_41));
  }
  const std::string_view kind = rest.substr(0, rest.find_first_of(" \t"));
  if (kind != "0" && kind != "1")
    cursor.refuse(begin, fmt::format("expected 0 (text) or 1 (binary) after the version, got '{}'",
                                     shown(kind)));
  const std::string_view size = trimmed(rest.substr(kind.size()));
  if (size != "8") {
    cursor.refuse(begin,
                  fmt::format("numbers of {} bytes; expected 8: {}", shown(size), save_as_41));
  }
  contents.format = fmt::format("Gmsh {}, {}", version, kind == "1" ? "binary" : "text");
  if (kind == "1") {
    source.places = PlaceForm::byte;
    cursor.turn_binary();
    const std::size_t marker = cursor.offset();
    const std::int64_t one = cursor.integer("the marker 1 of the byte order");
    if (one == 0x01000000) {
      cursor.refuse(marker, fmt::format("numbers with the most significant byte first; expected "
                                        "little-endian ones: {}, on this machine",
                                        save_as_41));
    }
    if (one != 1)
      cursor.refuse(marker, fmt::format("expected the marker 1 of the byte order, got {}", one));
  }
  cursor.end_section("MeshFormat");
  return is_41;
}

void refuse_other_formats(const GmshCursor& cursor, const SourceText& source) {
  const std::string foreign = foreign_format(source.text);
  if (!foreign.empty()) cursor.refuse(0, fmt::format("this is {}; expected a Gmsh mesh", foreign));
  if (source.text.rfind("$NOD", 0) == 0) {
    cursor.refuse(0,
                  fmt::format("a Gmsh mesh of version 1.0; expected 4.1 or 2.2: {}", save_as_41));
  }
}

class GmshReader {
 public:
  explicit GmshReader(SourceText& source) : source_(source), cursor_(source) {}

  GmshContents read() {
    refuse_other_formats(cursor_, source_);
    bool is_41 = false;
    if (!cursor_.skip_blank() || cursor_.line() != "$MeshFormat")
      cursor_.refuse(0, "expected a Gmsh mesh, which begins with $MeshFormat");
    is_41 = read_gmsh_format(cursor_, source_, contents_);
    while (cursor_.skip_blank()) read_section(is_41);
    if (!has_nodes_) cursor_.refuse(cursor_.offset(), "the file ends, expected a section $Nodes");
    if (!has_elements_)
      cursor_.refuse(cursor_.offset(), "the file ends, expected a section $Elements");
    return std::move(contents_);
  }

 private:
  void read_section(bool is_41) {
    const std::size_t begin = cursor_.offset();
    const std::string_view heading = cursor_.line();
    if (heading.size() < 2 || heading.front() != '$') {
      cursor_.refuse(begin,
                     fmt::format("expected a section such as $Nodes, got '{}'", shown(heading)));
    }
    const std::string_view name = heading.substr(1);
    if (name.substr(0, 3) == "End")
      cursor_.refuse(begin, fmt::format("${} without its beginning", shown(name)));
    if (name == "MeshFormat") cursor_.refuse(begin, "a second section $MeshFormat");
    if (name == "PartitionedEntities") {
      cursor_.refuse(begin,
                     "a partitioned mesh; expected a whole one: save it before it is partitioned");
    }
    if (name == "ParametricNodes")
      cursor_.refuse(begin, "a section $ParametricNodes; save with Mesh.SaveParametric = 0");
    if (name == "PhysicalNames") {
      read_gmsh_names(cursor_, contents_);
    } else if (name == "Entities" && is_41) {
      read_gmsh_entities(cursor_, entities_);
    } else if (name == "Nodes") {
      if (std::exchange(has_nodes_, true)) cursor_.refuse(begin, "a second section $Nodes");
      is_41 ? read_gmsh_nodes_41(cursor_, source_, contents_)
            : read_gmsh_nodes_22(cursor_, source_, contents_);
    } else if (name == "Elements") {
      if (std::exchange(has_elements_, true)) cursor_.refuse(begin, "a second section $Elements");
      is_41 ? read_gmsh_elements_41(cursor_, entities_, contents_)
            : read_gmsh_elements_22(cursor_, contents_);
    } else {
      const std::string skipped = "$" + shown(name);
      auto& list = contents_.skipped;
      if (std::find(list.begin(), list.end(), skipped) == list.end()) list.push_back(skipped);
      cursor_.skip_section(name, begin);
      return;
    }
    cursor_.end_section(name);
  }

  SourceText& source_;
  GmshCursor cursor_;
  GmshContents contents_;
  GmshEntities entities_;
  bool has_nodes_ = false;
  bool has_elements_ = false;
};

}  // namespace

GmshContents read_gmsh_contents(SourceText& source) {
  return GmshReader(source).read();
}

}  // namespace stridor
