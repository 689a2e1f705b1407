// Of a run: what was heard and what was predicted, histories, spectrogram, shapes, checks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "app/report/histories.hpp"
#include "app/report/mode_frames.hpp"
#include "app/report/slide_view.hpp"
#include "app/results/burst_text.hpp"
#include "app/results/expectations.hpp"
#include "app/results/pictures.hpp"
#include "app/results/transient_results.hpp"
#include "app/stability/prediction.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/scene/scene_family.hpp"

namespace stridor {
namespace {

Json spectrogram_json(const RecordedStretch& run, const std::string& series, ReportPage& page) {
  const PictureOptions options;
  const RecordedSettings scene = recorded_settings(run.file, run.path);
  const PieceSettings pieces = settle_pieces(
      options, run, scene, scene.spectrogram,
      [&](double highest) { return std::sqrt(run.duration() / highest); }, 0.75);
  const Spectrogram spectrogram = make_spectrogram(run.finite_values(series), run.interval,
                                                   pieces.parameters, run.first_time());
  const std::string units = run.file.units(series);
  Json view = levels_view(spectrogram.times, spectrogram.frequencies, spectrogram.amplitude,
                          pieces.max_frequency, units, page);
  view["channel"] = channel_name(series);
  view["caption"] = fmt::format("Peak amplitudes: {}.", pieces_text(pieces.parameters, run.interval));
  return view;
}

/// Views of the vibration that bursts are sought in; nothing where it has too few samples or some
/// that are not finite.
void add_spectrogram(const RecordedStretch& run, const ReportContext& context, Json& section) {
  const auto acceleration = acceleration_channel(run.file);
  std::string series = acceleration.value_or("");
  if (!context.options.channels.empty())
    series = find_series(run, context.options.channels.front(), "--channel");
  if (series.empty()) {
    const auto spectral = chosen_series(run.file, SeriesUse::spectrum, 1);
    if (spectral.empty()) return;
    series = spectral.front();
  }
  series = spectral_series(run.file, series);
  try {
    const Activity transforming("transforming the pieces of the spectrogram");
    section["views"].push_back(spectrogram_json(run, series, context.page));
  } catch (const ConfigError& error) {
    section["remarks"].push_back(std::string("No spectrogram: ") + error.what());
  } catch (const FileError& error) {
    section["remarks"].push_back(std::string("No spectrogram: ") + error.what());
  }
}

/// Times and frequencies of a burst, as text of few digits.
Json course_json(const Burst& burst) {
  Json times = Json::array();
  Json frequencies = Json::array();
  for (const BurstPoint& point : burst.course) {
    times.push_back(std::round(1e5 * point.time) / 1e5);
    frequencies.push_back(std::round(point.frequency));
  }
  return {{"times", times}, {"frequencies", frequencies}};
}

Json bursts_json_of(const std::vector<NumberedBurst>& bursts) {
  Json rows = Json::array();
  for (const auto& [count, burst] : bursts) {
    rows.push_back({{"number", count},
                    {"start", burst.start},
                    {"end", burst.end},
                    {"frequency", burst.frequency},
                    {"peak", number(burst.peak)},
                    {"gain", number(burst.gain)},
                    {"start_frequency", number(burst.start_frequency)},
                    {"end_frequency", number(burst.end_frequency)},
                    {"harmonic", harmonic_json(burst)},
                    {"course", course_json(burst)}});
  }
  return rows;
}

SceneInFile scene_of(const RunFileHeader& header) {
  return {header.scene_hash, header.scene_resolved};
}

/// The windows that a locus of the same scene predicts, beside the bursts.
Json predictions_of(const RecordedStretch& run, const ReportContext& context,
                    const std::vector<NumberedBurst>& bursts, Json& section) {
  Json rows = Json::array();
  for (const WindowsOfScene& one : context.windows) {
    if (!has_same_mechanics(one.scene, scene_of(run.file.header()))) {
      section["remarks"].push_back(fmt::format(
          "{} is of another scene ({} instead of {}): its windows are not set beside the bursts.",
          std::filesystem::path(one.file).filename().string(), one.scene.hash,
          run.file.header().scene_hash));
      continue;
    }
    for (Json& row : prediction_json(match_bursts(one.windows, bursts)))
      rows.push_back(std::move(row));
  }
  return rows;
}

/// Bursts, windows and growth, from which the verdict on a run is made.
struct Heard {
  std::vector<NumberedBurst> bursts;
  Json predictions;
  bool is_searched = false;  ///< for bursts
  bool is_done = false;      ///< the run has come to its end
  bool grows = false;        ///< some mode about the sliding equilibrium
  std::string growth;        ///< what is said of the modes
};

/// The fastest growth of the modes in the frames of a section.
void judge_modes(const Json& section, Heard& heard) {
  double fastest = -std::numeric_limits<double>::infinity();
  double frequency = 0.0;
  double looked_at = std::numeric_limits<double>::infinity();  // at every place, Hz
  std::size_t places = 0, growing = 0;
  for (const Json& view : section["views"]) {
    if (view["type"] != "modes") continue;
    places += view["frames"].size();
    for (const Json& frame : view["frames"]) {
      bool grows = false;
      if (!frame["modes"].empty())
        looked_at = std::min(looked_at, frame["modes"].back()["frequency"].get<double>());
      for (const Json& mode : frame["modes"]) {
        const auto growth = mode["growth"].get<double>();
        grows |= growth > 0.0;
        if (growth <= fastest) continue;
        fastest = growth;
        frequency = mode["frequency"].get<double>();
      }
      growing += grows ? 1 : 0;
    }
  }
  if (!std::isfinite(fastest)) return;
  heard.grows = fastest > 0.0;
  if (places > 1) {
    // Some places alone along a path, between which there are windows.
    heard.growth = fmt::format(
        " Small vibrations about the sliding equilibrium, up to {}, grow at {} of the {} places "
        "whose modes are shown; `stridor locus --below` finds all unstable windows, also higher "
        "ones.",
        shown(looked_at, "Hz"), growing == 0 ? "none" : std::to_string(growing), places);
    return;
  }
  // How far a run came that was killed is not known; its modes are those of its start.
  const std::string where = heard.is_done ? "" : " where the run began";
  heard.growth = heard.grows
                     ? fmt::format(
                           " Small vibrations about the sliding equilibrium{} grow, fastest at {} "
                           "with {:.3g} 1/s.",
                           where, shown(frequency, "Hz"), fastest)
                     : fmt::format(" No mode up to {} grows about the sliding equilibrium{}.",
                                   shown(looked_at, "Hz"), where);
}

/// The windows that `run --predict` set beside the bursts of a run.
Json recorded_predictions(const ResultFile& file, const std::vector<NumberedBurst>& bursts) {
  Json rows = Json::array();
  if (!file.has("/windows/from")) return rows;
  std::map<std::string, std::vector<double>> columns;
  for (const char* name : {"from", "to", "frequency", "growth_max", "gain", "burst"}) {
    const std::string path = std::string("/windows/") + name;
    columns[name] = file.read(path);
    if (columns[name].size() != columns["from"].size())
      throw FileError(Refusal::file_damaged, file.path(), path,
                      "is unlike /windows/from in length");
  }
  for (std::size_t i = 0; i < columns["from"].size(); ++i) {
    Json row = {{"from", number(columns["from"][i])},
                {"to", number(columns["to"][i])},
                {"frequency", number(columns["frequency"][i])},
                {"growth_max", number(columns["growth_max"][i])},
                {"gain", number(columns["gain"][i])},
                {"burst", nullptr}};
    const double index = columns["burst"][i];
    if (index >= 0.0 && index < static_cast<double>(bursts.size())) {
      const NumberedBurst& burst = bursts[static_cast<std::size_t>(index)];
      row["burst"] = burst.number;
      row["burst_start"] = burst.burst.start;
      row["burst_frequency"] = burst.burst.frequency;
      row["burst_gain"] = number(burst.burst.gain);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Those of the windows to which a run has come.
Json come_to(const Json& windows, double last_time) {
  Json rows = Json::array();
  for (const Json& window : windows)
    if (!(window["from"].is_number() && window["from"].get<double>() > last_time))
      rows.push_back(window);
  return rows;
}

Json run_verdict(const Json& results, const RecordedStretch& run, const Heard& heard) {
  const std::string status = results.value("status", std::string());
  const std::vector<NumberedBurst>& bursts = heard.bursts;
  const Json& predictions = heard.predictions;
  std::string text;
  const bool has_tone = results.contains("lasting_tone.frequency");
  std::string level = !bursts.empty() || has_tone ? "loud"
                      : heard.grows               ? "unstable"
                      : heard.is_searched         ? "calm"
                                                  : "told";
  if (status == "done") {
    text = fmt::format("Ran to its end at {}. ", shown(run.last_time(), "s"));
  } else if (status.empty()) {
    text = fmt::format("Has not ended, or was killed; rows up to {}. ", shown(run.last_time(), "s"));
    level = "failed";
  } else {
    text = fmt::format("Ended as '{}' at {}. ", status, shown(run.last_time(), "s"));
    level = "failed";
  }
  if (bursts.empty()) {
    text += heard.is_searched ? "No bursts of vibration were found."
                              : "Bursts were not sought: that needs an acceleration and measure.band.";
  } else {
    const auto loudest =
        std::max_element(bursts.begin(), bursts.end(), [](const auto& a, const auto& b) {
          return a.burst.peak < b.burst.peak;
        });
    text += fmt::format("{} {} of vibration; the loudest reaches {} at {}, from {} to {}.",
                        bursts.size(), bursts.size() == 1 ? "burst" : "bursts",
                        shown(loudest->burst.peak, "m/s^2"), shown(loudest->burst.frequency, "Hz"),
                        shown(loudest->burst.start, "s"), shown(loudest->burst.end, "s"));
  }
  Json tone;
  if (has_tone) {
    tone["frequency"] = results["lasting_tone.frequency"];
    text += fmt::format(" A tone of {} lasts throughout, {} r.m.s.",
                        shown(tone["frequency"].get<double>(), "Hz"),
                        shown(results["lasting_tone.rms"].get<double>(), "m/s^2"));
  }
  const std::string doubtful = doubtful_text(bursts_json_of(bursts), tone,
                                             results.value("trusted_frequency", Json(nullptr)));
  if (!doubtful.empty()) text += fmt::format(" Doubtful: {}.", doubtful);
  if (!predictions.empty()) {
    const auto num_heard = std::count_if(predictions.begin(), predictions.end(), [](const Json& row) {
      return !row["burst"].is_null();
    });
    text += fmt::format(" Of {} unstable windows that the run passes, {} {} heard.",
                        predictions.size(), num_heard, num_heard == 1 ? "was" : "were");
  }
  return verdict(level, text + heard.growth);
}

/// The first sentence of the comment at the head of a scene; empty without.
std::string purpose_of(const std::string& scene_text) {
  std::string comment;
  std::istringstream lines(scene_text);
  for (std::string line; std::getline(lines, line) && line.starts_with('#');) {
    line.erase(0, line.find_first_not_of("# "));
    if (line.starts_with("yaml-language-server")) continue;
    if (line.empty() || line.starts_with("stridor ")) break;
    comment += (comment.empty() ? "" : " ") + line;
  }
  const std::size_t end = comment.find(". ");
  return end == std::string::npos ? comment : comment.substr(0, end + 1);
}

/// The way that the drive went in a run, along which modes are about the deformed geometry, as the
/// bodies of a run slide; the scene as it stands where the drive did not move.
FramedRange way_of(const RunFileReader& file) {
  FramedRange way{"", {}, "deformed"};
  constexpr const char* place = "/final/drive_displacement";
  if (!file.has(place)) return way;
  const std::vector<double> displacement = file.static_array(place);
  if (displacement.empty() || displacement.front() == 0.0 || !std::isfinite(displacement.front()))
    return way;
  const double end = displacement.front();
  way.parameter = drive_displacement_name;
  way.values = {std::min(0.0, end), std::max(0.0, end)};
  return way;
}

/// The numbers that the scene expects of its run, beside those that it has.
void add_expectations(const std::string& resolved, const Json& results,
                      const std::vector<NumberedBurst>& bursts, Json& section) {
  std::vector<Expectation> expectations;
  try {
    expectations = load_resolved_scene(resolved, "/scene/resolved").scene.expect;
  } catch (const std::exception&) {
    return;  // of another version of the program; the numbers themselves are shown
  }
  if (expectations.empty()) return;
  Json nested = Json::object();
  for (const auto& [name, value] : results.items()) {
    std::string pointer = "/" + name;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    try {
      nested[Json::json_pointer(pointer)] = value;
    } catch (const Json::exception&) {
      nested[name] = value;  // a result and one of its parts
    }
  }
  nested["bursts"] = bursts_json_of(bursts);
  Json rows = Json::array();
  for (const auto& [expectation, value, is_met] : judged(expectations, nested)) {
    rows.push_back({{"result", expectation.result},
                    {"expected", expectation.value},
                    {"tolerance", expectation.tolerance},
                    {"value", number_or_null(value)},
                    {"is_met", is_met}});
  }
  section["expectations"] = rows;
}

/// Where one cause leaves away the slide and the shapes, it is told once.
void tell_once(Json& remarks) {
  const auto cause = [](const Json& remark) {
    const std::string text = remark.get<std::string>();
    const std::size_t colon = text.find(": ");
    return text.starts_with("No ") && colon != std::string::npos ? text.substr(colon) : text;
  };
  for (std::size_t i = 0; i + 1 < remarks.size();) {
    if (cause(remarks[i]) == cause(remarks.back()))
      remarks.erase(i);
    else
      ++i;
  }
}

Json results_json(const RunFileReader& file) {
  Json results = Json::object();
  for (const auto& [name, value] : file.results()) {
    if (const double* real = std::get_if<double>(&value)) results[name] = number(*real);
    else results[name] = std::get<std::string>(value);
  }
  return results;
}

}  // namespace

Json run_section(const ResultFile& source, const ReportContext& context) {
  PictureOptions options;
  options.file = source.path();
  const RecordedStretch run = open_stretch(options);
  const RunFileHeader& header = run.file.header();
  Json section = section_head(source, "run", "run to " + shown(run.last_time(), "s"));
  section["purpose"] = purpose_of(header.scene_text);
  section["scene_resolved"] = header.scene_resolved;
  section["scene_text"] = header.scene_text;
  section["samples"] = run.samples.size();
  section["remarks"] = Json::array();
  Heard heard;
  heard.bursts = bursts_in(run, options);
  heard.is_searched = acceleration_channel(run.file).has_value() &&
                      recorded_settings(run.file, run.path).measure.band.size() == 2;
  const Json results = results_json(run.file);
  heard.is_done = results.value("status", std::string()) == "done";
  const Json resolved = results.value("trusted_frequency", Json(nullptr));
  heard.predictions = predictions_of(run, context, heard.bursts, section);
  if (heard.predictions.empty()) heard.predictions = recorded_predictions(source, heard.bursts);
  heard.predictions = come_to(heard.predictions, run.last_time());
  section["verdict"] = nullptr;  // stands above what it needs
  section["views"].push_back({{"type", "bursts"},
                              {"bursts", bursts_json_of(heard.bursts)},
                              {"resolved", resolved.is_number() ? resolved : Json(nullptr)},
                              {"predicted", heard.predictions}});
  add_spectrogram(run, context, section);
  if (!context.options.without_shapes)
    add_slide(header.scene_resolved, source.path() + ":/scene/resolved", run,
              0.1 * context.bytes_per_file, context.page, section);
  section["views"].push_back(histories_view(run, context, 0.7 * context.bytes_per_file));
  const bool has_locus =
      std::any_of(context.windows.begin(), context.windows.end(), [&](const WindowsOfScene& one) {
        return has_same_mechanics(one.scene, scene_of(header));  // which shows them
      });
  if (!context.options.without_shapes && !has_locus) {
    add_mode_frames({header.scene_resolved, source.path() + ":/scene/resolved", "", ""},
                    way_of(run.file), {0.25 * context.bytes_per_file, 41}, context.page, section);
    tell_once(section["remarks"]);
    judge_modes(section, heard);
  }
  section["verdict"] = run_verdict(results, run, heard);
  section["results"] = results;
  if (heard.is_done) add_expectations(header.scene_resolved, results, heard.bursts, section);
  return section;
}

}  // namespace stridor
