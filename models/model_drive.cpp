#include "models/model_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/suggestion.hpp"
#include "models/contact_pair.hpp"

namespace stridor {
namespace {

/// Name of the body of the endless masters that the only drive moves.
constexpr const char* moving_master = "moving rigid";

bool holds(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

double final_value(const TimeCurve& curve) {
  return curve.value(std::numeric_limits<double>::infinity());
}

/// What a load acts on, and whether the reduction keeps it.
struct LoadedPlace {
  DofSum load;
  bool is_kept = false;
};

bool is_surface(const BodyMatrices& matrices, const std::string& name) {
  return matrices.surfaces.contains(name) || matrices.facets.contains(name);
}

/// Names of the springs to ground, or of the surfaces, on which a body knows a load in y.
std::vector<std::string> loads_in_y(const BodyMatrices& matrices, bool of_surfaces) {
  std::vector<std::string> names;
  for (const auto& [name, load] : matrices.loads) {
    if (!name.ends_with(".y")) continue;
    const std::string place = name.substr(0, name.size() - 2);
    if (is_surface(matrices, place) == of_surfaces) names.push_back(place);
  }
  return names;
}

/// The place of a body by an entry of `load_on` without the name of the body: a point, a load of the
/// body's own, or a surface.
LoadedPlace place_to_load(const ModelBody& body, const std::string& place, const std::string& key) {
  const BodyMatrices& matrices = body.matrices;
  LoadedPlace found;
  if (const auto node = matrices.points.find(place); node != matrices.points.end()) {
    found = {matrices.displacement(node->second, 1), true};
  } else if (const auto named = matrices.loads.find(place); named != matrices.loads.end()) {
    // A load with a direction of its own, or of a surface along a named axis.
    found.load = named->second;
  } else if (is_surface(matrices, place)) {
    const std::optional<DofSum> load = matrices.load(place + ".y");
    const std::vector<std::string> known = loads_in_y(matrices, true);
    if (!load && known.empty()) {
      throw ConfigError(Refusal::missing, key,
                        fmt::format("'{}.{}' is a surface, over which bodies of this type "
                                    "spread no load; name a point",
                                    body.name, place));
    }
    found.load = load.value_or(DofSum{});
  } else {
    std::vector<std::string> known = names_in_map(matrices.points);
    for (const std::string& surface : names_in_map(matrices.surfaces)) known.push_back(surface);
    for (const std::string& surface : names_in_map(matrices.facets)) known.push_back(surface);
    for (const std::string& other : names_in_map(matrices.loads))
      if (other.find('.') == std::string::npos) known.push_back(other);
    throw ConfigError(
        Refusal::unknown_name, key,
        fmt::format("'{}' has no point, surface or load '{}'{} (it has: {})", body.name, place,
                    did_you_mean(place, known), listed_names(known)));
  }
  if (found.load.empty()) {
    throw ConfigError(
        Refusal::motion_is_held, key,
        fmt::format("'{}.{}' is held in y, so that no load moves it", body.name, place));
  }
  return found;
}

/// What a spring exerts when its ground end moves by 1 m in y.
DofSum spring_to_displace(const ModelBody& body, const std::string& spring,
                          const std::string& key) {
  const std::vector<std::string> known = loads_in_y(body.matrices, false);
  if (!holds(known, spring)) {
    throw ConfigError(
        Refusal::unknown_name, key,
        fmt::format("'{}' has no spring to ground '{}'{} (it has: {})", body.name, spring,
                    did_you_mean(spring, known), known.empty() ? "none" : listed_names(known)));
  }
  const DofSum load = body.matrices.load(spring + ".y").value();
  const bool acts = std::any_of(load.begin(), load.end(),
                                [](const DofWeight& dof) { return dof.weight != 0.0; });
  if (!acts) {
    throw ConfigError(
        Refusal::motion_is_held, key,
        fmt::format("'{}.{}' exerts nothing when its ground end moves in y", body.name, spring));
  }
  return load;
}

/// A body of a list by an entry that is its name alone; null where it is none.
const ModelBody* body_named(const std::string& name, const std::vector<ModelBody>& bodies) {
  const auto found = std::find_if(bodies.begin(), bodies.end(), [&](const ModelBody& body) {
    return body.parameters != nullptr && body.name == name;
  });
  return found == bodies.end() ? nullptr : &*found;
}

void require_guided(const ModelBody& body, const std::string& key) {
  if (body.matrices.follows_drive()) return;
  throw ConfigError(Refusal::motion_is_held, key,
                    fmt::format("'{}' has no guided support", body.name));
}

void refuse_repeated(const std::vector<std::string>& list, std::size_t entry,
                     const std::string& key) {
  if (std::find(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(entry), list[entry]) ==
      list.begin() + static_cast<std::ptrdiff_t>(entry))
    return;
  throw ConfigError(Refusal::doubled_name, key,
                    fmt::format("'{}' is named already; name it once", list[entry]));
}

/// Entries of a list without the name of the body, of those that are places of it, with their numbers.
std::vector<std::pair<std::string, std::size_t>> places_of(const std::vector<std::string>& list,
                                                           const ModelBody& body) {
  const std::string prefix = body.name + ".";
  std::vector<std::pair<std::string, std::size_t>> places;
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].starts_with(prefix)) places.emplace_back(list[i].substr(prefix.size()), i);
  return places;
}

bool loads_support(const SceneDrive& drive, const ModelBody& body) {
  return body.matrices.follows_drive() &&
         (drive.loads_guided() || holds(drive.parameters.load_on, body.name));
}

std::size_t num_forces_on(const SceneDrive& drive, const ModelBody& body) {
  if (body.parameters == nullptr) return 0;
  return (loads_support(drive, body) ? 1 : 0) + places_of(drive.parameters.load_on, body).size();
}

bool acts_on(const SceneDrive& drive, const ModelBody& body) {
  return num_forces_on(drive, body) > 0 || !places_of(drive.parameters.displaces, body).empty();
}

/// Refuses an entry of `moves` that is neither a body with guided supports nor a master without end.
void check_moved(const std::string& name, const std::string& key,
                 const std::map<std::string, ContactParameters>& pairs,
                 const std::vector<ModelBody>& bodies) {
  if (name == guided_supports) return;
  if (const ModelBody* const body = body_named(name, bodies)) {
    require_guided(*body, key);
    return;
  }
  const auto pair = std::find_if(pairs.begin(), pairs.end(),
                                 [&](const auto& one) { return one.first + ".master" == name; });
  if (pair == pairs.end()) {
    std::vector<std::string> known{guided_supports};
    for (const ModelBody& body : bodies)
      if (body.matrices.follows_drive()) known.push_back(body.name);
    for (const auto& one : pairs) known.push_back(one.first + ".master");
    throw ConfigError(Refusal::unknown_name, key,
                      fmt::format("there is no '{}' to move{} (there are: {})", name,
                                  did_you_mean(name, known), listed_names(known)));
  }
  if (!is_endless_master(pair->second.master)) {
    throw ConfigError(Refusal::motion_is_held, key,
                      fmt::format("'{}' is the surface of a body, which its supports hold; "
                                  "give that body a guided support",
                                  pair->second.master));
  }
}

}  // namespace

void check_drives(const std::vector<SceneDrive>& drives,
                  const std::map<std::string, ContactParameters>& pairs,
                  const std::vector<ModelBody>& bodies) {
  std::map<std::string, const SceneDrive*> movers;
  for (const SceneDrive& drive : drives) {
    const std::vector<std::string>& moves = drive.parameters.moves;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const std::string key = drive.key_of("moves", i);
      check_moved(moves[i], key, pairs, bodies);
      const auto [mover, is_first] = movers.emplace(moves[i], &drive);
      if (is_first) continue;
      throw ConfigError(Refusal::doubled_name, key,
                        fmt::format("'{}' is moved by {} already; one drive moves it", moves[i],
                                    mover->second->key));
    }
  }
}

int mover_of_master(const std::vector<SceneDrive>& drives, const std::string& pair) {
  for (std::size_t d = 0; d < drives.size(); ++d)
    if (holds(drives[d].parameters.moves, pair + ".master")) return static_cast<int>(d);
  return -1;
}

EndlessMasters add_endless_masters(const std::vector<SceneDrive>& drives,
                                   const std::map<std::string, ContactParameters>& pairs,
                                   std::vector<ModelBody>& bodies) {
  EndlessMasters endless;
  for (const auto& [name, pair] : pairs) {
    if (!is_endless_master(pair.master)) continue;
    const int mover = mover_of_master(drives, name);
    if (!endless.emplace(mover, static_cast<int>(bodies.size())).second) continue;
    ModelBody& body = bodies.emplace_back();
    body.drive = mover;
    body.name = rigid_master;
    if (mover < 0) continue;
    const SceneDrive& drive = drives[static_cast<std::size_t>(mover)];
    body.name = drive.is_only ? moving_master : fmt::format("{} of {}", moving_master, drive.name);
  }
  return endless;
}

void assign_drives(const std::vector<SceneDrive>& drives, std::vector<ModelBody>& bodies) {
  for (ModelBody& body : bodies) {
    if (!body.matrices.follows_drive()) continue;
    for (std::size_t d = 0; d < drives.size(); ++d) {
      const SceneDrive& drive = drives[d];
      if (!drive.moves_guided() && !holds(drive.parameters.moves, body.name)) continue;
      if (body.drive >= 0) {
        throw ConfigError(
            Refusal::doubled_name, drive.key_of("moves"),
            fmt::format("'{}' follows {} already, and a body follows one drive; name in `moves` of "
                        "each what it moves",
                        body.name, drives[static_cast<std::size_t>(body.drive)].key));
      }
      body.drive = static_cast<int>(d);
    }
  }
}

SystemBody make_rigid_body(const ModelBody& model) {
  SystemBody body;
  body.name = model.name;
  body.drive = model.drive;
  body.reduced.rows.resize(1, 0);
  body.modal.rows.resize(1, 0);
  return body;
}

void check_something_follows(const std::vector<SceneDrive>& drives,
                             const std::vector<Drive>& driven,
                             const std::vector<ModelBody>& bodies) {
  for (std::size_t d = 0; d < drives.size(); ++d) {
    const bool is_followed = std::any_of(bodies.begin(), bodies.end(), [&](const ModelBody& body) {
      return body.drive == static_cast<int>(d);
    });
    if (is_followed || driven[d].velocity.is_zero()) continue;
    throw ConfigError(
        Refusal::motion_is_held, drives[d].key_of("velocity"),
        fmt::format(
            "moves nothing: no body has a support that is guided{0}, and no master is "
            "named in {1}.moves; give the body that is to slide a guided support, or move "
            "a rigid or half_space master",
            drives[d].moves_guided() ? "" : fmt::format(" and named in {}.moves", drives[d].key),
            drives[d].key));
  }
}

PairDrive drive_of_pair(const std::vector<SceneDrive>& drives, const std::vector<ModelBody>& bodies,
                        int slave, int master) {
  PairDrive found;
  int of = drives.size() == 1 ? 0 : -1;
  for (const int body : {slave, master})
    if (of < 0) of = bodies[static_cast<std::size_t>(body)].drive;
  bool is_loaded = false;
  for (const int b : {slave, master}) {
    const ModelBody& body = bodies[static_cast<std::size_t>(b)];
    double load = 0.0;
    for (std::size_t d = 0; d < drives.size(); ++d) {
      if (of < 0 && acts_on(drives[d], body)) of = static_cast<int>(d);
      const std::size_t count = num_forces_on(drives[d], body);
      if (count == 0 || is_loaded) continue;
      load += static_cast<double>(count) * final_value(drives[d].parameters.load);
    }
    if (load == 0.0) continue;
    found.load = std::abs(load);
    is_loaded = true;
  }
  if (!is_loaded && drives.size() == 1)
    found.load = std::abs(final_value(drives.front().parameters.load));
  if (of >= 0) found.ramp = drives[static_cast<std::size_t>(of)].parameters.ramp;
  return found;
}

void check_loads(const std::vector<SceneDrive>& drives, const std::vector<ModelBody>& bodies) {
  for (const SceneDrive& drive : drives) {
    const std::vector<std::string>& loaded = drive.parameters.load_on;
    for (std::size_t i = 0; i < loaded.size(); ++i) {
      const std::string key = drive.key_of("load_on", i);
      refuse_repeated(loaded, i, key);
      if (loaded[i] == guided_supports) continue;
      if (const ModelBody* const body = body_named(loaded[i], bodies)) {
        require_guided(*body, key);
        continue;
      }
      const auto [b, place] = split_name(loaded[i], bodies, key);
      (void)place_to_load(bodies[static_cast<std::size_t>(b)], place, key);
    }
    const std::vector<std::string>& displaced = drive.parameters.displaces;
    for (std::size_t i = 0; i < displaced.size(); ++i) {
      const std::string key = drive.key_of("displaces", i);
      refuse_repeated(displaced, i, key);
      const auto [b, spring] = split_name(displaced[i], bodies, key);
      (void)spring_to_displace(bodies[static_cast<std::size_t>(b)], spring, key);
    }
  }
}

std::vector<BodyLoad> loads_of(ModelBody& body, const std::vector<SceneDrive>& drives) {
  std::vector<BodyLoad> loads;
  const BodyMatrices& matrices = body.matrices;
  if (matrices.follows_drive()) body.keep(matrices.load_dof);
  for (std::size_t d = 0; d < drives.size(); ++d) {
    const SceneDrive& drive = drives[d];
    const auto number = static_cast<int>(d);
    if (loads_support(drive, body))
      loads.push_back({body.row_of({{matrices.load_dof, 1.0}}), number, BodyLoad::By::force});
    for (const auto& [place, i] : places_of(drive.parameters.load_on, body)) {
      const LoadedPlace found = place_to_load(body, place, drive.key_of("load_on", i));
      if (found.is_kept)
        for (const DofWeight& dof : found.load) body.keep(dof.dof);
      loads.push_back({body.row_of(found.load), number, BodyLoad::By::force});
    }
    for (const auto& [spring, i] : places_of(drive.parameters.displaces, body)) {
      const DofSum load = spring_to_displace(body, spring, drive.key_of("displaces", i));
      loads.push_back({body.row_of(load), number, BodyLoad::By::shift});
    }
  }
  return loads;
}

}  // namespace stridor
