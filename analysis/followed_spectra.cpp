#include "analysis/followed_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/memory.hpp"
#include "solvers/eigenvalues/full_spectrum.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// For the vectors of values that were followed.
double memory_for_vectors() {
  return std::min(1e9, 0.05 * memory_limit().bytes);
}

/// The middle of the widest strip between two numbers that none of a list lies in.
double widest_gap(std::vector<double> taken, double from, double to) {
  std::erase_if(taken, [&](double one) { return one <= from || one >= to; });
  taken.push_back(to);
  std::sort(taken.begin(), taken.end());
  double low = from, middle = from, widest = 0.0;
  for (const double high : taken) {
    if (high - low > widest) {
      widest = high - low;
      middle = 0.5 * (low + high);
    }
    low = high;
  }
  return middle;
}

constexpr double rigid = 1e-6;  ///< |s| by the height of motions of which all terms are rounding

/// Eigenvalues up to a height that decay no faster than a bound, conjugates counted. Of rigid
/// motions, whose two eigenvalues rounding makes real or complex, there are as many with other
/// values.
int number_within(const std::vector<Complex>& all, double height, double left) {
  int number = 0;
  for (const Complex& s : all)
    if (s.imag() <= height && s.real() >= left && std::abs(s) > rigid * height)
      number += s.imag() > 0.0 ? 2 : 1;
  return number;
}

}  // namespace

double FollowedSpectra::Known::bytes() const {
  return static_cast<double>(sizeof(Complex)) * static_cast<double>(pairs.right.size());
}

const FollowedSpectra::Known* FollowedSpectra::nearest(double value, Eigen::Index size) const {
  const Known* best = nullptr;
  for (const Known& one : known_) {
    if (one.pairs.right.rows() != size) continue;
    if (best == nullptr || std::abs(one.value - value) < std::abs(best->value - value)) best = &one;
  }
  return best;
}

/// Whether none has been lost or come from nowhere between two values.
bool FollowedSpectra::agree(const TwoSidedPairs& known, const TwoSidedPairs& found) const {
  std::vector<double> heights, growths;
  for (const TwoSidedPairs* pairs : {&known, &found}) {
    for (const Complex& s : pairs->s) {
      heights.push_back(s.imag());
      growths.push_back(s.real());
    }
  }
  const double height = widest_gap(heights, 0.9 * rectangle_.height, 1.1 * rectangle_.height);
  const double left = widest_gap(growths, rectangle_.left(), 0.8 * rectangle_.left());
  return number_within(known.s, height, left) == number_within(found.s, height, left);
}

/// Whether as many vibrate as are wanted.
bool FollowedSpectra::are_enough(const TwoSidedPairs& found) const {
  if (!window_.count) return true;
  const auto vibrates = [&](Complex s) { return s.imag() > 0.0 && rectangle_.contains(s); };
  return std::count_if(found.s.begin(), found.s.end(), vibrates) >= *window_.count;
}

/// Those of a list within the window.
SampledSpectrum FollowedSpectra::sampled(const std::vector<Complex>& all, bool is_counted) const {
  constexpr double relative_rounding = 1e-9;  // of |s|, as pairs have converged
  SampledSpectrum spectrum;
  spectrum.is_counted = is_counted;
  for (const Complex& s : all) {
    if (!rectangle_.contains(s)) continue;
    const double share = std::abs(s) < rigid * rectangle_.height ? 1.0 : relative_rounding;
    spectrum.eigenvalues.push_back(s);
    spectrum.rounding.push_back(share * std::abs(s));
  }
  return spectrum;
}

void FollowedSpectra::keep(double value, TwoSidedPairs pairs) {
  known_.push_front({value, std::move(pairs)});
  bytes_ += known_.front().bytes();
  while (bytes_ > memory_for_vectors() && known_.size() > 1) {
    bytes_ -= known_.back().bytes();
    known_.pop_back();
  }
}

SampledSpectrum FollowedSpectra::search(double value, const SparseSystem& system) {
  ++num_searched_;
  SparseSpectrum found = full_spectrum(system, window_);
  rectangle_.height = std::max(rectangle_.height, found.rectangle.height);
  std::vector<Complex> all;
  for (const Eigenvalue& one : found.eigenvalues) all.push_back(one.s);
  const auto number = [&](std::vector<Complex> some) {
    std::erase_if(some, [&](Complex s) { return !found.rectangle.contains(s); });
    return number_within(some, found.rectangle.height, found.rectangle.left());
  };
  // Vectors of a part would lead to parts.
  if (number(found.pairs.s) == number(all)) keep(value, std::move(found.pairs));
  return spectra_[value] = sampled(all, true);
}

std::optional<SampledSpectrum> FollowedSpectra::known(double value) const {
  const auto found = spectra_.find(value);
  return found == spectra_.end() ? std::nullopt : std::optional(found->second);
}

SampledSpectrum FollowedSpectra::at(double value, const SparseSystem& system) {
  if (auto found = known(value)) return *std::move(found);
  const Known* start = nearest(value, system.size());
  if (start == nullptr) return search(value, system);
  try {
    const Activity finding("eigenvectors of a value");
    int factorisations = 0;
    TwoSidedPairs found = pairs_near(system, start->pairs, rectangle_.height, factorisations,
                                     SpectrumWork::Sides::right);
    if (agree(start->pairs, found) && are_enough(found) && are_pairs(system, found)) {
      ++num_followed_;
      SampledSpectrum spectrum = sampled(found.s, false);
      keep(value, std::move(found));
      return spectra_[value] = std::move(spectrum);
    }
  } catch (const NumericalError&) {  // the dense method says what is wrong
  }
  return search(value, system);
}

}  // namespace stridor
