#include "analysis/counted_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>

#include "core/errors.hpp"

namespace stridor {
namespace {

constexpr double relative_rounding = 1e-9;  ///< of |s|, as pairs have converged

bool grows(const Eigenvalue& one) {
  constexpr double rounding = 1e-10;
  return one.growth() > rounding * std::abs(one.s);
}

SampledSpectrum sampled(const std::vector<Eigenvalue>& eigenvalues) {
  SampledSpectrum found;
  for (const Eigenvalue& one : eigenvalues) {
    found.eigenvalues.push_back(one.s);
    found.rounding.push_back(relative_rounding * std::abs(one.s));
  }
  return found;
}

}  // namespace

SparseSpectrum whole_spectrum(const SparseSystem& system, SpectrumWindow window) {
  if (std::isfinite(window.frequency)) window.count.reset();
  SparseSpectrum spectrum = sparse_spectrum(system, window);
  if (!spectrum.is_complete) {
    throw NumericalError(
        fmt::format("below {:.6g} Hz the argument principle counts {} eigenvalues, and {} were "
                    "found with their conjugates; try another frequency with --below",
                    spectrum.rectangle.height / (2.0 * std::numbers::pi), spectrum.num_counted,
                    spectrum.num_found));
  }
  return spectrum;
}

CountedSpectra::CountedSpectra(System system, const SpectrumWindow& window)
    : system_(std::move(system)), window_(window) {}

SampledSpectrum CountedSpectra::at(double value) {
  SparseSpectrum spectrum = whole_spectrum(system_(value), window_);
  spectrum.modes.resize(0, 0);
  SampledSpectrum found = sampled(spectrum.eigenvalues);
  constexpr Eigen::Index most_kept = Eigen::Index{1} << 26;  // complex numbers: 1 GB
  kept_ += spectrum.right.size();
  known_.insert_or_assign(value, std::move(spectrum));
  while (kept_ > most_kept && known_.size() > 2) {
    const auto first = known_.begin()->first == value ? std::next(known_.begin()) : known_.begin();
    kept_ -= first->second.right.size();
    known_.erase(first);
  }
  return found;
}

SampledSpectrum CountedSpectra::near(double value) {
  constexpr int first_refined = 3;
  const SpectrumBasis* basis = basis_at(value);
  if (basis == nullptr) return at(value);
  const SparseSystem system = system_(value);
  for (int num_refined = first_refined;; num_refined *= 2) {
    const std::vector<Eigenvalue> found = fastest_near(system, *basis, num_refined).eigenvalues;
    // Where all that were refined grow, others may.
    const auto num_growing = std::count_if(found.begin(), found.end(), grows);
    if (num_growing < num_refined || static_cast<int>(found.size()) < num_refined)
      return sampled(found);
  }
}

SampledSpectrum CountedSpectra::around(double value, std::complex<double> place) {
  constexpr int num_refined = 4;
  const SpectrumBasis* basis = basis_at(value);
  if (basis == nullptr) return at(value);
  return sampled(closest_near(system_(value), *basis, place, num_refined).eigenvalues);
}

SampledSpectrum CountedSpectra::glimpse(double value) {
  const SpectrumBasis* basis = basis_at(value);
  if (basis == nullptr) return at(value);
  SampledSpectrum found;
  found.eigenvalues = projected_eigenvalues(system_(value), *basis);
  for (const std::complex<double>& s : found.eigenvalues)
    found.rounding.push_back(relative_rounding * std::abs(s));
  return found;
}

/// Of the values next to it; null where there are not two, or where it is one of them.
const SpectrumBasis* CountedSpectra::basis_at(double value) {
  const auto above = known_.lower_bound(value);
  if (above == known_.end() || above == known_.begin() || above->first == value) return nullptr;
  const auto below = std::prev(above);
  if (std::pair(below->first, above->first) != basis_of_) {
    basis_ = spectrum_basis({&below->second, &above->second});
    basis_of_ = {below->first, above->first};
  }
  return &basis_;
}

SpectrumFamily counted_spectra(CountedSpectra::System system, const SpectrumWindow& window) {
  const auto spectra = std::make_shared<CountedSpectra>(std::move(system), window);
  return {
      [spectra](double value) { return spectra->at(value); },
      [spectra](double value) { return spectra->near(value); },
      [spectra](double value, std::complex<double> place) { return spectra->around(value, place); },
      [spectra](double value) { return spectra->glimpse(value); }};
}

}  // namespace stridor
