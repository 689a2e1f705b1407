#include "app/runs/contact_study.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "app/terminal/progress.hpp"
#include "core/errors.hpp"
#include "core/memory.hpp"
#include "core/stop_token.hpp"
#include "models/set_up_estimate.hpp"

namespace stridor {
namespace {

ContactFields fields_of(const SlidingContact& contact, double composite_modulus) {
  const auto n = static_cast<std::size_t>(contact.parameters().grid);
  const double side = contact.cell_side();
  ContactFields fields;
  for (std::size_t i = 0; i < n; ++i)
    fields.x.push_back((static_cast<double>(i) + 0.5 - 0.5 * static_cast<double>(n)) * side);
  for (std::size_t j = 0; j < n / 2; ++j) fields.y.push_back((static_cast<double>(j) + 0.5) * side);
  fields.pressure = contact.pressure();
  for (double& p : fields.pressure) p *= composite_modulus;
  fields.gap = contact.gap();
  for (const auto& [x, y] : contact.edge().points) fields.edge.push_back({x * side, y * side});
  return fields;
}

/// A row by boundary elements.
LawRow solved_row(SlidingContact& contact, const NormalParameters& normal, double speed,
                  double depth, bool is_loaded) {
  const double radius = normal.tip_radius();
  const CreepLengths creep = creep_lengths(*normal.material, radius, speed);
  LawRow row;
  row.speed = speed;
  row.result = is_loaded ? contact.load(depth * radius * radius, creep)
                         : contact.indent(depth * radius, creep);
  row.indentation = row.result.indentation / radius;
  row.force = row.result.force / (radius * radius);
  row.area = row.result.area / (radius * radius);
  row.remarks = row.result.remarks();
  return row;
}

/// A row of a law in closed form or of a table.
LawRow law_row(const NormalParameters& normal, double speed, double depth, bool is_loaded) {
  SubstrateContact contact;
  contact.law = make_substrate_contact(normal).law;
  LawRow row;
  row.speed = speed;
  row.indentation =
      is_loaded ? contact.under(depth, speed, std::copysign(1.0, speed)).indentation : depth;
  const ViscoelasticContact value = contact.law->at(row.indentation, speed);
  row.force = value.force.value;
  row.area = value.area.value;
  const double radius = normal.tip_radius();
  row.result.indentation = row.indentation * radius;
  row.result.force = row.force * radius * radius;
  row.result.area = row.area * radius * radius;
  row.result.friction = value.friction.value;
  row.result.converged = std::isfinite(row.force);
  row.result.memory_in_cells = std::numeric_limits<double>::infinity();
  if (value.range == LawRange::too_deep)
    row.remarks.push_back("deeper than the law goes: continued");
  if (value.range == LawRange::beyond_data)
    row.remarks.push_back("beyond the speeds and indentations of the law: continued");
  return row;
}

}  // namespace

std::vector<StudiedContact> viscoelastic_contacts(const LoadedScene& loaded) {
  const ModelParameters& model = loaded.scene.model;
  std::vector<StudiedContact> contacts;
  for (const auto& [name, pair] : model.pairs()) {
    if (!pair.normal.law->has_area()) continue;
    const std::string key = (model.contact ? name : "contacts." + name) + ".normal";
    contacts.push_back({name, key, pair.normal});
    if (!pair.normal.is_solved()) continue;
    try {
      require_memory(
          estimate_set_up(pair.normal.solver.value_or(SlidingContactParameters{}), key + ".solver"),
          memory_limit());
    } catch (const ConfigError& error) {
      throw loaded.located(error);
    }
  }
  if (contacts.empty()) {
    throw loaded.located(ConfigError(
        Refusal::wrong_value, model.contact ? "contact" : "contacts",
        fmt::format("the scene has no contact with the normal law {}, the one that `contact` "
                    "evaluates",
                    normal_laws_with([](const NormalLawType& law) { return law.has_area(); }))));
  }
  return contacts;
}

void require_boundary_elements(const LoadedScene& loaded, const StudiedContact& contact,
                               const std::string& wanted) {
  if (contact.normal.is_solved()) return;
  throw loaded.located(
      ConfigError(Refusal::contradiction, contact.key + ".form",
                  fmt::format("must be solve for {}, which takes boundary elements", wanted)));
}

void check_reach(const LoadedScene& loaded, const StudiedContact& contact,
                 const SlidingPoints& points) {
  if (!contact.normal.is_solved()) return;
  const double radius = contact.normal.tip_radius();
  const IndenterProfile profile(contact.normal.indenter());
  const auto refuse = [&](const std::string& message) {
    throw loaded.located(ConfigError(Refusal::wrong_value, contact.key + ".profile", message));
  };
  for (const double indentation : points.indentations) {
    if (!profile.elastic_contact_radius(indentation * radius)) {
      refuse(
          fmt::format("is in contact up to its end at an indentation of {:g} R; its table must "
                      "reach further",
                      indentation));
    }
  }
  const double reach = profile.reach();
  for (const double load : points.loads) {
    if (std::isfinite(reach) && profile.elastic_force(reach) <= load * radius * radius)
      refuse(fmt::format("is in contact up to its end under a load of {:g} E_0* R2", load));
  }
}

std::vector<LawRow> evaluate_contact(const StudiedContact& contact, const SlidingPoints& points,
                                     bool keeps_fields) {
  const NormalParameters& normal = contact.normal;
  std::optional<SlidingContact> solver;
  if (normal.is_solved()) {
    solver.emplace(normal.solver.value_or(SlidingContactParameters{}),
                   IndenterProfile(normal.indenter()));
  }
  const bool is_loaded = !points.loads.empty();
  const std::vector<double>& depths = is_loaded ? points.loads : points.indentations;
  std::vector<LawRow> rows;
  Progress progress("contact");
  for (const double depth : depths) {
    for (const double speed : points.speeds) {
      if (stop_requested()) throw Interrupted("nothing has been written");
      rows.push_back(solver ? solved_row(*solver, normal, speed, depth, is_loaded)
                            : law_row(normal, speed, depth, is_loaded));
      if (solver && keeps_fields)
        rows.back().fields = fields_of(*solver, normal.composite_modulus());
      progress.report(static_cast<double>(rows.size()) /
                          static_cast<double>(depths.size() * points.speeds.size()),
                      fmt::format("speed {:g}, indentation {:g}", speed, rows.back().indentation));
    }
  }
  progress.finish();
  return rows;
}

}  // namespace stridor
