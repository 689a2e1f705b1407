// What the keywords of Abaqus and CalculiX input say of nodes, elements, sets and surfaces.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/imports/inp_lines.hpp"
#include "io/imports/inp_sets.hpp"
#include "io/imports/mesh_draft.hpp"

namespace stridor {

/// A surface before labels are resolved.
struct InpSurface {
  struct Sides {
    bool is_set = false;       ///< else a single element
    std::int64_t element = 0;  ///< its label, or the number of the set
    std::string side;          ///< "S3", "E1"
    TextPlace place;
  };
  InpScope scope = InpScope::part;
  std::string name;
  TextPlace place;
  std::vector<Sides> sides;
};

struct InpContents {
  MeshDraft draft;
  std::vector<bool> is_shell;  ///< of the elements
  InpSets node_sets{"node"};
  InpSets element_sets{"element"};
  std::vector<InpSurface> surfaces;
  std::string instance;              ///< its name, or that of the part; may be empty
  std::vector<std::string> skipped;  ///< keywords
};

/// @throws ConfigError with the place
InpContents read_inp_contents(InpLines& lines);

}  // namespace stridor
