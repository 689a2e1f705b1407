// stridor locus: eigenvalues of a scene along one of its keys.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <numbers>

#include "app/stability/axis_units.hpp"
#include "app/stability/eigenvalue_report.hpp"
#include "app/stability/family_locus.hpp"
#include "app/stability/locus_progress.hpp"
#include "app/stability/stability.hpp"
#include "app/stability/verdict.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/version.hpp"
#include "io/figures/gnuplot.hpp"
#include "io/figures/locus_plot.hpp"
#include "io/results/locus_file.hpp"

namespace stridor {
namespace {

struct LocusCommandOptions {
  StabilityOptions stability;
  RangeOptions range;
  std::optional<std::string> output;
  std::optional<std::string> figure;
  std::optional<std::string> history;
  std::string command_line;
};

constexpr double never = std::numeric_limits<double>::quiet_NaN();

/// Time at which a run of the scene first comes to a sliding state; NaN where it never does.
class PassingTimes {
 public:
  PassingTimes(const Scene& scene, BodyStabilityFamily& family)
      : end_(scene.time->end), family_(&family) {}

  /// @param place position of the contact, or displacement of the drive
  double at(double place) const {
    const SlidingState state = family_->at(std::array{place});
    if (!state.is_on_the_way) return never;
    const double wanted = state.equilibrium.state.drive_displacement;
    const auto missing = [&](double time) {
      return state.leading_drive.displacement(time) - wanted;
    };
    if (missing(0.0) == 0.0) return 0.0;
    constexpr int num_steps = 1000;
    double before = 0.0;
    for (int i = 1; i <= num_steps; ++i) {
      const double after = end_ * i / num_steps;
      if (missing(before) * missing(after) <= 0.0) return bisected(missing, before, after);
      before = after;
    }
    return never;
  }

 private:
  template <class Function>
  static double bisected(const Function& function, double low, double high) {
    const bool rises = function(low) < 0.0;
    while (true) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) return middle;
      ((function(middle) < 0.0) == rises ? low : high) = middle;
    }
  }

  double end_;
  BodyStabilityFamily* family_;
};

/// ∫ Re s dt over the part of a window that the run passes, by the samples of its branch.
double gain_between(const Branch& branch, double from, double to, const PassingTimes& times) {
  const auto growth_at = [&](double value) {
    const auto upper = std::upper_bound(branch.values.begin(), branch.values.end(), value);
    const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
        upper - branch.values.begin(), 1, std::ssize(branch.values) - 1));
    const double share = (value - branch.values[i - 1]) / (branch.values[i] - branch.values[i - 1]);
    return std::lerp(branch.s[i - 1].real(), branch.s[i].real(), share);
  };
  constexpr int num_parts = 64;
  double gain = 0.0;
  double before = times.at(from);
  for (int i = 0; i < num_parts; ++i) {
    const double after = times.at(std::lerp(from, to, (i + 1.0) / num_parts));
    gain += growth_at(std::lerp(from, to, (i + 0.5) / num_parts)) * std::abs(after - before);
    before = after;
  }
  return gain;
}

/// Times of a window in the run of the scene, and the growth in it: it may start or end inside.
TimedWindow timed(const Locus& locus, const UnstableWindow& window, const PassingTimes& times) {
  TimedWindow one{window, never, never, never};
  const auto is_passed = [&](double value) { return std::isfinite(times.at(value)); };
  double from = window.from;
  double to = window.to;
  if (!is_passed(from) || !is_passed(to)) {
    constexpr int num_places = 32;
    std::optional<double> inside;
    for (int i = 0; i <= num_places && !inside; ++i) {
      const double value = std::lerp(from, to, static_cast<double>(i) / num_places);
      if (is_passed(value)) inside = value;
    }
    if (!inside) return one;
    // The last value on the way from `inside` to an end that is passed.
    const auto last_passed = [&](double end) {
      if (is_passed(end)) return end;
      double passed = *inside;
      constexpr int num_halvings = 40;
      for (int i = 0; i < num_halvings; ++i) {
        const double middle = 0.5 * (passed + end);
        (is_passed(middle) ? passed : end) = middle;
      }
      return passed;
    };
    from = last_passed(from);
    to = last_passed(to);
  }
  if (!(from < to)) return one;
  const double at_from = times.at(from);
  const double at_to = times.at(to);
  one.from_time = std::min(at_from, at_to);
  one.to_time = std::max(at_from, at_to);
  const bool is_whole = from == window.from && to == window.to;
  // A whole window is passed at nearly constant speed.
  one.gain = is_whole ? window.growth_integral * (one.to_time - one.from_time) / (to - from)
                      : gain_between(locus.branches[static_cast<std::size_t>(window.branch)], from,
                                     to, times);
  return one;
}

std::vector<TimedWindow> timed_windows(const Locus& locus,
                                       const std::optional<PassingTimes>& times) {
  const Activity timing("times at which the run passes the windows");
  std::vector<TimedWindow> all;
  for (const UnstableWindow& window : locus.unstable)
    all.push_back(times ? timed(locus, window, *times) : TimedWindow{window, never, never, never});
  return all;
}

Json complex_list(const std::vector<std::complex<double>>& eigenvalues) {
  Json list = Json::array();
  for (const std::complex<double>& s : eigenvalues) list.push_back({s.real(), s.imag()});
  return list;
}

/// The eigenvalue of a window where it grows most, 1/s.
std::complex<double> fastest_of(const UnstableWindow& window) {
  return {window.growth_max, 2.0 * std::numbers::pi * window.frequency};
}

/// @param trusted up to where the model answers, in the unit of the frequencies
Json windows_json(const std::vector<TimedWindow>& windows, double trusted) {
  Json list = Json::array();
  for (const TimedWindow& one : windows) {
    list.push_back({{"from", one.window.from},
                    {"to", one.window.to},
                    {"frequency", one.window.frequency},
                    {"growth_max", one.window.growth_max},
                    {"growth_integral", number(one.window.growth_integral)},
                    {"value_max", one.window.value_max},
                    {"from_time", number(one.from_time)},
                    {"to_time", number(one.to_time)},
                    {"gain", number(one.gain)},
                    {"oscillates", one.window.frequency > 0.0},
                    {"resolved", is_resolved(fastest_of(one.window), trusted)}});
  }
  return list;
}

/// Eigenvalues that were sampled, as curves: each continues where its last two points lead.
std::vector<std::vector<std::pair<double, std::complex<double>>>> connected(const Locus& locus) {
  std::vector<std::vector<std::pair<double, std::complex<double>>>> curves;
  std::vector<std::size_t> open;  // curves that have reached the last value
  for (std::size_t i = 0; i < locus.values.size(); ++i) {
    const double value = locus.values[i];
    std::vector<std::complex<double>> left = locus.eigenvalues[i];
    std::vector<std::size_t> continued;
    while (!open.empty() && !left.empty()) {
      // The closest of all that are left, first.
      double least = std::numeric_limits<double>::infinity();
      std::size_t from = 0, to = 0;
      for (std::size_t k = 0; k < open.size(); ++k) {
        const auto& curve = curves[open[k]];
        std::complex<double> expected = curve.back().second;
        if (curve.size() > 1) {
          const auto& [last, s] = curve[curve.size() - 2];
          expected += (expected - s) * ((value - curve.back().first) / (curve.back().first - last));
        }
        for (std::size_t j = 0; j < left.size(); ++j) {
          if (std::abs(left[j] - expected) >= least) continue;
          least = std::abs(left[j] - expected);
          from = k;
          to = j;
        }
      }
      curves[open[from]].emplace_back(value, left[to]);
      continued.push_back(open[from]);
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(from));
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(to));
    }
    for (const std::complex<double>& s : left) {
      continued.push_back(curves.size());
      curves.push_back({{value, s}});
    }
    open = std::move(continued);
  }
  return curves;
}

/// The branches as curves; samples connected where there are no branches.
std::vector<LocusCurve> curves_of(const Locus& locus, double highest) {
  std::vector<LocusCurve> curves;
  const auto add = [&](LocusCurve& curve, double value, std::complex<double> s) {
    const double frequency = s.imag() / (2.0 * std::numbers::pi);
    const bool is_shown = frequency <= highest;
    curve.parameter.push_back(value);
    curve.growth.push_back(is_shown ? s.real() : never);
    curve.frequency.push_back(is_shown ? frequency : never);
  };
  for (std::size_t k = 0; k < locus.branches.size(); ++k) {
    // The samples, and the places between them where the branch crosses the axis or grows most.
    std::map<double, std::complex<double>> points;
    const auto add_point = [&](double value, double growth, double frequency) {
      points[value] = {growth, 2.0 * std::numbers::pi * frequency};
    };
    const Branch& branch = locus.branches[k];
    for (std::size_t i = 0; i < branch.values.size(); ++i) points[branch.values[i]] = branch.s[i];
    for (const UnstableWindow& window : locus.unstable) {
      if (static_cast<std::size_t>(window.branch) == k)
        add_point(window.value_max, window.growth_max, window.frequency);
    }
    for (const Crossing& crossing : locus.crossings)
      if (static_cast<std::size_t>(crossing.branch) == k)
        add_point(crossing.value, 0.0, crossing.frequency);
    curves.emplace_back();
    for (const auto& [value, s] : points) add(curves.back(), value, s);
  }
  if (!locus.branches.empty()) return curves;
  for (const auto& points : connected(locus)) {
    curves.emplace_back();
    for (const auto& [value, s] : points) {
      // Rounding on the imaginary axis is no growth; pictures show zero as the edge of growth.
      const bool is_on_axis = std::abs(s.real()) <= 1e-7 * std::abs(s);
      add(curves.back(), value,
          is_on_axis ? std::complex<double>(-std::numeric_limits<double>::min(), s.imag()) : s);
    }
  }
  return curves;
}

/// The highest frequency of the eigenvalues asked for.
double highest_frequency(const Locus& locus) {
  double highest = 0.0;
  for (const auto& list : locus.eigenvalues)
    if (!list.empty()) highest = std::max(highest, list.back().imag() / (2.0 * std::numbers::pi));
  return highest;
}

/// Largest number of them at any value.
std::size_t most_eigenvalues(const Locus& locus) {
  std::size_t most = 0;
  for (const auto& list : locus.eigenvalues) most = std::max(most, list.size());
  return most;
}

/// @param trusted up to where the model answers, in the unit of the frequencies
void print_windows(const std::vector<TimedWindow>& windows, const NumericKey& key, double trusted) {
  if (windows.empty()) {
    fmt::print("no eigenvalue grows\n");
    return;
  }
  bool has_real = false, has_unresolved = false;
  fmt::print("{:>12}  {:>12}  {:>14}  {:>12}  {:>8}  {:>19}\n", "from", "to", "frequency (Hz)",
             "growth (1/s)", "gain", "time (s)");
  for (const TimedWindow& one : windows) {
    const UnstableWindow& window = one.window;
    const bool is_real = window.frequency == 0.0;
    const bool is_fast = !is_resolved(fastest_of(window), trusted);
    has_real = has_real || is_real;
    has_unresolved = has_unresolved || is_fast;
    fmt::print("{:>12.8g}  {:>12.8g}  {:>14}  {:>12.4f}", window.from, window.to,
               is_real ? std::string("none") : fmt::format("{:.2f}", window.frequency),
               window.growth_max);
    if (std::isfinite(one.from_time) && std::isfinite(one.to_time))
      fmt::print("  {:>8}  {:>8.4f} to {:.4f}",
                 is_fast ? std::string("-") : fmt::format("{:.3f}", one.gain), one.from_time,
                 one.to_time);
    fmt::print("{}\n", is_fast ? "  (above what the reduction resolves)" : "");
  }
  fmt::print("unstable windows of {}{}\n", key.path,
             key.unit.empty() ? "" : fmt::format(" ({})", printed_units(key)));
  if (has_real)
    fmt::print(
        "frequency none: a real eigenvalue; sliding is left without oscillation, by divergence or "
        "by "
        "friction that falls with the sliding velocity\n");
  if (has_unresolved)
    fmt::print(
        "no gain where the reduction does not resolve the growth: more modes change its rate\n");
}

void check_outputs(const LocusCommandOptions& options) {
  if (options.output) check_output(*options.output, options.stability.common.overwrite());
  for (const auto& figure : {options.figure, options.history}) {
    if (figure) check_figure(*figure, options.stability.common);
  }
}

ExitCode locus(LocusCommandOptions options) {
  check_outputs(options);
  StabilityOptions& stability = options.stability;
  const StabilityScene scene = load_stability_scene(stability);
  const LoadedScene& loaded = scene.loaded();
  const KeyRange range = make_range(scene, options.range);
  const auto family = scene.family({range.key}, stability.geometry());
  const double first = range.values.front();
  std::optional<LocusProgress> progress(std::in_place, "locus", *family, range);
  const Locus found =
      locus_along(*family, range.key, 0, {first}, range.values, stability.locus_options());
  progress.reset();
  const double trusted = std::min(family->trusted_frequency(std::array{range.values.front()}),
                                  family->trusted_frequency(std::array{range.values.back()}));
  const double highest = verdict_limit(found, stability.locus_window(), trusted);

  std::optional<PassingTimes> times;
  const bool is_path =
      range.key.path == drive_displacement_name || scene.default_key() == range.key.path;
  if (loaded.scene.time && is_path)
    times.emplace(loaded.scene, dynamic_cast<BodyStabilityFamily&>(*family));
  const std::vector<TimedWindow> windows = timed_windows(found, times);
  const std::string units = printed_units(range.key);
  if (options.output) {
    write_locus_file(*options.output, stability.common.overwrite(), found, windows, units,
                     {{"parameter", range.key.path},
                      {"units", units},
                      {"about", stability.about},
                      {"method", stability.method},
                      {"scene", stability.scene},
                      {"scene_hash", loaded.hash()},
                      {"scene_resolved", loaded.resolved()},
                      {"command", options.command_line},
                      {"version", std::string(version)},
                      {"commit", std::string(commit)},
                      {"date", utc_now()}});
  }
  if (options.figure || options.history) {
    LocusPicture picture;
    const AxisUnit unit =
        axis_unit(range.key, {options.range.from, options.range.to}, &loaded.tree);
    picture.parameter = range.key.path;
    picture.units = unit.name;
    picture.curves = curves_of(found, highest_frequency(found));
    for (LocusCurve& curve : picture.curves) curve.parameter = unit.numbers(curve.parameter);
    for (const UnstableWindow& window : found.unstable) {
      picture.windows.push_back(
          {unit.number(window.from), unit.number(window.to), window.frequency, window.growth_max});
    }
    picture.caption = fmt::format(
        "The lowest {} eigenvalues{}, {} from {} to {}; {}, scene {}.", most_eigenvalues(found),
        scene.about_text(stability), range.key.path, unit.number(range.values.front()),
        fmt::format("{:g}{}", unit.number(range.values.back()),
                    unit.name == "1" ? "" : " " + unit.name),
        std::filesystem::path(stability.scene).filename().string(), loaded.hash());
    if (options.figure) plot_locus(picture, *options.figure);
    if (options.history) plot_locus_histories(picture, *options.history);
  }

  if (stability.common.json) {
    Json object = {{"parameter", range.key.path},
                   {"units", units},
                   {"about", stability.about},
                   {"method", stability.method},
                   {"values", range.values},
                   {"eigenvalues", Json::array()},
                   {"unstable", windows_json(timed_windows(found, times), trusted)},
                   {"window", {0.0, number(highest)}},
                   {"unverified", found.unverified},
                   {"unresolved", found.unresolved},
                   {"file", options.output ? Json(*options.output) : Json(nullptr)}};
    for (const auto& list : found.eigenvalues) object["eigenvalues"].push_back(complex_list(list));
    print_json(object);
    return ExitCode::done;
  }
  print_windows(windows, range.key, trusted);
  fmt::print("{}{}\n", window_text(highest), limit_text(highest, trusted));
  print_resolution(found, range.key);
  for (const auto& file : {options.output, options.figure, options.history})
    if (file) fmt::print("{}\n", *file);
  return ExitCode::done;
}

}  // namespace

void add_locus_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<LocusCommandOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand("locus", "Eigenvalues along one key of a scene");
  add_stability_options(*verb, options->stability);
  add_range_options(*verb, options->range);
  verb->add_option("-o,--output", options->output,
                   "File to write (HDF5), as `spectrogram --predict` reads it");
  verb->add_option("--figure", options->figure,
                   "Picture of frequency against growth rate: .png, .svg or .pdf");
  verb->add_option("--history", options->history,
                   "Picture of growth rate and frequency against the parameter");
  add_force_option(*verb, options->stability.common);
  verb->callback([options, &action] { action = [options] { return locus(*options); }; });
}

}  // namespace stridor
