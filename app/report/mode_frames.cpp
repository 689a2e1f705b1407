#include "app/report/mode_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "app/report/drawn_bodies.hpp"
#include "app/stability/analysed_spectrum.hpp"
#include "app/stability/passing_times.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "io/figures/mesh_picture.hpp"
#include "models/mode_shape.hpp"

namespace stridor {
namespace {

constexpr int most_modes = 20;

std::vector<DrawnBody> drawn_bodies(const std::vector<BodyShape>& shapes) {
  std::vector<DrawnBody> bodies;
  for (const BodyShape& shape : shapes)
    bodies.push_back({shape.name, shape.nodes.rows(), face_loops(shape.elements), shape.outlines});
  return bodies;
}

std::vector<double> places_of(const DrawnNodes& drawn, const std::vector<BodyShape>& shapes) {
  std::vector<double> places;
  for (const DrawnNodes::Part& part : drawn.parts)
    for (const int node : part.nodes)
      for (int d = 0; d < 3; ++d) places.push_back(shapes[part.body].nodes(node, d));
  return places;
}

/// Real and imaginary part of the displacement, x, y, z of every node; the largest is 1 and real.
std::vector<double> displacements_of(const DrawnNodes& drawn, const std::vector<BodyShape>& shapes) {
  std::complex<double> largest = 0.0;
  for (const DrawnNodes::Part& part : drawn.parts)
    for (const int node : part.nodes)
      for (int d = 0; d < 3; ++d) {
        const std::complex<double> u = shapes[part.body].displacement(node, d);
        if (std::abs(u) > std::abs(largest)) largest = u;
      }
  std::vector<double> values;
  for (const bool is_real : {true, false})
    for (const DrawnNodes::Part& part : drawn.parts)
      for (const int node : part.nodes)
        for (int d = 0; d < 3; ++d) {
          const std::complex<double> u = std::abs(largest) > 0.0
                                             ? shapes[part.body].displacement(node, d) / largest
                                             : std::complex<double>(0.0);
          values.push_back(is_real ? u.real() : u.imag());
        }
  return values;
}

/// The modes that vibrate, lowest first; where not all can be shown, those that grow and the
/// lowest.
std::vector<std::size_t> vibrating(const FoundSpectrum& found, int most) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < found.eigenvalues.size(); ++i)
    if (found.eigenvalues[i].s.imag() > 0.0) chosen.push_back(i);
  std::stable_partition(chosen.begin(), chosen.end(), [&](std::size_t i) {
    return found.eigenvalues[i].growth() > 0.0;
  });
  chosen.resize(std::min(chosen.size(), static_cast<std::size_t>(std::max(most, 0))));
  std::ranges::sort(chosen);
  return chosen;
}

/// Spaced over the values of a range, both ends among them, and as many of those wanted as leave a
/// third of the number to these.
std::vector<double> some_of(const FramedRange& range, int count) {
  std::vector<double> some;
  if (range.values.empty()) return some;
  const auto num_wanted = std::min<int>(static_cast<int>(range.wanted.size()), count - count / 3);
  const int steps = std::max(1, count - num_wanted - 1);
  for (int i = 0; i <= steps; ++i)
    some.push_back(std::lerp(range.values.front(), range.values.back(), 1.0 * i / steps));
  some.insert(some.end(), range.wanted.begin(), range.wanted.begin() + num_wanted);
  std::ranges::sort(some);
  some.erase(std::unique(some.begin(), some.end()), some.end());
  return some;
}

/// Frames as they come, and what the view says of them.
class Frames {
 public:
  Frames(const StabilityOptions& options, const LoadedScene& loaded, const FrameBudget& budget,
         ReportPage& page)
      : options_(options), loaded_(loaded), budget_(budget), page_(page) {}

  /// Adds the modes at the present member of a family.
  void add(const SceneFamily::Member& member, std::optional<double> value, double time) {
    if (member.model->sparse)
      throw ConfigError(Refusal::cannot_reduce, "",
                        "the bodies are not reduced, and too many unknowns to show at once");
    const Analysis analysis = analyse(options_, loaded_, member);
    if (model_ != member.model || !recovery_) {
      model_ = member.model;
      recovery_.emplace(*member.model, cache_);
    }
    const std::vector<std::size_t> modes = vibrating(analysis.found, num_modes_);
    if (modes.empty()) throw NumericalError(Refusal::eigenvalues_incomplete, "no mode vibrates");
    Json frame = {{"modes", Json::array()}};
    if (value) frame["value"] = *value;
    frame["time"] = number(time);
    std::vector<double> displacements;
    for (const std::size_t i : modes) {
      if (stop_requested()) throw Interrupted("nothing has been written");
      const std::vector<BodyShape> shapes =
          recovery_->mode(analysis.state.equilibrium, analysis.found.shape(i));
      if (view_.empty()) begin(shapes);
      if (frame["modes"].empty()) frame["places"] = page_.add_floats(places_of(drawn_, shapes));
      const Eigenvalue& one = analysis.found.eigenvalues[i];
      frame["modes"].push_back({{"frequency", one.frequency()}, {"growth", one.growth()}});
      const std::vector<double> of_mode = displacements_of(drawn_, shapes);
      displacements.insert(displacements.end(), of_mode.begin(), of_mode.end());
      if (static_cast<int>(frame["modes"].size()) >= num_modes_) break;
    }
    frame["displacements"] = page_.add_samples(displacements);
    view_["frames"].push_back(std::move(frame));
  }

  /// How many values fit; known after the first frame.
  int values_that_fit() const {
    return static_cast<int>(std::clamp(budget_.bytes / std::max(1.0, bytes_of_frame()), 1.0,
                                       static_cast<double>(budget_.most_values)));
  }
  Json& view() { return view_; }

 private:
  void begin(const std::vector<BodyShape>& shapes) {
    const std::vector<DrawnBody> bodies = drawn_bodies(shapes);
    drawn_ = drawn_nodes(bodies);
    if (drawn_.count == 0) throw ConfigError(Refusal::wrong_value, "", "no body has nodes to draw");
    while (num_modes_ > 1 && bytes_of_frame() > budget_.bytes) --num_modes_;
    if (bytes_of_frame() > 4.0 * budget_.bytes)
      throw ConfigError(Refusal::too_large, "",
                        fmt::format("{} nodes do not fit into the page (--budget)", drawn_.count));
    view_ = {{"type", "modes"},
             {"planar", !is_spatial(shapes)},
             {"nodes", drawn_.count},
             {"up", upward_axis(model_->system)},
             {"parts", parts_json(drawn_, bodies, page_)},
             {"frames", Json::array()}};
  }
  double bytes_of_frame() const {
    constexpr double bytes_per_number = 2.0;  // as of samples
    return 6.0 * bytes_per_number * static_cast<double>(drawn_.count) * num_modes_;
  }

  const StabilityOptions& options_;
  const LoadedScene& loaded_;
  FrameBudget budget_;
  ReportPage& page_;
  BodyCache cache_;
  const Model* model_ = nullptr;
  std::optional<ShapeRecovery> recovery_;
  DrawnNodes drawn_;
  int num_modes_ = most_modes;
  Json view_;
};

/// Adds a frame; a value without equilibrium becomes a remark.
bool add_frame(Frames& frames, SceneFamily& family, const std::vector<double>& at, double time,
               Json& remarks) {
  const std::optional<double> value =
      at.empty() ? std::nullopt : std::optional<double>(at.front());
  try {
    frames.add(family.at(at), value, time);
    return true;
  } catch (const NumericalError& error) {
    remarks.push_back(value ? fmt::format("No modes at {:g}: {}", *value, error.what())
                            : std::string("No modes: ") + error.what());
    return false;
  }
}

/// The scene as written where it is still there and the same: only that has expressions, on which a
/// parameter acts.
LoadedScene load_framed(const FramedScene& scene) {
  if (!scene.path.empty() && !scene.hash.empty()) {
    try {
      LoadedScene written = load_scene(scene.path, {});
      if (written.hash() == scene.hash) return written;
    } catch (const ConfigError&) {
    } catch (const FileError&) {
    }
  }
  return load_resolved_scene(scene.resolved, scene.source);
}

void make_frames(const FramedScene& scene, const std::optional<FramedRange>& range,
                 const FrameBudget& budget, ReportPage& page, Json& section) {
  const LoadedScene loaded = load_framed(scene);
  StabilityOptions options;
  options.scene = scene.source;
  options.count = most_modes;
  if (range) options.about = range->about;
  if (range && range->highest)
    options.below = fmt::format("{:.17g} Hz", *range->highest * (1.0 + 1e-9));
  make_choices(options, loaded.scene);
  std::vector<NumericKey> keys;
  std::vector<double> values;
  if (range && !range->values.empty()) {
    keys.push_back(find_stability_key(loaded.scene, range->parameter, "parameter"));
    values = range->values;
  }
  SceneFamily family(loaded, keys);
  Frames frames(options, loaded, budget, page);
  std::optional<BodyStabilityFamily> passed;
  std::optional<PassingTimes> times;
  if (!keys.empty() && loaded.scene.time &&
      (keys.front().path == drive_displacement_name || keys.front().path == start_key(loaded.scene.model))) {
    passed.emplace(loaded, keys, options.geometry());
    times.emplace(loaded.scene, *passed);
  }
  const auto time_of = [&](double value) {
    return times ? times->at(value) : std::numeric_limits<double>::quiet_NaN();
  };
  if (keys.empty()) {
    add_frame(frames, family, {}, time_of(0.0), section["remarks"]);
  } else {
    // The first one tells how large a frame is.
    add_frame(frames, family, {values.front()}, time_of(values.front()), section["remarks"]);
    const std::vector<double> some = some_of(*range, frames.values_that_fit());
    for (std::size_t i = 1; i < some.size(); ++i)
      add_frame(frames, family, {some[i]}, time_of(some[i]), section["remarks"]);
  }
  if (frames.view().empty()) return;
  Json view = frames.view();
  if (!keys.empty()) {
    view["parameter"] = keys.front().path;
    view["units"] = printed_units(keys.front());
  }
  view["about"] = options.about;
  section["views"].push_back(std::move(view));
}

}  // namespace

void add_mode_frames(const FramedScene& scene, const std::optional<FramedRange>& range,
                     const FrameBudget& budget, ReportPage& page, Json& section) {
  const Activity computing("shapes of modes for the report");
  try {
    make_frames(scene, range, budget, page, section);
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    section["remarks"].push_back(std::string("No shapes of modes: ") + error.what());
  }
}

}  // namespace stridor
