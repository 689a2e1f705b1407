// The rows of `precision` as JSON object, table and figure.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/runs/precision.hpp"
#include "io/figures/axes.hpp"
#include "io/figures/precision_plot.hpp"
#include "io/scene/resolved_scene.hpp"

namespace stridor {
namespace {

std::string method_name(const PrecisionRow& row, ContactAssumption own) {
  std::string name = row.coordinates == Coordinates::craig_bampton         ? "published form"
                     : row.coordinates == Coordinates::craig_bampton_fused ? "published form, fused"
                     : row.method.integrator == Integrator::exact          ? "exact"
                                                                           : "central difference";
  if (row.is_measured()) {
    name += row.method.retained ? fmt::format(", to {}", quantity_text(*row.method.retained, "Hz"))
                                : std::string(", all modes");
  }
  if (row.method.assumption != own)
    name += ", " + word_of(assumption_names(), row.method.assumption);
  return name;
}

Json errors_json(const RunErrors& errors) {
  return {{"force", number(errors.force)},
          {"acceleration", number(errors.acceleration)},
          {"envelope", number(errors.envelope)}};
}

Json row_json(const PrecisionRow& row, ContactAssumption own) {
  Json object{{"method", method_name(row, own)},
              {"integrator", word_of(integrator_words(), row.method.integrator)},
              {"coordinates", word_of(coordinates_words(), row.coordinates)},
              {"assumption", word_of(assumption_names(), row.method.assumption)},
              {"retain", row.method.retained ? Json(*row.method.retained) : Json("all")},
              {"modes", row.modes},
              {"step", row.time.step},
              {"steps", row.whole_steps},
              {"wall_s", number(row.seconds())},
              {"least_wall_s", number(row.least_seconds())},
              {"step_ns",
               {{"least", number(row.cost.least_step * 1e9)},
                {"median", number(row.cost.median_step * 1e9)}}},
              {"setup_s", number(row.cost.setup)},
              {"sampling_s", number(row.cost.sampling)},
              {"error", row.is_stable ? number(row.error) : Json(nullptr)},
              {"errors", row.is_stable ? errors_json(row.errors) : Json(nullptr)},
              {"stable", row.is_stable},
              {"on_front", row.is_on_front},
              {"status", row.run->failure().empty()
                             ? (row.is_stable ? "done" : "useless")
                             : "failed: " + with_code(row.run->failure(), row.run->refusal())}};
  if (!row.is_measured()) {
    object["timed_steps"] = row.cost.steps;
    object["error_of"] = "the modal form at the same step";
  }
  return object;
}

/// One method's rows as a curve.
struct Method {
  std::string name;
  std::vector<const PrecisionRow*> rows;

  std::vector<double> values(double (*of)(const PrecisionRow&)) const {
    std::vector<double> all;
    for (const PrecisionRow* row : rows)
      if (row->is_stable) all.push_back(of(*row));
    return all;
  }
  double slope_over_time() const { return log_log_slope(values(time_of), values(error_of)); }
  double slope_over_step() const { return log_log_slope(values(step_of), values(error_of)); }

  static double time_of(const PrecisionRow& row) { return row.least_seconds(); }
  static double step_of(const PrecisionRow& row) { return row.time.step; }
  static double error_of(const PrecisionRow& row) { return row.error; }
};

std::vector<Method> methods_of(const PrecisionResult& result) {
  std::vector<Method> methods;
  for (std::size_t i = 2; i < result.rows.size(); ++i) {
    const std::string name = method_name(result.rows[i], result.own_assumption);
    if (methods.empty() || methods.back().name != name) methods.push_back({name, {}});
    methods.back().rows.push_back(&result.rows[i]);
  }
  return methods;
}

/// The published form at its largest stable step against the cheapest setting that errs as little.
Json published_json(const PrecisionResult& result) {
  Json list = Json::array();
  for (const PrecisionRow& row : result.rows) {
    if (row.is_measured() || !row.is_stable) continue;
    const PrecisionRow* best = nullptr;
    for (std::size_t i = 1; i < result.rows.size(); ++i) {
      const PrecisionRow& other = result.rows[i];
      if (!other.is_measured() || !other.is_stable || !(other.error <= row.error) ||
          other.method.assumption != result.own_assumption) {
        continue;
      }
      if (best == nullptr || other.least_seconds() < best->least_seconds()) best = &other;
    }
    if (best == nullptr) continue;
    // The first row of each form is the one at the largest step.
    const bool is_known = std::any_of(list.begin(), list.end(), [&](const Json& entry) {
      return entry["coordinates"] == word_of(coordinates_words(), row.coordinates);
    });
    if (is_known) continue;
    list.push_back({{"coordinates", word_of(coordinates_words(), row.coordinates)},
                    {"step", row.time.step},
                    {"error", row.error},
                    {"least_wall_s", row.least_seconds()},
                    {"equal", method_name(*best, result.own_assumption)},
                    {"equal_step", best->time.step},
                    {"equal_error", best->error},
                    {"equal_least_wall_s", best->least_seconds()},
                    {"ratio", row.least_seconds() / best->least_seconds()}});
  }
  return list;
}

/// The section `time` of the scene with the setting of a row.
std::string scene_lines(const PrecisionStudy& study, const PrecisionRow& row) {
  TimeParameters time = row.time;
  time.end = study.loaded.scene.time->end;
  std::string text = "time:\n";
  std::string line;
  for (const char c : resolved_yaml(time)) {
    line += c;
    if (c != '\n') continue;
    text += "  " + line;
    line.clear();
  }
  return text;
}

Json tune_json(const PrecisionStudy& study, const PrecisionResult& result, double wanted) {
  if (!result.tuned) return nullptr;
  const PrecisionRow& row = result.rows[*result.tuned];
  return {{"wanted", wanted},
          {"method", method_name(row, result.own_assumption)},
          {"step", row.time.step},
          {"error", row.error},
          {"reference_error", result.own_error},
          {"share_of_wanted", row.error / wanted},
          {"least_wall_s", row.least_seconds()},
          {"scene", scene_lines(study, row)}};
}

}  // namespace

Json precision_json(const PrecisionStudy& study, const PrecisionOptions& options,
                    const PrecisionResult& result, std::optional<double> wanted) {
  const PrecisionRow& reference = result.reference();
  Json object{{"scene", options.scene},
              {"command", options.command_line},
              {"channel", study.channel},
              {"norm", options.norm},
              {"end", study.end()},
              {"window", {study.norms.window.from, study.norms.window.to}},
              {"band", {study.norms.band.lower, study.norms.band.upper}},
              {"smoothing", study.norms.smoothing},
              {"sampling", study.interval},
              {"reference",
               {{"integrator", word_of(integrator_words(), reference.method.integrator)},
                {"modes", reference.modes},
                {"step", reference.time.step},
                {"wall_s", reference.seconds()},
                {"error", result.own_error},
                {"errors", errors_json(result.own_errors)},
                {"error_from",
                 fmt::format("difference from the same at {:g} s", result.rows[1].time.step)}}},
              {"rows", Json::array()},
              {"methods", Json::array()},
              {"published", published_json(result)}};
  for (std::size_t i = 2; i < result.rows.size(); ++i)
    object["rows"].push_back(row_json(result.rows[i], result.own_assumption));
  for (const Method& method : methods_of(result)) {
    object["methods"].push_back({{"method", method.name},
                                 {"slope_over_time", number(method.slope_over_time())},
                                 {"slope_over_step", number(method.slope_over_step())}});
  }
  if (wanted) object["tune"] = tune_json(study, result, *wanted);
  return object;
}

void draw_precision(const PrecisionStudy& study, const PrecisionOptions& options,
                    const PrecisionResult& result, std::optional<double> wanted,
                    const std::filesystem::path& figure) {
  PrecisionPicture picture;
  picture.error_label = "relative error of the " + options.norm;
  picture.reference_error = result.own_error;
  picture.wanted = wanted;
  picture.caption = fmt::format(
      "{}, {} to {}, {} to {}; against the exact propagation of all {} modes at {}. Slopes of "
      "least "
      "squares through all points of a line. Time of the fastest stretch of each run.",
      study.channel, quantity_text(study.norms.band.lower, "Hz"),
      quantity_text(study.norms.band.upper, "Hz"), quantity_text(study.norms.window.from, "s"),
      quantity_text(study.norms.window.to, "s"), result.reference().modes,
      quantity_text(result.reference().time.step, "s"));
  for (const Method& method : methods_of(result)) {
    PrecisionCurve curve{method.name, {}, {}};
    const double slope = method.slope_over_time();
    if (std::isfinite(slope)) curve.slope = slope;
    for (const PrecisionRow* row : method.rows) {
      if (row->is_stable)
        curve.points.push_back({row->least_seconds(), row->error, row->is_on_front});
    }
    picture.curves.push_back(curve);
  }
  plot_precision(picture, figure);
}

void print_precision(const PrecisionStudy& study, const PrecisionOptions& options,
                     const PrecisionResult& result, std::optional<double> wanted) {
  const PrecisionRow& reference = result.reference();
  fmt::print(
      "errors of {} and of the contact force, {:g} to {:g} s, {:g} to {:g} Hz, sampled every "
      "{:g} s\n",
      study.channel, study.norms.window.from, study.norms.window.to, study.norms.band.lower,
      study.norms.band.upper, study.interval);
  fmt::print(
      "reference: exact, all {} modes, step {:.4g} s; its own errors, against twice the step: "
      "force {:.2g}, acceleration {:.2g}, envelope {:.2g}\n\n",
      reference.modes, reference.time.step, result.own_errors.force, result.own_errors.acceleration,
      result.own_errors.envelope);
  fmt::print("{:<34} {:>9} {:>6} {:>9} {:>7} {:>8} {:>9} {:>9} {:>9}\n", "method", "step s",
             "modes", "wall s", "spread", "ns/step", "force", "accel.", "envelope");
  std::string failures;
  for (std::size_t i = 2; i < result.rows.size(); ++i) {
    const PrecisionRow& row = result.rows[i];
    const std::string name = method_name(row, result.own_assumption);
    if (!row.is_stable) {
      fmt::print("{:<34} {:>9.3g} {:>6} {:>9} {:>7} {:>8} {:>9} {:>9} {:>9}\n", name, row.time.step,
                 row.modes, "-", "-", "-", "-", "-", "not stable");
      continue;
    }
    const double spread = row.cost.median_step / row.cost.least_step - 1.0;
    fmt::print("{:<34} {:>9.3g} {:>6} {:>9.4g} {:>5.0f} % {:>8.0f} {:>9.2g} {:>9.2g} {:>9.2g}{}\n",
               name, row.time.step, row.modes, row.least_seconds(), 100.0 * spread,
               row.cost.least_step * 1e9, row.errors.force, row.errors.acceleration,
               row.errors.envelope, row.is_on_front ? " *" : "");
  }
  fmt::print(
      "\n* no other setting has both less time and a smaller error of the {}\n"
      "wall s: stepping at the pace of the fastest stretch; spread: of the median stretch "
      "above it\n\n",
      options.norm);
  for (const Method& method : methods_of(result)) {
    const auto text = [](double slope) {
      return std::isfinite(slope) ? fmt::format("{:.2f}", slope) : std::string("-");
    };
    fmt::print("slope of {:<34} over time {:>6}, over the step {:>6}\n", method.name,
               text(method.slope_over_time()), text(method.slope_over_step()));
  }
  for (const Json& entry : published_json(result)) {
    fmt::print(
        "\n{} at {:.4g} s: {:.4g} s for an error of {:.2g}; {} at {:.4g} s errs by {:.2g} and "
        "takes {:.0f} times less\n",
        entry["coordinates"].get<std::string>(), entry["step"].get<double>(),
        entry["least_wall_s"].get<double>(), entry["error"].get<double>(),
        entry["equal"].get<std::string>(), entry["equal_step"].get<double>(),
        entry["equal_error"].get<double>(), entry["ratio"].get<double>());
  }
  if (wanted && result.tuned) {
    const PrecisionRow& row = result.rows[*result.tuned];
    fmt::print(
        "\ncheapest within {:g}: {} at {:.4g} s, {:.3g} s; error {:.2g}, {:.3g} % below what "
        "was asked\n\n{}",
        *wanted, method_name(row, result.own_assumption), row.time.step, row.least_seconds(),
        row.error, 100.0 * (1.0 - row.error / *wanted), scene_lines(study, row));
  }
}

}  // namespace stridor
