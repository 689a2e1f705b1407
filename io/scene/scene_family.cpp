#include "io/scene/scene_family.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/suggestion.hpp"
#include "core/units.hpp"
#include "io/scene/assignment.hpp"
#include "io/scene/body_reader.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/scene_reader.hpp"
#include "io/scene/scene_words.hpp"
#include "solvers/equilibrium/equilibrium.hpp"

namespace stridor {
namespace {

std::vector<std::string> key_names(const Schema& schema) {
  std::vector<std::string> names;
  for (const Key& key : schema.keys) names.push_back(key.name);
  return names;
}

[[noreturn]] void fail_unknown(const std::string& option, const std::string& path,
                               const std::string& part, const std::string& below,
                               const std::vector<std::string>& known) {
  std::string advice = did_you_mean(part, known);
  if (advice.empty()) advice = fmt::format("; known there: {}", fmt::join(known, ", "));
  throw ConfigError(option, fmt::format("'{}': there is no key '{}'{}{}", path, part,
                                        below.empty() ? "" : " in '" + below + "'", advice));
}

/// An entry of named sections and what it holds.
struct NamedEntry {
  std::string name;
  std::size_t alternative = 0;
  const void* object = nullptr;
};

/// The parameters of a scene.
NamedNumbers parameters_of(const Schema& schema, const void* object) {
  for (const Key& key : schema.keys)
    if (key.kind == KeyKind::parameters) return std::get<NamedNumbers>(key.read(object));
  return {};
}

NumericKey parameter_key(const NamedNumbers& numbers, const std::string& path,
                         const std::string& option) {
  const std::size_t dot = std::min(path.find('.'), path.size());
  const std::string name = path.substr(std::min(dot + 1, path.size()));
  std::vector<std::string> names;
  for (const NamedNumber& number : numbers) {
    names.push_back(number.name);
    if (number.name != name) continue;
    if (!number.is_used) {
      throw ConfigError(option, fmt::format("no expression of the scene uses '{}', so varying it "
                                            "changes nothing",
                                            path));
    }
    return {path, number.unit, Range::any()};
  }
  fail_unknown(option, path, name, path.substr(0, dot), names);
}

std::vector<NamedEntry> entries_of(const Key& key, const void* object) {
  std::vector<NamedEntry> entries;
  if (object == nullptr) return entries;
  key.visit(object, [&](const std::string& name, std::size_t alternative, const void* entry) {
    entries.push_back({name, alternative, entry});
  });
  return entries;
}

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

bool is_parameter(const NumericKey& key) {
  return key.path.starts_with("parameters.");
}

NumericKey find_numeric_key(const Scene& scene, const std::string& path,
                            const std::string& option) {
  return find_numeric_key(Scene::schema(), &scene, path, option);
}

NumericKey find_numeric_key(const Schema& keys, const void* object, const std::string& path,
                            const std::string& option) {
  const Schema* schema = &keys;
  std::string walked;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string part = path.substr(begin, end - begin);
    const Key* key = schema->find(part);
    if (key == nullptr) {
      if (schema == &keys) {
        for (const NamedNumber& number : parameters_of(keys, object)) {
          if (number.name != part) continue;
          throw ConfigError(option, fmt::format("'{0}' is a parameter of the scene; write "
                                                "'parameters.{0}'",
                                                part));
        }
      }
      fail_unknown(option, path, part, walked, key_names(*schema));
    }
    walked = join_path(walked, part);
    begin = end + 1;
    const bool is_last = end == path.size();
    switch (key->kind) {
      case KeyKind::section: {
        if (is_last) {
          if (const Key* number = number_in_place_of(*key))
            return {path, number->unit, number->range, false};
          throw ConfigError(option,
                            fmt::format("'{}' is a section; name one of its numbers ({})", path,
                                        fmt::join(key_names(key->alternatives[0].schema()), ", ")));
        }
        const auto entries = entries_of(*key, object);
        object = entries.empty() ? nullptr : entries.front().object;
        schema = &key->alternatives[0].schema();
        break;
      }
      case KeyKind::named_sections: {
        const auto entries = entries_of(*key, object);
        std::vector<std::string> names;
        names.reserve(entries.size());
        for (const NamedEntry& entry : entries) names.push_back(entry.name);
        const std::size_t stop =
            std::min(path.find('.', std::min(begin, path.size())), path.size());
        const std::string name = is_last ? "" : path.substr(begin, stop - begin);
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) fail_unknown(option, path, name, walked, names);
        const NamedEntry& entry = entries[static_cast<std::size_t>(found - names.begin())];
        schema = &key->alternatives[entry.alternative].schema();
        object = entry.object;
        walked = join_path(walked, name);
        begin = stop + 1;
        if (stop == path.size()) {
          throw ConfigError(option, fmt::format("'{}' is a section; name one of its numbers ({})",
                                                path, fmt::join(key_names(*schema), ", ")));
        }
        break;
      }
      case KeyKind::parameters:
        return parameter_key(std::get<NamedNumbers>(key->read(object)), path, option);
      case KeyKind::integer:
      case KeyKind::real:
      case KeyKind::curve:
        if (!is_last) fail_unknown(option, path, path.substr(begin), walked, {});
        return {path, key->unit, key->range, key->kind == KeyKind::integer};
      case KeyKind::flag:
      case KeyKind::text:
      case KeyKind::choice:
      case KeyKind::real_list:
      case KeyKind::text_list:
      case KeyKind::section_list:
        throw ConfigError(option, fmt::format("'{}' is no number that could be varied, but {}",
                                              walked, expected_of(*key)));
    }
  }
  throw ConfigError(option, fmt::format("'{}' is not a key path", path));
}

double parse_value(const NumericKey& key, const std::string& text, const std::string& option) {
  double value = 0.0;
  try {
    value = parse_quantity(text, key.unit);
  } catch (const std::invalid_argument& error) {
    throw ConfigError(option, fmt::format("{} ({})", error.what(), key.path));
  }
  if (key.is_integer && value != std::round(value)) {
    throw ConfigError(option, fmt::format("'{}' must be a whole number, as {} is", text, key.path));
  }
  if (!key.range.contains(value)) {
    throw ConfigError(option, fmt::format("{} must be {}{}{}, got '{}'", key.path, key.range.text(),
                                          key.unit.empty() ? "" : " ", key.unit, text));
  }
  return value;
}

std::vector<double> spaced_values(const NumericKey& key, double from, double to, int count,
                                  Spacing spacing) {
  if (count < 1) throw ConfigError("--points", fmt::format("must be at least 1, got {}", count));
  if (from == to) return {from};
  if (count < 2) {
    throw ConfigError("--points", fmt::format("1 point is enough only where both ends of the range "
                                              "of {} are the same",
                                              key.path));
  }
  if (spacing == Spacing::logarithmic && !(from > 0.0 && to > 0.0)) {
    throw ConfigError("--scale", fmt::format("a logarithmic scale needs positive values of {}, got "
                                             "{:g} to {:g}",
                                             key.path, from, to));
  }
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / (count - 1);
    double value = spacing == Spacing::linear ? (1.0 - share) * from + share * to
                                              : from * std::pow(to / from, share);
    if (i == 0) value = from;
    if (i == count - 1) value = to;
    // 0.6·1 + 0.4·6 is not 3 to the last bit.
    constexpr double rounding = 1e-12;
    if (key.is_integer && std::abs(value - std::round(value)) <= rounding * std::abs(value))
      value = std::round(value);
    if (key.is_integer && value != std::round(value)) {
      throw ConfigError("--points",
                        fmt::format("{} points from {:g} to {:g} are not whole numbers, as {} is; "
                                    "{:g} points would be",
                                    count, from, to, key.path, std::abs(to - from) + 1.0));
    }
    values.push_back(value);
  }
  return values;
}

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
