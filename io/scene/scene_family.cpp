#include "io/scene/scene_family.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "io/scene/assignment.hpp"
#include "io/scene/body_reader.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/scene_reader.hpp"
#include "solvers/equilibrium/equilibrium.hpp"

namespace stridor {
namespace {

bool is_straight_along_drive(const MasterSurface& surface) {
  constexpr double negligible = 1e-12;
  for (int s = 0; s < surface.num_segments(); ++s) {
    const Segment segment = surface.undeformed_segment(s);
    const Eigen::Vector2d along = segment.second - segment.first;
    if (!(along.x() > 0.0 && std::abs(along.y()) <= negligible * along.x())) return false;
  }
  return true;
}

std::string assignment_of(const std::string& path, double value) {
  return fmt::format("{}={}", path, value);
}

/// The same error where the user wrote the ends of a range, not these values.
ConfigError in_settings(const ConfigError& error, const Settings& settings) {
  std::vector<Problem> problems = error.problems();
  for (Problem& problem : problems) {
    for (const auto& [path, value] : settings) {
      const std::string written = assignment_of(path, value);
      if (problem.source != "--set " + written) continue;
      problem.source = written;
      problem.excerpt.clear();
    }
  }
  return ConfigError(std::move(problems));
}

/// Takes over the tables of contact laws and what the files of bodies hold, which no number changes.
void keep_contents(const LoadedScene& changed, const ModelParameters& from, ModelParameters& to) {
  for (auto& [name, body] : to.substructures) {
    make_files_absolute("substructures." + name, changed.tree, *body);
    const auto before = from.substructures.find(name);
    if (before != from.substructures.end()) (void)body->take_contents(*before->second);
  }
  const auto keep = [](const NormalParameters& read, NormalParameters& kept) {
    if (!read.has_table()) return;
    kept.form = read.form;
    kept.table = read.table;
  };
  if (to.contact) keep(from.contact->normal, to.contact->normal);
  for (auto& [name, pair] : to.contacts) keep(from.contacts.at(name).normal, pair.normal);
}

}  // namespace

std::optional<std::string> start_key(const ModelParameters& model) {
  const auto pairs = model.pairs();
  // On faces and in space a place is no length.
  if (pairs.size() == 1 && has_two_tangents(model, pairs.begin()->second)) return std::nullopt;
  if (model.contact) return "contact.start";
  if (model.contacts.size() != 1) return std::nullopt;
  return "contacts." + model.contacts.begin()->first + ".start";
}

namespace {

/// Sets keys of a scene anew. @throws as with_settings(), the scene half changed
void apply_settings(LoadedScene& changed, const Settings& settings) {
  try {
    for (const auto& [path, value] : settings) {
      const std::string assignment = assignment_of(path, value);
      set_value(changed.tree, assignment);
      changed.sets.push_back(assignment);
    }
    const Scene before = std::exchange(changed.scene, read_as<Scene>(changed.tree));
    keep_contents(changed, before.model, changed.scene.model);
  } catch (const ConfigError& error) {
    throw in_settings(changed.located(error), settings);
  }
}

std::vector<std::string> paths_of(const Settings& settings) {
  std::vector<std::string> paths;
  for (const auto& setting : settings) paths.push_back(setting.first);
  return paths;
}

}  // namespace

LoadedScene with_settings(const LoadedScene& scene, const Settings& settings) {
  LoadedScene changed = scene;
  apply_settings(changed, settings);
  return changed;
}

Model build_model_with(const LoadedScene& scene, const Settings& settings, BodyCache& cache) {
  try {
    return build_model(scene, cache);
  } catch (const ConfigError& error) {
    throw in_settings(error, settings);
  }
}

SceneFamily::SceneFamily(LoadedScene loaded, std::vector<NumericKey> keys)
    : loaded_(std::move(loaded)), keys_(std::move(keys)) {
  const auto start = start_key(loaded_.scene.model);
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (start && keys_[i].path == *start) start_key_ = i;
    if (keys_[i].path == drive_displacement_name) drive_key_ = i;
  }
}

SceneFamily::Member SceneFamily::at(std::span<const double> values) {
  if (values.size() != keys_.size()) {
    throw std::invalid_argument(
        fmt::format("SceneFamily: {} values for {} keys", values.size(), keys_.size()));
  }
  Settings settings;
  for (std::size_t i = 0; i < keys_.size(); ++i)
    if (i != start_key_ && i != drive_key_) settings.emplace_back(keys_[i].path, values[i]);
  if (drive_key_) {
    if (start_key_) settings.emplace_back(keys_[*start_key_].path, values[*start_key_]);
    build(settings);
    return {&*model_, values[*drive_key_], std::nullopt, true};
  }
  if (start_key_) {
    // Always from the start in the scene, so that the answer does not depend on what was asked
    // before.
    try {
      build(settings);
      if (const auto displacement = displacement_to(values[*start_key_]))
        return {&*model_, *displacement, values[*start_key_], true};
    } catch (const ConfigError&) {
      // The start in the scene need not fit the other values.
    }
    settings.emplace_back(keys_[*start_key_].path, values[*start_key_]);
  }
  build(settings);
  const std::optional<double> start = position();
  return {&*model_, 0.0, start, start.has_value()};
}

/// Displacement of the drive from the model to a start; nothing where that is not the same as
/// starting there.
std::optional<double> SceneFamily::displacement_to(double start) const {
  const System& system = model_->system;
  const ContactPoint& point = system.contacts.front();
  const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(point.surface)];
  const bool is_on_master =
      surface.is_endless || (start >= 0.0 && start <= surface.arc_length.back());
  // One drive alone slides it: then only the slave is elsewhere.
  const bool is_slid = system.path_share(point.slave_body) == 1.0 &&
                       system.drive_of(surface.body) == nullptr;
  if (!is_on_master || !is_slid || !is_straight_along_drive(surface)) {
    return std::nullopt;
  }
  return drive_displacement_at(system, 0, start);
}

std::optional<double> SceneFamily::position() const {
  if (!start_key(loaded_.scene.model) || !displacement_to(start_)) return std::nullopt;
  return start_;
}

/// Makes the model of the scene with some keys set, unless it is there.
void SceneFamily::build(const Settings& settings) {
  if (model_ && settings == built_) return;
  model_.reset();
  // The same keys are set over and over: the tree is copied once for them.
  if (!changed_ || changed_keys_ != paths_of(settings)) {
    changed_ = loaded_;
    changed_keys_ = paths_of(settings);
  }
  changed_->sets = loaded_.sets;
  try {
    apply_settings(*changed_, settings);
  } catch (...) {
    changed_.reset();
    throw;
  }
  model_ = build_model_with(*changed_, settings, cache_);
  built_ = settings;
  const auto pairs = changed_->scene.model.pairs();
  if (!pairs.empty()) start_ = pairs.begin()->second.start.along.value_or(0.0);
}

}  // namespace stridor
