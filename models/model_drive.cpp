#include "models/model_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/suggestion.hpp"
#include "models/contact_pair.hpp"

namespace stridor {
namespace {

/// Name of the body of the endless masters that the drive moves.
constexpr const char* moving_master = "moving rigid";

/// Whether a list of the drive holds the guided supports.
bool names_guided(const std::vector<std::string>& list) {
  return list.empty() || std::find(list.begin(), list.end(), guided_supports) != list.end();
}

}  // namespace

bool moves_master(const DriveParameters& drive, const std::string& pair) {
  return std::find(drive.moves.begin(), drive.moves.end(), pair + ".master") != drive.moves.end();
}

void check_drive(const DriveParameters& drive,
                 const std::map<std::string, ContactParameters>& pairs) {
  for (std::size_t i = 0; i < drive.moves.size(); ++i) {
    const std::string& name = drive.moves[i];
    if (name == guided_supports) continue;
    const std::string key = fmt::format("drive.moves.{}", i);
    const auto pair = std::find_if(pairs.begin(), pairs.end(),
                                   [&](const auto& one) { return one.first + ".master" == name; });
    if (pair == pairs.end()) {
      std::vector<std::string> known{guided_supports};
      for (const auto& one : pairs) known.push_back(one.first + ".master");
      throw ConfigError(key, fmt::format("there is no '{}' to move{} (there are: {})", name,
                                         did_you_mean(name, known), listed_names(known)));
    }
    if (!is_endless_master(pair->second.master)) {
      throw ConfigError(key, fmt::format("'{}' is the surface of a body, which its supports hold; "
                                         "give that body a guided support",
                                         pair->second.master));
    }
  }
}

EndlessMasters add_endless_masters(const DriveParameters& drive,
                                   const std::map<std::string, ContactParameters>& pairs,
                                   std::vector<ModelBody>& bodies) {
  EndlessMasters endless;
  for (const auto& [name, pair] : pairs) {
    if (!is_endless_master(pair.master)) continue;
    const bool moves = moves_master(drive, name);
    int& index = moves ? endless.moving : endless.at_rest;
    if (index >= 0) continue;
    index = static_cast<int>(bodies.size());
    bodies.emplace_back();
    bodies.back().name = moves ? moving_master : rigid_master;
  }
  return endless;
}

SystemBody make_rigid_body(const std::string& name) {
  SystemBody body;
  body.name = name;
  body.follows_drive = name == moving_master;
  body.reduced.rows.resize(1, 0);
  body.modal.rows.resize(1, 0);
  return body;
}

bool follows_drive(const ModelBody& body, const DriveParameters& drive) {
  return body.matrices.follows_drive() && names_guided(drive.moves);
}

void check_something_follows(const DriveParameters& parameters, const Drive& drive,
                             const std::vector<ModelBody>& bodies, const EndlessMasters& endless) {
  const std::vector<double>& velocities = drive.velocity.table().values;
  const bool is_at_rest =
      std::all_of(velocities.begin(), velocities.end(), [](double v) { return v == 0.0; });
  const bool is_followed = std::any_of(bodies.begin(), bodies.end(), [&](const ModelBody& body) {
    return body.parameters != nullptr && follows_drive(body, parameters);
  });
  if (is_at_rest || is_followed || endless.moving >= 0) return;
  throw ConfigError("drive.velocity",
                    fmt::format("moves nothing: no body has a support that is guided{}, and no "
                                "master is named in drive.moves; give the body that is to slide a "
                                "guided support, or move a rigid or half_space master",
                                names_guided(parameters.moves) ? "" : " and named in drive.moves"));
}

double final_load(const DriveParameters& drive) {
  return std::abs(drive.load.value(std::numeric_limits<double>::infinity()));
}

void check_loads(const DriveParameters& drive, const std::vector<ModelBody>& bodies) {
  for (std::size_t i = 0; i < drive.load_on.size(); ++i) {
    const std::string& name = drive.load_on[i];
    if (name == guided_supports) continue;
    const std::string key = fmt::format("drive.load_on.{}", i);
    const auto [b, point] = split_name(name, bodies, key);
    const ModelBody& body = bodies[static_cast<std::size_t>(b)];
    const int node = node_at(body, point, key);
    if (!body.matrices.moves(node, 1))
      throw ConfigError(key, fmt::format("'{}' is held in y, so that no load moves it", name));
  }
}

int load_row_of(ModelBody& body, const DriveParameters& drive) {
  DofSum load;
  if (body.matrices.follows_drive()) {
    body.keep(body.matrices.load_dof);
    if (names_guided(drive.load_on)) load = {{body.matrices.load_dof, 1.0}};
  }
  for (std::size_t i = 0; i < drive.load_on.size(); ++i) {
    const std::string prefix = body.name + ".";
    if (!drive.load_on[i].starts_with(prefix)) continue;
    const std::string key = fmt::format("drive.load_on.{}", i);
    if (!load.empty()) {
      throw ConfigError(key, fmt::format("'{}' carries the drive's load already; one place of each "
                                         "body can",
                                         body.name));
    }
    load = body.matrices.displacement(node_at(body, drive.load_on[i].substr(prefix.size()), key), 1);
    for (const DofWeight& dof : load) body.keep(dof.dof);
  }
  return load.empty() ? -1 : body.row_of(load);
}

}  // namespace stridor
