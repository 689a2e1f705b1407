#include "analysis/pair_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Value at x of the parabola through three points, or of the line through two.
Complex interpolate(const std::array<double, 3>& at, const std::array<Complex, 3>& f,
                    std::size_t count, double x) {
  if (count == 1) return f[0];
  const Complex first = (f[1] - f[0]) / (at[1] - at[0]);
  if (count == 2) return f[0] + first * (x - at[0]);
  const Complex second = ((f[2] - f[1]) / (at[2] - at[1]) - first) / (at[2] - at[0]);
  return f[0] + (x - at[0]) * (first + second * (x - at[1]));
}

/// Mean and square at x of the polynomials through all looks, in Lagrange's form.
PairLook polynomial(std::span<const PairLook> looks, double x) {
  PairLook sum{x, 0.0, 0.0};
  for (const PairLook& one : looks) {
    double weight = 1.0;
    for (const PairLook& other : looks)
      if (&other != &one) weight *= (x - other.value) / (one.value - other.value);
    sum.mean += weight * one.mean;
    sum.square += weight * one.square;
  }
  return sum;
}

}  // namespace

double PairLook::growth() const {
  return mean.real() + std::abs(std::sqrt(square).real());
}

std::optional<FoundPair> closest_pair(const std::vector<Complex>& eigenvalues,
                                      const PairLook& expected) {
  constexpr std::size_t most_considered = 8;
  struct Entry {
    Complex s;
    std::size_t index;
    double distance;
  };
  const Complex root = std::sqrt(expected.square);
  std::vector<Entry> entries;
  const auto add = [&](Complex s, std::size_t index) {
    const double distance =
        std::min(std::norm(s - expected.mean - root), std::norm(s - expected.mean + root));
    entries.push_back({s, index, distance});
  };
  for (std::size_t i = 0; i < eigenvalues.size(); ++i) {
    add(eigenvalues[i], i);
    if (eigenvalues[i].imag() > 0.0) add(std::conj(eigenvalues[i]), i);
  }
  if (entries.size() < 2) return std::nullopt;
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.distance < b.distance; });
  if (entries.size() > most_considered) entries.resize(most_considered);
  std::optional<FoundPair> closest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < entries.size(); ++j) {
    for (std::size_t k = 0; k < j; ++k) {
      const PairLook look = PairLook::of(expected.value, entries[j].s, entries[k].s);
      const double size =
          std::sqrt(std::abs(look.square)) + std::abs(root) + std::numeric_limits<double>::min();
      const double cost =
          std::abs(look.mean - expected.mean) + std::abs(look.square - expected.square) / size;
      if (cost >= least) continue;
      least = cost;
      closest = FoundPair{entries[j].index, entries[k].index, look};
    }
  }
  return closest;
}

PairLook interpolated(const std::vector<PairLook>& looks, double value, double centre) {
  std::vector<const PairLook*> order;
  for (const PairLook& look : looks) order.push_back(&look);
  const std::size_t count = std::min<std::size_t>(3, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    [&](const PairLook* a, const PairLook* b) {
                      return std::abs(a->value - centre) < std::abs(b->value - centre);
                    });
  std::array<double, 3> at{};
  std::array<Complex, 3> mean, square;
  for (std::size_t i = 0; i < count; ++i) {
    at[i] = order[i]->value;
    mean[i] = order[i]->mean;
    square[i] = order[i]->square;
  }
  return {value, interpolate(at, mean, count, value), interpolate(at, square, count, value)};
}

double growth_bound(const std::vector<PairLook>& looks, double from, double to) {
  constexpr int parts = 64;
  constexpr double safety = 4.0;
  const double inf = std::numeric_limits<double>::infinity();
  if (looks.size() != 6 || looks[2].value != from || looks[3].value != to) return inf;
  std::array<PairLook, parts + 1> found;
  double mean_error = 0.0;
  double square_error = 0.0;
  for (int i = 0; i <= parts; ++i) {
    PairLook& look = found[static_cast<std::size_t>(i)];
    look = polynomial({looks.data(), 6}, from + (to - from) * i / parts);
    const PairLook lower = polynomial({looks.data() + 1, 4}, look.value);
    mean_error = std::max(mean_error, safety * std::abs(look.mean - lower.mean));
    square_error = std::max(square_error, safety * std::abs(look.square - lower.square));
  }
  // A maximum between two of the places, by the curvature.
  double mean_rise = 0.0;
  double square_rise = 0.0;
  for (std::size_t i = 1; i < parts; ++i) {
    const auto& [before, here, after] = std::tie(found[i - 1], found[i], found[i + 1]);
    mean_rise = std::max(mean_rise, std::abs(before.mean - 2.0 * here.mean + after.mean));
    square_rise = std::max(square_rise, std::abs(before.square - 2.0 * here.square + after.square));
  }
  mean_error += 0.25 * mean_rise;
  square_error += 0.25 * square_rise;
  double bound = -inf;
  for (const PairLook& look : found) {
    const double root = 0.5 * (std::abs(look.square) + look.square.real()) + square_error;
    bound = std::max(bound, look.mean.real() + mean_error + std::sqrt(root));
  }
  return bound;
}

PairSearch::PairSearch(std::vector<PairLook> looks, double from, double to, double scale, Aim aim)
    : looks_(std::move(looks)),
      num_given_(looks_.size()),
      from_(from),
      to_(to),
      scale_(scale),
      aim_(aim) {}

void PairSearch::add(const PairLook& look) {
  error_ = std::abs(expected(look.value).square - look.square);
  looks_.push_back(look);
}

PairLook PairSearch::expected(double value) const {
  return expected(value, value);
}

/// The look with the largest Re D, or the least, among those between the ends.
const PairLook& PairSearch::best() const {
  const PairLook* top = nullptr;
  for (const PairLook& look : looks_) {
    if (look.value < from_ || look.value > to_) continue;
    if (top == nullptr || side() * look.square.real() > side() * top->square.real()) top = &look;
  }
  return *top;
}

/// Of Re D through the looks closest to the best one.
std::optional<double> PairSearch::vertex() const {
  const double centre = best().value;
  const double step = 0.25 * (to_ - from_);
  const double here = expected(centre, centre).square.real();
  const double before = expected(centre - step, centre).square.real();
  const double after = expected(centre + step, centre).square.real();
  const double curvature = before - 2.0 * here + after;
  if (!(side() * curvature < 0.0)) return std::nullopt;
  const double place = centre + 0.5 * step * (before - after) / curvature;
  if (!is_inside(place)) return std::nullopt;
  return place;
}

/// Value of largest or least growth of the pair, by the parabolas around a value.
double PairSearch::fastest_place(double around) const {
  constexpr int parts = 64;
  constexpr int octaves = 40;
  double place = around;
  double most = -std::numeric_limits<double>::infinity();
  const auto offer = [&](double value) {
    if (!is_inside(value)) return;
    const double growth = side() * expected(value, around).growth();
    if (growth <= most) return;
    most = growth;
    place = value;
  };
  offer(around);
  for (int i = 1; i < parts; ++i) offer(from_ + (to_ - from_) * i / parts);
  for (int i = 1; i < 2 * octaves; ++i) {
    const double offset = (to_ - from_) * std::exp2(-0.5 * i);
    offer(around + offset);
    offer(around - offset);
  }
  return place;
}

std::optional<double> PairSearch::next() const {
  constexpr double rounding = 1e-15;     // of D in proportion to scale²
  constexpr double least_growth = 1e-8;  // of scale: least growth of an undamped pair
  const PairLook& top = best();
  const std::optional<double> vertex_place = vertex();
  const bool is_first = looks_.size() == num_given_;
  const auto is_known = [&](double value) {
    return std::any_of(looks_.begin(), looks_.end(), [&](const PairLook& look) {
      return std::abs(look.value - value) <=
             4.0 * std::numeric_limits<double>::epsilon() * (std::abs(from_) + std::abs(to_));
    });
  };
  if (is_first && !vertex_place) {
    // Intersection of two straight branches.
    const double left = std::sqrt(std::abs(expected(from_).square));
    const double right = std::sqrt(std::abs(expected(to_).square));
    const double share = left + right > 0.0 ? left / (left + right) : 0.5;
    return from_ + (to_ - from_) * std::clamp(share, 0.05, 0.95);
  }
  if (is_first) return vertex_place;
  if (!is_inside(top.value) && !vertex_place) return std::nullopt;

  const double damping = std::abs(top.mean.real());
  if (vertex_place) {
    const double gain = side() * (expected(*vertex_place, top.value).square - top.square).real();
    const double peak = side() * top.square.real() + gain;
    const double matters = std::max(0.1 * damping * damping, rounding * scale_ * scale_);
    const double depth = std::abs(top.square.real());
    // The parabola must have predicted the last look.
    const bool is_settled = (gain <= matters && error_ <= 10.0 * matters) ||
                            (peak < 0.0 && gain <= 0.05 * depth && error_ <= 0.5 * depth);
    if (!is_settled && !is_known(*vertex_place)) return vertex_place;
  }
  double most = -std::numeric_limits<double>::infinity();
  for (const PairLook& look : looks_)
    if (look.value >= from_ && look.value <= to_) most = std::max(most, side() * look.growth());
  const double place = fastest_place(top.value);
  const double rise = side() * expected(place, top.value).growth() - most;
  const double floor = damping > least_growth * scale_ ? 0.0 : least_growth * scale_;
  if (rise <= std::max(0.2 * std::abs(most), floor) || is_known(place)) return std::nullopt;
  return place;
}

bool PairSearch::fits_ends() const {
  constexpr double largest_ratio = 4.0;
  constexpr double closest = 0.05;  // to an end, of the interval
  const PairLook& top = best();
  const double width = to_ - from_;
  if (!(top.value - from_ > closest * width && to_ - top.value > closest * width)) return true;
  const auto curvature_to = [&](double end) {
    const double distance = end - top.value;
    return std::abs((expected(end).square - top.square).real()) / (distance * distance);
  };
  const double left = curvature_to(from_);
  const double right = curvature_to(to_);
  return left <= largest_ratio * right && right <= largest_ratio * left;
}

}  // namespace stridor
