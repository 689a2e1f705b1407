#include "app/stability/locus_curves.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace stridor {
namespace {

constexpr double gap = std::numeric_limits<double>::quiet_NaN();

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

/// Rounding on the imaginary axis is no growth; pictures show zero as the edge of growth.
std::complex<double> without_rounding(std::complex<double> s) {
  const bool is_on_axis = std::abs(s.real()) <= 1e-7 * std::abs(s);
  return is_on_axis ? std::complex<double>(-std::numeric_limits<double>::min(), s.imag()) : s;
}

}  // namespace

std::vector<LocusCurve> curves_of(const Locus& locus, double highest) {
  std::vector<LocusCurve> curves;
  const auto add = [&](LocusCurve& curve, double value, std::complex<double> s) {
    const double frequency = s.imag() / (2.0 * std::numbers::pi);
    const bool is_shown = frequency <= highest;
    curve.parameter.push_back(value);
    curve.growth.push_back(is_shown ? s.real() : gap);
    curve.frequency.push_back(is_shown ? frequency : gap);
  };
  for (std::size_t k = 0; k < locus.branches.size(); ++k) {
    // The samples, and the places between them where the branch crosses the axis or grows most.
    std::map<double, std::complex<double>> points;
    const auto add_point = [&](double value, double growth, double frequency) {
      points[value] = {growth, 2.0 * std::numbers::pi * frequency};
    };
    const Branch& branch = locus.branches[k];
    for (std::size_t i = 0; i < branch.values.size(); ++i)
      points[branch.values[i]] = without_rounding(branch.s[i]);
    for (const UnstableWindow& window : locus.unstable) {
      if (window.branch == static_cast<int>(k))
        add_point(window.value_max, window.growth_max, window.frequency);
    }
    for (const Crossing& crossing : locus.crossings)
      if (crossing.branch == static_cast<int>(k))
        add_point(crossing.value, 0.0, crossing.frequency);
    curves.emplace_back();
    for (const auto& [value, s] : points) add(curves.back(), value, s);
  }
  if (!locus.branches.empty()) return curves;
  for (const auto& points : connected(locus)) {
    curves.emplace_back();
    for (const auto& [value, s] : points) add(curves.back(), value, without_rounding(s));
  }
  return curves;
}

double highest_frequency(const Locus& locus) {
  double highest = 0.0;
  for (const auto& list : locus.eigenvalues)
    if (!list.empty()) highest = std::max(highest, list.back().imag() / (2.0 * std::numbers::pi));
  return highest;
}

}  // namespace stridor
