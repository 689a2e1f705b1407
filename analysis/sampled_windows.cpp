#include "analysis/sampled_windows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "analysis/window_ends.hpp"
#include "core/activity.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// An eigenvalue that grows.
struct Point {
  double value;
  Complex s;
};

double trapezium(const Point& a, const Point& b) {
  return 0.5 * (b.value - a.value) * (a.s.real() + b.s.real());
}

/// Difference of the integral of the growth from a point to the next to the trapezium, by the mean
/// of the parabolas through a point before and a point behind them; nothing where there are none.
/// One much closer than the two are to each other says nothing of the curvature.
std::optional<double> beside_trapezium(const std::vector<Point>& points, std::size_t first) {
  const Point& a = points[first];
  const Point& b = points[first + 1];
  const double width = b.value - a.value;
  const double least = 0.25 * width;
  const auto before =
      std::find_if(points.rend() - static_cast<std::ptrdiff_t>(first), points.rend(),
                   [&](const Point& point) { return a.value - point.value >= least; });
  const auto after =
      std::find_if(points.begin() + static_cast<std::ptrdiff_t>(first) + 2, points.end(),
                   [&](const Point& point) { return point.value - b.value >= least; });
  if (before == points.rend() || after == points.end()) return std::nullopt;
  const double slope = (b.s.real() - a.s.real()) / width;
  const auto curvature = [&](const Point& other) {  // half the second derivative
    const double along = other.value - a.value;
    return (other.s.real() - a.s.real() - slope * along) / (along * (along - width));
  };
  return -std::pow(width, 3) / 12.0 * (curvature(*before) + curvature(*after));
}

class WindowBuilder {
 public:
  WindowBuilder(const SpectrumSampler& sampler, const WindowEffort& effort, Locus& locus)
      : sampler_(sampler), effort_(effort), locus_(locus) {}

  void build(const std::vector<Sample>& samples);

 private:
  using Window = std::vector<Point>;

  void close(const Window& points);
  Point at(const Point& a, const Point& b, double value) const;
  Point climb(const Point& low, const Point& middle, const Point& high) const;

  const SpectrumSampler& sampler_;
  const WindowEffort& effort_;
  Locus& locus_;
};

void WindowBuilder::build(const std::vector<Sample>& samples) {
  std::vector<Window> open;
  const auto add_crossing = [&](const Point& point, int direction) {
    locus_.crossings.push_back(
        {point.value, point.s.imag() / (2.0 * std::numbers::pi), direction, 0});
  };
  for (const Sample& sample : samples) {
    std::vector<Complex> last;
    for (const Window& window : open) last.push_back(window.back().s);
    const std::vector<Complex> growing = sample.growing();
    const std::vector<int> partner = continuations(last, growing);
    std::vector<bool> is_taken(growing.size(), false);
    std::vector<Window> still_open;
    for (std::size_t j = 0; j < open.size(); ++j) {
      if (partner[j] < 0) {
        add_crossing(open[j].back(), -1);
        close(open[j]);
        continue;
      }
      const auto k = static_cast<std::size_t>(partner[j]);
      is_taken[k] = true;
      open[j].push_back({sample.value, growing[k]});
      still_open.push_back(std::move(open[j]));
    }
    for (std::size_t k = 0; k < growing.size(); ++k) {
      if (is_taken[k]) continue;
      still_open.push_back({{sample.value, growing[k]}});
      if (&sample != &samples.front()) add_crossing(still_open.back().back(), 1);
    }
    open = std::move(still_open);
  }
  for (const Window& window : open) close(window);
}

/// The eigenvalue of a window between two of its points; not growing where there is none.
Point WindowBuilder::at(const Point& a, const Point& b, double value) const {
  const double share = (value - a.value) / (b.value - a.value);
  const Complex expected = (1.0 - share) * a.s + share * b.s;
  const std::vector<Complex> growing = sampler_.around(value, expected).growing();
  const int found = continuations({expected}, growing)[0];
  if (found < 0) return {value, {0.0, expected.imag()}};
  return {value, growing[static_cast<std::size_t>(found)]};
}

/// Climbs to the largest growth between three points by golden sections.
Point WindowBuilder::climb(const Point& low, const Point& middle, const Point& high) const {
  const double ratio = 0.5 * (3.0 - std::sqrt(5.0));
  Point left = low, best = middle, right = high;
  const double width = high.value - low.value;
  for (int i = 0; i < effort_.climbing_steps && right.value - left.value > 1e-6 * width; ++i) {
    const bool is_right = right.value - best.value > best.value - left.value;
    const Point& end = is_right ? right : left;
    const double next = best.value + ratio * (end.value - best.value);
    const Point point = is_right ? at(best, right, next) : at(left, best, next);
    if (point.s.real() > best.s.real()) {
      (is_right ? left : right) = best;
      best = point;
    } else {
      (is_right ? right : left) = point;
    }
  }
  return best;
}

void WindowBuilder::close(const Window& points) {
  UnstableWindow window;
  window.from = points.front().value;
  window.to = points.back().value;
  const auto top =
      std::max_element(points.begin(), points.end(),
                       [](const Point& a, const Point& b) { return a.s.real() < b.s.real(); });
  Point peak = *top;
  if (top != points.begin() && top + 1 != points.end()) peak = climb(*(top - 1), *top, *(top + 1));
  constexpr double smooth = 1e-3;
  double roughly = 0.0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    roughly += trapezium(points[i], points[i + 1]);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Point& a = points[i];
    const Point& b = points[i + 1];
    if (effort_.ends == WindowEffort::Ends::by_pairs) {
      const std::optional<double> beside = beside_trapezium(points, i);
      if (beside && std::abs(*beside) <= smooth * roughly) {
        window.growth_integral += trapezium(a, b) + *beside;
        continue;
      }
    }
    const Point middle = at(a, b, 0.5 * (a.value + b.value));
    if (middle.s.real() > peak.s.real()) peak = middle;
    // Simpson's rule.
    window.growth_integral +=
        (b.value - a.value) / 6.0 * (a.s.real() + 4.0 * middle.s.real() + b.s.real());
  }
  window.growth_max = peak.s.real();
  window.frequency = peak.s.imag() / (2.0 * std::numbers::pi);
  window.value_max = peak.value;
  locus_.unstable.push_back(window);
}

/// Whether one eigenvalue stops growing between two samples and another begins: what continues one
/// that grows is close, and does not grow.
bool is_exchange(const Sample& a, const Sample& b) {
  const std::vector<Complex> growing = a.growing();
  const std::vector<Complex> after = b.growing();
  if (growing.empty() || growing.size() != after.size()) return false;
  const std::vector<int> partner = continuations(growing, after);
  for (std::size_t j = 0; j < growing.size(); ++j) {
    const double distance = std::abs(growing[j] - after[static_cast<std::size_t>(partner[j])]);
    for (std::size_t k = 0; k < b.eigenvalues.size(); ++k) {
      if (b.is_growing(k)) continue;
      if (4.0 * std::abs(growing[j] - b.eigenvalues[k]) < distance) return true;
    }
  }
  return false;
}

/// Halves intervals in which one eigenvalue may stop and another begin.
void split_exchanges(const SpectrumSampler& sampler, std::vector<Sample>& samples) {
  constexpr int most_halvings = 24;  // of one interval
  int num_halvings = 0;
  for (std::size_t i = 0; i + 1 < samples.size();) {
    const double middle = 0.5 * (samples[i].value + samples[i + 1].value);
    const bool is_wide = middle > samples[i].value && middle < samples[i + 1].value;
    const bool is_one =
        is_exchange(samples[i], samples[i + 1]) || is_exchange(samples[i + 1], samples[i]);
    if (!is_one || !is_wide || num_halvings == most_halvings) {
      ++i;
      if (!is_one) num_halvings = 0;
      continue;
    }
    ++num_halvings;
    samples.insert(samples.begin() + static_cast<std::ptrdiff_t>(i) + 1, sampler.near(middle));
  }
}

void sort_samples(std::vector<Sample>& samples) {
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.value < b.value; });
  const auto is_same = [](const Sample& a, const Sample& b) { return a.value == b.value; };
  samples.erase(std::unique(samples.begin(), samples.end(), is_same), samples.end());
}

void sort_by_place(Locus& locus) {
  std::sort(locus.unstable.begin(), locus.unstable.end(),
            [](const auto& a, const auto& b) { return a.from < b.from; });
  std::sort(locus.crossings.begin(), locus.crossings.end(),
            [](const auto& a, const auto& b) { return a.value < b.value; });
}

}  // namespace

void find_sampled_windows(const SpectrumSampler& sampler, const WindowEffort& effort,
                          std::vector<Sample> samples, Locus& locus) {
  split_exchanges(sampler, samples);
  std::vector<Sample> ends;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const std::size_t before = samples[i].num_growing();
    const std::size_t after = samples[i + 1].num_growing();
    const Activity narrowing(
        fmt::format("ends of windows, interval {} of {}", i + 1, samples.size() - 1));
    for (std::size_t rank = std::min(before, after) + 1; rank <= std::max(before, after); ++rank) {
      Sample stable = before < after ? samples[i] : samples[i + 1];
      Sample growing = before < after ? samples[i + 1] : samples[i];
      narrow_end(sampler, effort, rank, stable, growing);
      ends.push_back(std::move(stable));
      ends.push_back(std::move(growing));
    }
  }
  std::move(ends.begin(), ends.end(), std::back_inserter(samples));
  sort_samples(samples);
  WindowBuilder(sampler, effort, locus).build(samples);
  sort_by_place(locus);
}

void find_unstable_stretches(const SpectrumSampler& sampler, const WindowEffort& effort,
                             std::vector<Sample> samples, Locus& locus) {
  sort_samples(samples);
  std::vector<Sample> ends;
  const auto is_growing = [](const Sample& sample) { return sample.num_growing() > 0; };
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    if (is_growing(samples[i]) == is_growing(samples[i + 1])) continue;
    const bool begins = is_growing(samples[i + 1]);
    Sample stable = samples[begins ? i : i + 1];
    Sample growing = samples[begins ? i + 1 : i];
    narrow_end(sampler, effort, 1, stable, growing);
    locus.crossings.push_back(
        {growing.value, growing.fastest().imag() / (2.0 * std::numbers::pi), begins ? 1 : -1, 0});
    ends.push_back(std::move(stable));
    ends.push_back(std::move(growing));
  }
  std::move(ends.begin(), ends.end(), std::back_inserter(samples));
  sort_samples(samples);
  bool was_growing = false;
  for (const Sample& sample : samples) {
    const bool grows = is_growing(sample);
    if (grows) {
      const Complex s = sample.fastest();
      if (!was_growing)
        locus.unstable.push_back({sample.value, sample.value, 0.0, 0.0, 0.0, 0.0, 0});
      UnstableWindow& window = locus.unstable.back();
      window.to = sample.value;
      if (s.real() > window.growth_max) {
        window.growth_max = s.real();
        window.frequency = s.imag() / (2.0 * std::numbers::pi);
        window.value_max = sample.value;
      }
    }
    was_growing = grows;
  }
  sort_by_place(locus);
}

}  // namespace stridor
