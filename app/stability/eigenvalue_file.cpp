#include "app/stability/eigenvalue_file.hpp"

#include <cmath>
#include <vector>

#include "app/results/file_attributes.hpp"
#include "app/stability/eigenvalue_report.hpp"
#include "app/stability/lowest_eigenvalues.hpp"
#include "io/results/column_file.hpp"

namespace stridor {
namespace {

/// A column of numbers, one of each element of a list.
template <typename List, typename Of>
Column column_of(const std::string& path, const std::string& units, const List& list, Of&& of) {
  Column column{path, units, {}};
  for (const auto& one : list) column.values.push_back(of(one));
  return column;
}

void add_eigenvalues(const std::vector<Eigenvalue>& found, std::vector<Column>& columns) {
  const auto add = [&](const char* path, const char* units, auto&& of) {
    columns.push_back(column_of(path, units, found, of));
  };
  add("/eigenvalues/growth", "1/s", [](const Eigenvalue& one) { return one.growth(); });
  add("/eigenvalues/frequency", "Hz", [](const Eigenvalue& one) { return one.frequency(); });
  add("/eigenvalues/damping_ratio", "1", [](const Eigenvalue& one) {
    const double size = std::abs(one.s);
    return size > 0.0 ? -one.growth() / size : 0.0;
  });
  add("/eigenvalues/growing", "1",
      [](const Eigenvalue& one) { return is_growing(one) ? 1.0 : 0.0; });
  add("/eigenvalues/residual", "1", [](const Eigenvalue& one) { return one.residual; });
  add("/eigenvalues/doubtful", "1",
      [](const Eigenvalue& one) { return is_doubtful(one) ? 1.0 : 0.0; });
}

void add_contacts(const System& system, const Equilibrium& equilibrium,
                  std::vector<Column>& columns) {
  if (equilibrium.contacts.empty()) return;
  Column names{"/equilibrium/contact", "", {}};
  for (std::size_t i = 0; i < equilibrium.contacts.size(); ++i)
    names.texts.push_back(system.contacts[i].name);
  columns.push_back(std::move(names));
  const auto add = [&](const char* path, const char* units, auto&& of) {
    columns.push_back(column_of(path, units, equilibrium.contacts, of));
  };
  using Contact = ContactEquilibrium;
  add("/equilibrium/closed", "1", [](const Contact& one) { return one.is_closed ? 1.0 : 0.0; });
  add("/equilibrium/force", "N", [](const Contact& one) { return one.force; });
  add("/equilibrium/friction_force", "N", [](const Contact& one) { return one.friction_force; });
  add("/equilibrium/friction_across", "N", [](const Contact& one) { return one.friction_across; });
  add("/equilibrium/slip_velocity", "m/s", [](const Contact& one) { return one.slip_velocity; });
  add("/equilibrium/position", "m", [](const Contact& one) { return one.position; });
  add("/equilibrium/gap", "m", [](const Contact& one) { return one.gap; });
}

/// Of which modes without friction the mode explained is made.
void add_shares(const Json& explanation, std::vector<Column>& columns) {
  if (!explanation.contains("frictionless_modes")) return;
  const Json& modes = explanation["frictionless_modes"];
  if (modes.empty()) return;
  const auto of = [](const char* key) {
    return [key](const Json& mode) { return mode[key].get<double>(); };
  };
  columns.push_back(column_of("/frictionless_modes/frequency", "Hz", modes, of("frequency")));
  columns.push_back(column_of("/frictionless_modes/share", "1", modes, of("share")));
}

}  // namespace

void write_eigenvalue_file(const std::string& path, Overwrite overwrite, const Analysis& analysis,
                           const Json& explanation, Attributes attributes) {
  std::vector<Column> columns;
  add_eigenvalues(analysis.found.eigenvalues, columns);
  if (!analysis.is_sparse())
    add_contacts(analysis.member.model->system, analysis.state.equilibrium, columns);
  if (!explanation.is_null()) {
    add_shares(explanation, columns);
    append_results({{"explanation", explanation}}, attributes);
  }
  for (const auto& [name, value] :
       {std::pair{"highest_frequency", analysis.found.highest}, {"trusted_frequency", analysis.trusted}})
    if (std::isfinite(value)) attributes.emplace_back(name, value);
  write_column_file(path, overwrite, "eigenvalues", columns, attributes);
}

}  // namespace stridor
