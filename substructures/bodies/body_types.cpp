// The types of bodies that scenes can name, a line each.
#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "substructures/bodies/beam.hpp"
#include "substructures/bodies/body_parameters.hpp"
#include "substructures/bodies/lumped_body.hpp"
#include "substructures/bodies/matrix_body.hpp"
#include "substructures/bodies/mesh_body.hpp"
#include "substructures/bodies/modes_body.hpp"
#include "substructures/bodies/plate_body.hpp"

namespace stridor {

const std::vector<Substructure::Type>& Substructure::types() {
  static const std::vector<Type> all{
      body_type<BeamParameters>(),
      body_type<LumpedParameters>(),
      body_type<TouchedMatrixBodyParameters>(),
      body_type<PlateBodyParameters>(),
      body_type<MeshBodyParameters>(),
      body_type<ModesBodyParameters>(),
  };
  return all;
}

std::size_t Substructure::type_index() const {
  const std::vector<Type>& all = types();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const Type& type) { return type.name == body_->type(); });
  if (found == all.end())
    throw std::logic_error(std::string("Substructure: not registered: ") + body_->type());
  return static_cast<std::size_t>(found - all.begin());
}

}  // namespace stridor
