// The sections of a Gmsh mesh, each from behind its heading to before its end.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "io/imports/gmsh_contents.hpp"
#include "io/imports/gmsh_cursor.hpp"

namespace stridor {

/// Tags of physical groups by dimension and tag of the entity.
using GmshEntities = std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::int64_t>>;

void read_gmsh_names(GmshCursor& cursor, GmshContents& contents);
void read_gmsh_entities(GmshCursor& cursor, GmshEntities& entities);

void read_gmsh_nodes_41(GmshCursor& cursor, const SourceText& source, GmshContents& contents);
/// Elements of entities that `entities` does not name are in no group.
void read_gmsh_elements_41(GmshCursor& cursor, const GmshEntities& entities,
                           GmshContents& contents);

void read_gmsh_nodes_22(GmshCursor& cursor, const SourceText& source, GmshContents& contents);
void read_gmsh_elements_22(GmshCursor& cursor, GmshContents& contents);

}  // namespace stridor
