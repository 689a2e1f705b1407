#include "analysis/window_ends.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/pair_model.hpp"

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

}  // namespace

void narrow_end(const SpectrumSampler& sampler, const WindowEffort& effort, std::size_t rank,
                Sample& stable, Sample& growing) {
  if (effort.ends == WindowEffort::Ends::by_pairs) {
    PairedSignChange(sampler, effort.tolerance, rank).narrow(stable, growing);
  } else {
    SignChange(sampler, effort, rank).narrow(stable, growing);
  }
}

}  // namespace stridor
