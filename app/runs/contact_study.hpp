// The viscoelastic normal laws of a scene, evaluated at speeds and indentations.
#pragma once

#include <string>
#include <vector>

#include "coupling/laws/normal_parameters.hpp"
#include "io/results/contact_file.hpp"
#include "io/scene/scene.hpp"
#include "solvers/half_space/sliding_contact.hpp"

namespace stridor {

/// A contact with a viscoelastic normal law.
struct StudiedContact {
  std::string name;
  std::string key;  ///< key path of its normal law, "contacts.NAME.normal"
  NormalParameters normal;
};

/// Those of a scene, by name.
/// @throws ConfigError if there is none, or boundary elements do not fit into the memory
std::vector<StudiedContact> viscoelastic_contacts(const LoadedScene& loaded);

/// Refuses a contact whose law is not computed by boundary elements.
/// @param wanted for what it must be, e.g. "--table"
/// @throws ConfigError
void require_boundary_elements(const LoadedScene& loaded, const StudiedContact& contact,
                               const std::string& wanted);

/// Refuses indentations and loads that an indenter of finite size cannot carry.
/// @throws ConfigError
void check_reach(const LoadedScene& loaded, const StudiedContact& contact,
                 const SlidingPoints& points);

/// The law at one speed and indentation as it is reported: dimensionless, with the fields where
/// they are wanted.
struct LawRow {
  double speed = 0.0;        ///< v̂
  double indentation = 0.0;  ///< ŷ
  double force = 0.0;        ///< F̃
  double area = 0.0;         ///< Ã
  SlidingContactResult result;
  std::vector<std::string> remarks;  ///< limitations of the row, in words
  ContactFields fields;
};

/// The law of a contact at all speeds for each indentation, or load: by boundary elements, or from
/// the fit, the master curve or the table that its form names.
/// @param keeps_fields of boundary elements
/// @throws Interrupted
std::vector<LawRow> evaluate_contact(const StudiedContact& contact, const SlidingPoints& points,
                                     bool keeps_fields);

}  // namespace stridor
