#include "analysis/sampled_windows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "analysis/pair_model.hpp"
#include "core/activity.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// The number in the middle between two others in the order of all floating-point numbers: between
/// 0 and 1e98 it needs 64 steps to anywhere, where halves need hundreds.
double middle_number(double a, double b) {
  const auto order = [](double x) {
    const auto bits = std::bit_cast<std::int64_t>(x);
    return bits < 0 ? std::numeric_limits<std::int64_t>::min() - bits : bits;
  };
  const std::int64_t low = order(a);
  const std::int64_t high = order(b);
  // Without overflow of the sum.
  const std::int64_t middle = (low >> 1) + (high >> 1) + (low & high & 1);
  return std::bit_cast<double>(middle < 0 ? std::numeric_limits<std::int64_t>::min() - middle
                                          : middle);
}

/// Value at which the rank-th largest excess changes its sign, by halves.
class SignChange {
 public:
  SignChange(const SpectrumSampler& sampler, const WindowEffort& effort, std::size_t rank)
      : sampler_(sampler), effort_(effort), rank_(rank) {}

  /// Narrows the interval until nothing lies between.
  void narrow(Sample& stable, Sample& growing) const {
    constexpr int max_steps = 200;
    for (int i = 0; i < max_steps; ++i) {
      const double next = next_value(stable.value, growing.value, i);
      const double width = std::abs(growing.value - stable.value);
      if (next == stable.value || next == growing.value ||
          width <= effort_.tolerance * std::abs(next)) {
        return;
      }
      Sample sample = sampler_.near(next);
      (sample.ranked_excess(rank_) > 0.0 ? growing : stable) = std::move(sample);
    }
  }

 private:
  static double next_value(double a, double b, int step) {
    constexpr int first_by_order = 12;
    constexpr double wide = 1024.0;
    const double larger = std::max(std::abs(a), std::abs(b));
    const double smaller = std::min(std::abs(a), std::abs(b));
    const bool is_by_order = step >= first_by_order && larger > wide * smaller && a * b >= 0.0;
    return is_by_order ? middle_number(a, b) : 0.5 * (a + b);
  }

  const SpectrumSampler& sampler_;
  const WindowEffort& effort_;
  std::size_t rank_;
};

/// The same for spectra that are dear. Two eigenvalues that meet do so with a root, and beside
/// their window another one may be the largest: what stays smooth are mean and square of the pair
/// (PairLook), of whose parabolas the growth vanishes where the next sample is taken. Where that
/// does not narrow the interval, it is halved.
class PairedSignChange {
 public:
  PairedSignChange(const SpectrumSampler& sampler, double tolerance, std::size_t rank)
      : sampler_(sampler), tolerance_(tolerance), rank_(rank) {}

  void narrow(Sample& stable, Sample& growing) const;

 private:
  /// The pair in the samples at hand.
  struct Pair {
    std::vector<PairLook> looks;
    double rounding = 0.0;                                   ///< of its growth, 1/s
    double last = std::numeric_limits<double>::quiet_NaN();  ///< value of the latest look

    double growth(double value, double centre) const {
      return interpolated(looks, value, centre).growth() - rounding;
    }
  };

  std::size_t beginner(const Sample& stable, const Sample& growing) const;
  Pair pair_of(const Sample& stable, const Sample& growing) const;
  double proposed(const Pair& pair, double stable, double growing, double least) const;

  const SpectrumSampler& sampler_;
  double tolerance_;
  std::size_t rank_;
};

/// An eigenvalue that grows and continues none that does on the other side: of several as many from
/// the fastest on as the rank says.
std::size_t PairedSignChange::beginner(const Sample& stable, const Sample& growing) const {
  std::vector<std::size_t> begun;
  for (std::size_t i = 0; i < growing.eigenvalues.size(); ++i)
    if (growing.is_growing(i)) begun.push_back(i);
  const std::vector<Complex> known = stable.growing();
  const std::vector<int> partner = continuations(known, growing.growing());
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < begun.size(); ++k)
    if (std::ranges::find(partner, static_cast<int>(k)) == partner.end())
      others.push_back(begun[k]);
  std::ranges::sort(
      others, [&](std::size_t a, std::size_t b) { return growing.excess[a] > growing.excess[b]; });
  return others[std::min(rank_ - known.size(), others.size()) - 1];
}

/// The eigenvalue that begins to grow with the one closest to it, or with its conjugate.
PairedSignChange::Pair PairedSignChange::pair_of(const Sample& stable,
                                                 const Sample& growing) const {
  const std::size_t place = beginner(stable, growing);
  const Complex s = growing.eigenvalues[place];
  std::optional<Complex> partner;
  if (s.imag() > 0.0) partner = std::conj(s);
  for (std::size_t i = 0; i < growing.eigenvalues.size(); ++i)
    if (i != place && (!partner || std::abs(growing.eigenvalues[i] - s) < std::abs(*partner - s)))
      partner = growing.eigenvalues[i];
  Pair pair;
  if (!partner) return pair;
  pair.rounding = s.real() - growing.excess[place];
  pair.looks.push_back(PairLook::of(growing.value, s, *partner));
  PairLook expected = pair.looks.front();
  expected.value = stable.value;
  if (const auto there = closest_pair(stable.eigenvalues, expected))
    pair.looks.push_back(there->look);
  return pair;
}

/// Where the growth of the pair vanishes between two values; a little beyond, as seen from the
/// latest look, where the other end is far, so that it comes close too. The middle where nothing
/// vanishes.
double PairedSignChange::proposed(const Pair& pair, double stable, double growing,
                                  double least) const {
  const double middle = 0.5 * (stable + growing);
  if (pair.looks.size() < 2) return middle;
  const double centre = std::isnan(pair.last) ? middle : pair.last;
  const double of_stable = pair.growth(stable, centre), of_growing = pair.growth(growing, centre);
  // An end that is the root but for rounding may have the other sign.
  constexpr double rounding = 1e-4;
  const bool is_stable_root = of_stable > 0.0 && of_stable <= rounding * of_growing;
  const bool is_growing_root = of_growing <= 0.0 && of_growing >= rounding * of_stable;
  const bool has_root = (of_stable <= 0.0 && of_growing > 0.0) || is_stable_root || is_growing_root;
  if (!has_root) return middle;
  double below = is_growing_root ? growing : stable;
  double above = is_stable_root ? stable : growing;
  constexpr int most_halvings = 60;
  for (int i = 0; i < most_halvings; ++i) {
    const double between = 0.5 * (below + above);
    (pair.growth(between, centre) > 0.0 ? above : below) = between;
  }
  const double root = 0.5 * (below + above);
  if (std::isnan(pair.last)) return root;
  const double far =
      std::abs(pair.last - stable) < std::abs(pair.last - growing) ? growing : stable;
  const double beyond = std::max(2.0 * std::abs(root - pair.last), 1.5 * least);
  return std::abs(far - root) > 4.0 * beyond ? root + std::copysign(beyond, far - root) : root;
}

void PairedSignChange::narrow(Sample& stable, Sample& growing) const {
  constexpr int max_steps = 100;
  const double range = std::abs(growing.value - stable.value);
  Pair pair = pair_of(stable, growing);
  double width_before = std::numeric_limits<double>::infinity();  // two steps ago
  double last_width = width_before;
  for (int i = 0; i < max_steps; ++i) {
    const double width = std::abs(growing.value - stable.value);
    const double least = tolerance_ * std::abs(growing.value) + 1e-3 * tolerance_ * range;
    if (!(width > 2.0 * least)) return;
    const bool narrows = width <= 0.5 * width_before;
    width_before = last_width;
    last_width = width;
    if (!narrows) pair = pair_of(stable, growing);
    double next = narrows ? proposed(pair, stable.value, growing.value, least)
                          : 0.5 * (stable.value + growing.value);
    const auto [low, high] = std::minmax(stable.value, growing.value);
    next = std::clamp(next, low + least, high - least);
    if (next == stable.value || next == growing.value) return;
    Sample sample = sampler_.near(next);
    if (!pair.looks.empty()) {
      const PairLook expected = interpolated(pair.looks, next, next);
      if (const auto found = closest_pair(sample.eigenvalues, expected)) {
        pair.looks.push_back(found->look);
        pair.last = next;
      }
    }
    (sample.ranked_excess(rank_) > 0.0 ? growing : stable) = std::move(sample);
  }
}

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

void narrow(const SpectrumSampler& sampler, const WindowEffort& effort, std::size_t rank,
            Sample& stable, Sample& growing) {
  if (effort.ends == WindowEffort::Ends::by_pairs) {
    PairedSignChange(sampler, effort.tolerance, rank).narrow(stable, growing);
  } else {
    SignChange(sampler, effort, rank).narrow(stable, growing);
  }
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
      narrow(sampler, effort, rank, stable, growing);
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
    narrow(sampler, effort, 1, stable, growing);
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
