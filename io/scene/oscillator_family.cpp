#include "io/scene/oscillator_family.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Whether an expression needs one of these names.
bool needs_any(const std::string& expression, const std::vector<std::string>& names) {
  const std::vector<std::string> needs = names_in(expression);
  return std::any_of(needs.begin(), needs.end(),
                     [&](const std::string& name) { return contains(names, name); });
}

/// Sections of which no number has an influence on the oscillator.
bool is_idle(const std::string& path) {
  constexpr const char* sections[] = {"time.",    "record.",     "measure.", "spectrogram.",
                                      "initial.", "checkpoint.", "expect.",  "cycle."};
  return std::any_of(std::begin(sections), std::end(sections),
                     [&](const char* section) { return path.starts_with(section); });
}

/// Whether a number is the load or the speed of a drive.
bool is_of_drive(const std::string& path) {
  const bool is_drive = path.starts_with("drive.") || path.starts_with("drives.");
  return is_drive && (path.ends_with(".velocity") || path.ends_with(".load"));
}

/// Whether a number changes laws, load or speed alone.
bool leaves_body(const std::string& path) {
  if (is_of_drive(path)) return true;
  return path.starts_with("contact") && (path.find(".normal.") != std::string::npos ||
                                         path.find(".friction.") != std::string::npos);
}

/// The struct of an entry of a section. @return null where there is none
std::pair<const Schema*, void*> entry_of(const Key& key, void* object, const std::string& name) {
  std::pair<const Schema*, void*> found{nullptr, nullptr};
  std::size_t index = 0;
  key.visit(object, [&](const std::string& entry, std::size_t alternative, const void* nested) {
    const bool is_it = key.kind == KeyKind::section        ? true
                       : key.kind == KeyKind::section_list ? std::to_string(index++) == name
                                                           : entry == name;
    // The scene is this family's own.
    if (is_it) found = {&key.alternatives[alternative].schema(), const_cast<void*>(nested)};
  });
  return found;
}

/// The drives in the order of System::drives; null for one that is not there.
std::vector<const DriveParameters*> drives_of(const ModelParameters& model) {
  if (model.drives.empty()) return {model.drive ? &*model.drive : nullptr};
  std::vector<const DriveParameters*> all;
  for (const auto& [name, parameters] : model.drives) all.push_back(&parameters);
  return all;
}

/// Calls with the path of every expression of a scene that needs one of these names.
template <class Visit>
void visit_expressions(const SceneNode& node, const std::string& path,
                       const std::vector<std::string>& names, const Visit& visit) {
  if (node.kind == SceneNode::Kind::scalar && is_expression(node.text) &&
      needs_any(node.text, names))
    visit(path, node.text);
  for (const SceneEntry& entry : node.entries) {
    if (path.empty() && entry.key == "parameters") continue;
    visit_expressions(entry.value, join_path(path, entry.key), names, visit);
  }
  for (std::size_t i = 0; i < node.items.size(); ++i)
    visit_expressions(node.items[i], join_path(path, std::to_string(i)), names, visit);
}

}  // namespace

std::unique_ptr<OscillatorFamily> OscillatorFamily::make(const LoadedScene& loaded,
                                                         std::vector<NumericKey> keys) {
  for (const NumericKey& key : keys) {
    const bool is_place = key.path == drive_displacement_name || key.path.ends_with(".start");
    if (is_place || key.is_integer) return nullptr;
  }
  std::unique_ptr<OscillatorFamily> family(new OscillatorFamily(loaded, std::move(keys)));
  const bool is_one = family->find_mass() && family->add_parameters() && family->add_numbers();
  return is_one ? std::move(family) : nullptr;
}

bool OscillatorFamily::find_mass() {
  if (loaded_.scene.model.pairs().size() != 1) return false;
  const Model model = build_model(loaded_, cache_);
  std::optional<SlidingMass> mass = as_sliding_mass(model.system);
  if (!mass) return false;
  const SystemBody& body = model.system.bodies[static_cast<std::size_t>(mass->body)];
  // One force presses it, of which the law may know; else all is made anew.
  if (body.loads.size() == 1 && body.loads.front().by == BodyLoad::By::force) {
    load_drive_ = body.loads.front().drive;
  } else {
    makes_body_ = true;
  }
  base_drive_ = body.drive;
  const int master = model.system.surfaces.front().body;
  master_drive_ = model.system.bodies[static_cast<std::size_t>(master)].drive;
  drives_ = drives_of(loaded_.scene.model);
  oscillator_ = scaled(*std::move(mass));
  return true;
}

/// Parameters that depend on what varies, each after those that it needs.
bool OscillatorFamily::add_parameters() {
  for (const NamedNumber& number : loaded_.scene.parameters) numbers_[number.name] = number.value;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (!is_parameter(keys_[i])) continue;
    const std::string name = keys_[i].path.substr(keys_[i].path.find('.') + 1);
    varied_.push_back(name);
    parameters_.push_back({&numbers_.at(name), {i, {}}});
  }
  const SceneEntry* written = loaded_.tree.entry("parameters");
  if (written == nullptr) return true;
  // All that depend on them, then in order.
  std::vector<const SceneEntry*> waiting;
  std::vector<std::string> depend = varied_;
  for (bool is_complete = false; !is_complete;) {
    is_complete = true;
    for (const SceneEntry& entry : written->value.entries) {
      const std::string& text = entry.value.text;
      if (contains(depend, entry.key) || !is_expression(text) || !needs_any(text, depend)) continue;
      depend.push_back(entry.key);
      waiting.push_back(&entry);
      is_complete = false;
    }
  }
  while (!waiting.empty()) {
    const auto next = std::find_if(waiting.begin(), waiting.end(), [&](const SceneEntry* one) {
      return std::none_of(waiting.begin(), waiting.end(), [&](const SceneEntry* other) {
        return contains(names_in(one->value.text), other->key);
      });
    });
    if (next == waiting.end()) return false;
    varied_.push_back((*next)->key);
    parameters_.push_back(
        {&numbers_.at((*next)->key), {0, CompiledExpression((*next)->value.text, numbers_)}});
    waiting.erase(next);
  }
  return true;
}

bool OscillatorFamily::add_numbers() {
  bool is_simple = true;
  for (std::size_t i = 0; i < keys_.size(); ++i)
    if (!is_parameter(keys_[i])) is_simple &= add_number(keys_[i].path, {i, {}});
  const std::size_t num_keys = keys_.size();
  visit_expressions(
      loaded_.tree, "", varied_, [&](const std::string& path, const std::string& text) {
        const bool is_varied =
            std::any_of(keys_.begin(), keys_.begin() + static_cast<std::ptrdiff_t>(num_keys),
                        [&](const NumericKey& key) { return key.path == path; });
        if (!is_varied && !is_idle(path))
          is_simple &= add_number(path, {0, CompiledExpression(text, numbers_)});
      });
  return is_simple;
}

/// @return false where the path is not that of a single number
bool OscillatorFamily::add_number(const std::string& path, Source source) {
  const Schema* schema = &Scene::schema();
  void* object = &loaded_.scene;
  for (std::size_t begin = 0; begin <= path.size();) {
    const auto part = [&] {
      const std::size_t end = std::min(path.find('.', begin), path.size());
      const std::string text = path.substr(begin, end - begin);
      begin = end + 1;
      return text;
    };
    const Key* key = schema->find(part());
    if (key == nullptr) return false;
    if (const Key* number = begin > path.size() ? number_in_place_of(*key) : nullptr) {
      object = entry_of(*key, object, "").second;
      if (object == nullptr) return false;
      key = number;
    }
    if (key->kind == KeyKind::real || key->kind == KeyKind::curve) {
      if (begin <= path.size()) return false;
      changes_.push_back({{key, object}, std::move(source), is_of_drive(path)});
      makes_body_ |= !leaves_body(path);
      return true;
    }
    if (!key->visit || begin > path.size()) return false;
    const auto entry = entry_of(*key, object, key->kind == KeyKind::section ? "" : part());
    if (entry.first == nullptr) return false;
    schema = entry.first;
    object = entry.second;
  }
  return false;
}

ContactParameters& OscillatorFamily::pair() {
  ModelParameters& model = loaded_.scene.model;
  return model.contact ? *model.contact : model.contacts.begin()->second;
}

const ContactParameters& OscillatorFamily::pair() const {
  const ModelParameters& model = loaded_.scene.model;
  return model.contact ? *model.contact : model.contacts.begin()->second;
}

/// Gives the scene the numbers that have changed.
/// @return whether all values are in the range of their keys
bool OscillatorFamily::assign(std::span<const double> values) {
  try {
    for (const Parameter& parameter : parameters_) *parameter.number = parameter.source.of(values);
    for (Number& number : changes_) {
      const double value = number.source.of(values);
      if (value == number.last) continue;
      if (!number.target.key->range.contains(value)) return false;
      number.target.key->assign(number.target.object, value);
      number.last = value;
      are_laws_stale_ |= !number.is_of_drive;
    }
  } catch (const std::domain_error&) {
    return false;
  }
  return !are_laws_stale_ || are_laws_sound();
}

bool OscillatorFamily::are_laws_sound() const {
  std::vector<Problem> problems;
  const auto check = [&](const Schema& schema, const void* object) {
    for (const auto& one : schema.checks) one(object, problems);
  };
  const NormalParameters& normal = pair().normal;
  check(NormalParameters::schema(), &normal);
  if (normal.profile) check(ProfileParameters::schema(), &*normal.profile);
  if (normal.material) check(ViscoelasticMaterial::schema(), &*normal.material);
  if (pair().friction) check(FrictionParameters::schema(), &*pair().friction);
  check(ContactParameters::schema(), &pair());
  return problems.empty();
}

/// The error of the reader.
void OscillatorFamily::refuse(std::span<const double> values) const {
  Settings settings;
  for (std::size_t i = 0; i < keys_.size(); ++i) settings.emplace_back(keys_[i].path, values[i]);
  (void)with_settings(loaded_, settings);
  throw std::logic_error("OscillatorFamily: refuses what the reader takes");
}

void OscillatorFamily::renew_laws() {
  const auto drive_at = [&](int drive) {
    return drive < 0 ? nullptr : drives_[static_cast<std::size_t>(drive)];
  };
  const auto speed_of = [&](int drive) {
    const DriveParameters* const given = drive_at(drive);
    return given == nullptr ? 0.0 : given->velocity.value(0.0);
  };
  const DriveParameters* const loading = drive_at(load_drive_);
  const double load = loading == nullptr ? 0.0 : loading->load.value(0.0);
  SlidingMass& mass = oscillator_->mass;
  if (are_laws_stale_ || load != mass.load)
    mass.contact = make_substrate_contact(pair(), std::abs(load));
  are_laws_stale_ = false;
  mass.load = load;
  mass.base_speed = speed_of(base_drive_);
  mass.speed = speed_of(master_drive_) - mass.base_speed;
  oscillator_ = scaled(std::move(mass));
}

const SlidingOscillator* OscillatorFamily::at(std::span<const double> values) {
  if (!assign(values)) refuse(values);
  if (!makes_body_) {
    renew_laws();
    return oscillator_->mass.speed == 0.0 ? nullptr : &*oscillator_;
  }
  are_laws_stale_ = false;
  oscillator_ = as_oscillator(build_model(loaded_, cache_).system);
  return oscillator_ ? &*oscillator_ : nullptr;
}

}  // namespace stridor
