#include "io/scene/scene_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "core/errors.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/scene_problems.hpp"
#include "solvers/equilibrium/equilibrium.hpp"

namespace stridor {
namespace {

/// Magnitudes that bodies have which vibrate in sliding contact.
struct Usual {
  const char* unit;
  const char* word;  ///< that the name of the key holds; empty: any
  double low;
  double high;
  const char* remedy;
};
constexpr Usual usual_magnitudes[] = {
    {"m", "", 0.0, 10.0, "write a unit, as in '75 mm'"},
    {"Pa", "modulus", 1e3, 1e15, "write a unit, as in '71 GPa'"},
    {"kg m-3", "", 1.0, 1e5, "write a unit, as in '2.7 g/cm^3', or the number in kg m-3"},
    {"m s-1", "", 0.0, 1000.0, "write a unit, as in '30 mm/s'"},
};

bool is_written_bare(const SceneNode& tree, const std::string& path) {
  const SceneNode* node = find(tree, path);
  return node != nullptr && node->kind == SceneNode::Kind::scalar &&
         node->text.find_first_not_of("+-.0123456789eE") == std::string::npos;
}

void look_at_number(const Key& key, double value, const std::string& path, const SceneNode& tree,
                    std::vector<Problem>& warnings) {
  const double size = std::abs(value);
  if (size == 0.0) return;
  for (const Usual& usual : usual_magnitudes) {
    if (key.unit != usual.unit || key.name.find(usual.word) == std::string::npos) continue;
    if (size >= usual.low && size <= usual.high) continue;
    if (!is_written_bare(tree, path)) continue;
    warnings.push_back({Refusal::wrong_value, path,
                        fmt::format("is {:g} {}, since bare numbers are in SI units: {} if another "
                                    "one is meant",
                                    value, key.unit, usual.remedy)});
  }
}

void look_at_parameters(const Schema& schema, const void* object, std::vector<Problem>& warnings) {
  for (const Key& key : schema.keys) {
    if (key.kind != KeyKind::parameters) continue;
    const Value given = key.read(object);
    for (const NamedNumber& number : std::get<NamedNumbers>(given)) {
      if (number.is_used) continue;
      warnings.push_back({Refusal::wrong_value, join_path(key.name, number.name),
                          "no expression of the scene uses this parameter"});
    }
  }
}

/// Calls back for every number with a single value, at its key path.
template <class Look>
void visit_numbers(const Schema& schema, const void* object, const std::string& path,
                   const Look& look) {
  for (const Key& key : schema.keys) {
    const std::string key_path = join_path(path, key.name);
    if (key.read) {
      const Value value = key.read(object);
      if (const double* number = std::get_if<double>(&value)) look(key, *number, key_path);
    }
    if (!key.visit) continue;
    std::size_t index = 0;
    key.visit(object, [&](const std::string& name, std::size_t alternative, const void* nested) {
      const std::string entry = key.kind == KeyKind::section_list ? std::to_string(index++) : name;
      visit_numbers(key.alternatives[alternative].schema(), nested, join_path(key_path, entry),
                    look);
    });
  }
}

/// When the drive has carried a slave off the end of its master, s.
std::optional<double> leaving_time(const System& system, const ContactPoint& contact, double end) {
  if (contact.has_two_tangents()) return std::nullopt;
  const MasterSurface& surface = system.surface_of(contact);
  const DrivenMotion driven = system.driven_motion(contact);
  if (surface.is_endless || driven.is_frozen()) return std::nullopt;
  const Projection start =
      surface.project_undeformed(contact.first_segment, contact.slave_position);
  const double begin = surface.arc_at(contact.first_segment, start.weights);
  const double length = surface.arc_length.back();
  const double rounding = 1e-9 * length;
  constexpr int num_instants = 1000;
  for (int i = 0; i <= num_instants; ++i) {
    const double time = end * i / num_instants;
    const double place = begin + start.tangent.x() * driven.displacement(time);
    if (place < -rounding || place > length + rounding) return time;
  }
  return std::nullopt;
}

void look_at_paths(const LoadedScene& loaded, const System& system,
                   std::vector<Problem>& warnings) {
  if (!loaded.scene.time) return;
  for (const ContactPoint& contact : system.contacts) {
    const auto time = leaving_time(system, contact, loaded.scene.time->end);
    if (!time) continue;
    warnings.push_back(
        {Refusal::wrong_value, "time.end",
         fmt::format("the drive carries '{}' off the end of its master '{}' at about {:.3g} s (of "
                     "the undeformed bodies), where the run will fail; end it earlier, start "
                     "elsewhere (contact.start) or slide more slowly (drive.velocity)",
                     contact.name, system.surface_of(contact).name, *time)});
  }
}

enum class Pressing { forces, none, apart, unknown };

/// Whether contacts are pressed in the sliding equilibrium under the loads at a time, s.
Pressing pressing_at(const System& system, double time) {
  EquilibriumState state = sliding_state(system, 0.0);
  state.drives = drive_states(system, time);
  Equilibrium equilibrium;
  try {
    equilibrium = find_equilibrium(system, state);
  } catch (const NumericalError&) {
    return Pressing::unknown;  // bodies that nothing holds
  }
  if (equilibrium.status != EquilibriumStatus::converged) return Pressing::unknown;
  const auto& contacts = equilibrium.contacts;
  // A contact that is told to stay closed pulls instead of opening.
  const auto presses = [](const ContactEquilibrium& one) {
    return one.is_closed && one.force > 0.0;
  };
  const auto rests = [](const ContactEquilibrium& one) {
    return one.is_closed && one.force == 0.0;
  };
  if (std::any_of(contacts.begin(), contacts.end(), presses)) return Pressing::forces;
  return std::any_of(contacts.begin(), contacts.end(), rests) ? Pressing::none : Pressing::apart;
}

/// Loads that never press the bodies together, as one of the wrong sign.
void look_at_loads(const LoadedScene& loaded, const Model& model, std::vector<Problem>& warnings) {
  const System& system = model.system;
  if (!loaded.scene.time || model.sparse || system.contacts.empty()) return;
  const double end = loaded.scene.time->end;
  bool is_apart = false;
  for (const double time : {0.25 * end, 0.5 * end, end, std::numeric_limits<double>::infinity()}) {
    const Pressing pressing = pressing_at(system, time);
    if (pressing == Pressing::forces || pressing == Pressing::unknown) return;
    is_apart |= pressing == Pressing::apart;
  }
  const std::string key = find(loaded.tree, "drive") != nullptr    ? "drive"
                          : find(loaded.tree, "drives") != nullptr ? "drives"
                                                                   : "";
  warnings.push_back(
      {Refusal::wrong_value, key,
       is_apart
           ? "the loads pull the bodies apart: no contact presses in the equilibrium under them; "
             "loads act in +y, so a load of the other sign presses"
           : "nothing presses the bodies together: every contact force is 0 in equilibrium; give a "
             "load or, of a contact, normal.preload"});
}

/// Whether nothing moves a row of a body: the supports hold it.
bool is_held(const SystemBody& body, int row) {
  return body.modal.size() > 0 && body.modal.rows.row(row).isZero(0.0) &&
         (body.modal.residual.num_modes == 0 ||
          body.modal.residual.flexibility.row(row).isZero(0.0));
}

void look_at_channels(const Scene& scene, const Model& model, std::vector<Problem>& warnings) {
  if (!scene.record || model.sparse) return;
  for (const Channel& channel : parse_channels(*scene.record, scene.model)) {
    if (!channel.point) continue;
    const Model::Point& point = model.points.at(*channel.point);
    const SystemBody& body = model.system.bodies[static_cast<std::size_t>(point.body)];
    // What the drive carries along moves with it.
    const bool is_driven = body.follows_drive() && channel.direction == 0;
    if (is_driven || !is_held(body, point.rows.row(channel.direction))) continue;
    warnings.push_back(
        {Refusal::wrong_value, channel.key,
         fmt::format("'{}' will be recorded as zeros: '{}' is held in {} at this point; record "
                     "another point or direction",
                     channel.name, body.name, "xyz"[channel.direction])});
  }
}

}  // namespace

std::vector<Problem> key_warnings(const Schema& schema, const void* object, const SceneNode& tree) {
  std::vector<Problem> warnings;
  look_at_parameters(schema, object, warnings);
  visit_numbers(schema, object, "", [&](const Key& key, double value, const std::string& path) {
    look_at_number(key, value, path, tree, warnings);
  });
  locate(warnings, tree);
  return warnings;
}

std::vector<Problem> scene_warnings(const LoadedScene& loaded, const Model& model) {
  const Scene& scene = loaded.scene;
  std::vector<Problem> warnings = key_warnings(Scene::schema(), &scene, loaded.tree);
  for (const auto& [name, substructure] : scene.model.substructures) {
    for (Problem& warning : substructure->warnings()) {
      warning.key = join_path("substructures." + name, warning.key);
      warnings.push_back(std::move(warning));
    }
  }
  if (scene.time && scene.measure.from >= scene.time->end) {
    warnings.push_back({Refusal::wrong_value, "measure.from",
                        fmt::format("{:g} s is not before time.end = {:g} s: the window of the "
                                    "statistics is empty",
                                    scene.measure.from, scene.time->end)});
  }
  look_at_loads(loaded, model, warnings);
  look_at_paths(loaded, model.system, warnings);
  look_at_channels(scene, model, warnings);
  locate(warnings, loaded.tree);
  sort_by_place(warnings);
  return warnings;
}

}  // namespace stridor
