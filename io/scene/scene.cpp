#include "io/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "core/memory.hpp"
#include "core/suggestion.hpp"
#include "io/imports/law_table_file.hpp"
#include "io/scene/assignment.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/former_keys.hpp"
#include "io/scene/body_reader.hpp"
#include "io/scene/resolved_scene.hpp"
#include "io/scene/scene_files.hpp"
#include "io/scene/scene_problems.hpp"
#include "io/scene/scene_reader.hpp"
#include "models/set_up_estimate.hpp"

namespace stridor {
namespace {

/// Checks the section `spectrogram` against what the scene records.
void check_spectrogram(const Scene& scene, std::vector<Problem>& problems) {
  if (!scene.spectrogram) return;
  const SpectrogramSection& section = *scene.spectrogram;
  const auto report = [&](const char* key, std::string message) {
    problems.push_back(
        {Refusal::wrong_value, std::string("spectrogram.") + key, std::move(message)});
  };
  const std::vector<std::string> channels =
      scene.record ? scene.record->channels : std::vector<std::string>{};
  if (section.channel) {
    // A pair with several slave points records "pair[0].force" for the channel "pair.force".
    std::string channel = *section.channel;
    const std::size_t open = channel.find('[');
    const std::size_t close = channel.find(']', open);
    if (close != std::string::npos) channel.erase(open, close + 1 - open);
    if (std::find(channels.begin(), channels.end(), channel) == channels.end()) {
      report("channel", fmt::format("'{}' is not among record.channels{}", *section.channel,
                                    did_you_mean(*section.channel, channels)));
    }
  }
  if (!scene.record) return;
  const double interval = scene.record->interval;
  if (section.length && scene.time &&
      (*section.length < 2.0 * interval || *section.length > scene.time->end)) {
    report("length", fmt::format("{:g} s must be at least two times record.interval = {:g} s and "
                                 "at most time.end = {:g} s",
                                 *section.length, interval, scene.time->end));
  }
  if (section.max_frequency && *section.max_frequency > 0.5 / interval) {
    report("max_frequency",
           fmt::format("{:g} Hz is above {:g} Hz, the highest frequency that record.interval "
                       "resolves",
                       *section.max_frequency, 0.5 / interval));
  }
}

const std::vector<std::string> term_names{"gyroscopic", "friction", "friction_damping", "geometric",
                                          "structural_damping"};

void check_terms(const Scene& scene, std::vector<Problem>& problems) {
  if (!scene.terms) return;
  for (std::size_t i = 0; i < scene.terms->size(); ++i) {
    const std::string& name = (*scene.terms)[i];
    if (std::find(term_names.begin(), term_names.end(), name) != term_names.end()) continue;
    problems.push_back({Refusal::unknown_name, fmt::format("terms.{}", i),
                        fmt::format("there is no term '{}'{} (there are: {})", name,
                                    did_you_mean(name, term_names), fmt::join(term_names, ", "))});
  }
}

/// Checks the rates of recording and of the band against each other.
void check_rates(const Scene& scene, std::vector<Problem>& problems) {
  if (!scene.record) return;
  const double interval = scene.record->interval;
  const auto report = [&](Refusal refusal, const char* key, std::string message) {
    problems.push_back({refusal, key, std::move(message)});
  };
  const double step = scene.time ? scene.time->step : interval;
  const double ratio = interval / step;
  const bool is_multiple = ratio >= 1.0 - 1e-9 && std::abs(ratio - std::round(ratio)) <= 1e-6 &&
                           std::round(ratio) <= 1e5;
  const bool is_event_driven = scene.time && scene.time->is_event_driven();
  if (!is_event_driven && !is_multiple) {
    report(Refusal::interval, "record.interval",
           fmt::format("{:g} s must be a whole multiple (1 to 100000) of "
                       "time.step = {:g} s, is {:g} of it; the "
                       "nearest is {:g} s",
                       interval, step, ratio, std::clamp(std::round(ratio), 1.0, 1e5) * step));
  }
  if (is_event_driven && scene.record->energy)
    report(Refusal::contradiction, "record.energy",
           "the energy ledger does not know what a half_space stores");
  const double nyquist = 0.5 / interval;
  if (!scene.measure.band.empty() && scene.measure.band.back() >= nyquist) {
    report(Refusal::wrong_value, "measure.band",
           fmt::format("reaches {:g} Hz, but record.interval resolves only frequencies below {:g} "
                       "Hz",
                       scene.measure.band.back(), nyquist));
  }
}

}  // namespace

bool keeps_term(const Scene& scene, const std::string& name) {
  return !scene.terms ||
         std::find(scene.terms->begin(), scene.terms->end(), name) != scene.terms->end();
}

PlainKey parameters_key() {
  return {.doc =
              "Numbers with names, with or without a unit, or expressions of each other "
              "(`=sqrt(k/m)`), for the expressions of all other keys (`=2*mu`).",
          .optional = true};
}

const Schema& Scene::schema() {
  static const Schema keys =
      SchemaOf<Scene>("scene")
          .integer("format", &Scene::format,
                   {.doc = "Version of the scene language: 2.", .range = Range::between(2, 2)})
          .parameters("parameters", &Scene::parameters, parameters_key())
          .include(&Scene::model)
          .section("time", &Scene::time,
                   {.doc = "How the system is marched in time: for run, sweep, compare and "
                           "precision.",
                    .optional = true})
          .text_list("terms", &Scene::terms,
                     {.doc = "Terms of the linearised equations, of gyroscopic, friction, "
                             "friction_damping (all damping that contacts bring), geometric and "
                             "structural_damping (all that bodies bring). The two dampings may be "
                             "left out; where all contacts are on faces of plates, friction and "
                             "geometric too; with a plate, gyroscopic. Default: all.",
                      .optional = true})
          .section("cycle", &Scene::cycle,
                   {.doc = "How `cycle` and sweeps of cycles seek the periodic motion of one mass "
                           "that moves in x and y on a half_space.",
                    .optional = true})
          .section(
              "sliding", &Scene::sliding,
              {.doc = "Where `contact` evaluates the viscoelastic normal laws; its options win "
                      "over it.",
               .optional = true})
          .section("record", &Scene::record,
                   {.doc = "What is written to the run file.", .optional = true})
          .section("measure", &Scene::measure,
                   {.doc = "Window and band of the statistics.", .optional = true})
          .section("spectrogram", &Scene::spectrogram,
                   {.doc = "How the spectrogram of the run is made; options of the verb "
                           "`spectrogram` win over it.",
                    .optional = true})
          .section("checkpoint", &Scene::checkpoint,
                   {.doc = "When the state of a run is stored.", .optional = true})
          .section_list(
              "expect", &Scene::expect,
              {.doc = "Results that `run --verify` checks, or `contact --verify` where the scene "
                      "has a section `sliding`.",
               .optional = true})
          .check(check_spectrogram)
          .check(check_terms)
          .check(check_rates);
  return keys;
}

LinearisationTerms contact_terms(const KeptTerms& kept) {
  LinearisationTerms terms;
  terms.friction = kept.friction;
  terms.friction_damping = kept.friction_damping;
  terms.geometric = kept.geometric;
  return terms;
}

KeptTerms kept_terms(const Scene& scene) {
  return {keeps_term(scene, "gyroscopic"), keeps_term(scene, "friction"),
          keeps_term(scene, "friction_damping"), keeps_term(scene, "geometric"),
          keeps_term(scene, "structural_damping")};
}

Accounts accounts_of(const Scene& scene) {
  return scene.record && scene.record->energy ? Accounts::energy : Accounts::none;
}

std::string LoadedScene::resolved() const {
  return resolved_yaml(scene);
}

std::string scene_hash(const std::string& resolved) {
  return scene_hash(resolved, std::vector<SceneFile>());
}

std::string LoadedScene::hash() const {
  return scene_hash(resolved(), scene_files(*this));
}

bool is_face(const ModelParameters& model, const std::string& master) {
  const std::size_t dot = master.find('.');
  if (dot == std::string::npos) return false;
  const auto body = model.substructures.find(master.substr(0, dot));
  return body != model.substructures.end() && body->second->has_face(master.substr(dot + 1));
}

bool has_two_tangents(const ModelParameters& model, const ContactParameters& pair) {
  const auto is_spatial = [&](const std::string& name) {
    const auto body = model.substructures.find(name.substr(0, name.find('.')));
    return body != model.substructures.end() && body->second->is_spatial();
  };
  if (pair.plane || is_face(model, pair.master) || is_spatial(pair.master)) return true;
  return pair.master == rigid_master && !pair.slave.empty() && is_spatial(pair.slave.front());
}

bool has_face_contacts(const ModelParameters& model) {
  const auto pairs = model.pairs();
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const auto& pair) { return has_two_tangents(model, pair.second); });
}

}  // namespace stridor
