#include "analysis/counted_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <numbers>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/memory.hpp"
#include "solvers/eigenvalues/full_spectrum.hpp"

namespace stridor {
namespace {

constexpr double relative_rounding = 1e-9;  ///< of |s|, as pairs have converged
/// Unknowns up to which systems of no span are projected: what their bases take of memory.
constexpr Eigen::Index most_direct = 20'000;

/// For systems that may be asked for again.
double memory_for_systems() {
  return std::min(4e9, 0.1 * memory_limit().bytes);
}

double bytes_of(const SparseMatrix& matrix) {
  constexpr double bytes_per_entry = sizeof(double) + sizeof(int);
  return bytes_per_entry * static_cast<double>(matrix.nonZeros());
}

SampledSpectrum sampled(const std::vector<std::complex<double>>& eigenvalues) {
  SampledSpectrum found;
  found.eigenvalues = eigenvalues;
  for (const std::complex<double>& s : eigenvalues)
    found.rounding.push_back(relative_rounding * std::abs(s));
  return found;
}

std::vector<std::complex<double>> eigenvalues_of(const SparseSpectrum& spectrum) {
  std::vector<std::complex<double>> eigenvalues;
  for (const Eigenvalue& one : spectrum.eigenvalues) eigenvalues.push_back(one.s);
  return eigenvalues;
}

}  // namespace

SparseSpectrum whole_spectrum(const SparseSystem& system, SpectrumWindow window,
                              const SpectrumWork& work) {
  if (std::isfinite(window.frequency)) window.count.reset();
  SparseSpectrum spectrum = sparse_spectrum(system, window, work);
  if (!spectrum.is_complete) {
    throw NumericalError(
        Refusal::eigenvalues_incomplete,
        fmt::format("below {:.6g} Hz the argument principle counts {} eigenvalues, and {} were "
                    "found with their conjugates; try another frequency with --below",
                    spectrum.rectangle.height / (2.0 * std::numbers::pi), spectrum.num_counted,
                    spectrum.num_found));
  }
  return spectrum;
}

std::shared_ptr<const SparseSystem> KeptSystems::at(double value) {
  const auto known =
      std::find_if(kept_.begin(), kept_.end(), [&](const Kept& one) { return one.value == value; });
  if (known != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, known);
    return kept_.front().system;
  }
  ++num_made_;
  Kept made{value, std::make_shared<const SparseSystem>(system_(value)), 0.0};
  made.bytes = bytes_of(made.system->mass) + bytes_of(made.system->velocity) +
               bytes_of(made.system->position);
  bytes_ += made.bytes;
  kept_.push_front(made);
  while (bytes_ > most_bytes_ && !kept_.empty()) {
    bytes_ -= kept_.back().bytes;
    kept_.pop_back();
  }
  return made.system;
}

CountedSpectra::CountedSpectra(System system, const SpectrumWindow& window,
                               std::optional<std::pair<double, double>> range)
    : systems_(std::move(system), memory_for_systems()),
      window_(window),
      range_(std::move(range)),
      followed_(window) {
  if (std::isfinite(window_.frequency)) window_.count.reset();
  if (range_ && !(range_->first < range_->second)) range_.reset();
}

SampledSpectrum CountedSpectra::search(double value, const SparseSystem& system) {
  const auto known = searched_.find(value);
  if (known != searched_.end()) return known->second;
  ++effort_.num_searched;
  return searched_[value] = sampled(eigenvalues_of(whole_spectrum(system, window_)));
}

/// Of a full system; nothing of a sparse one.
std::optional<SampledSpectrum> CountedSpectra::follow(double value) {
  if (const auto known = followed_.known(value)) return known;
  const std::shared_ptr<const SparseSystem> system = systems_.at(value);
  if (!is_full(*system)) return std::nullopt;
  SampledSpectrum found = followed_.at(value, *system);
  effort_.num_followed = followed_.num_followed();
  effort_.num_searched_full = followed_.num_searched();
  return found;
}

void CountedSpectra::begin() {
  has_begun_ = true;
  if (!range_) return;
  try {
    make_basis();
    return;
  } catch (const NumericalError&) {  // of another value than the one asked for
  } catch (const ConfigError&) {
  }
  span_.reset();
  basis_.reset();
  count_.reset();
}

/// All pairs of both sides in the window of the first system.
SparseSpectrum CountedSpectra::search_first(const SparseSystem& first) {
  ++effort_.num_searched;
  SpectrumWork work;
  work.sides = SpectrumWork::Sides::both;
  if (span_->num_parts() == 2) {
    count_.emplace(first, span_->part(1), 1.0);
    work.on_count = [this](std::complex<double> s, const SparseFactor& factor) {
      count_->add(s, factor);
    };
  }
  return whole_spectrum(first, window_, work);
}

/// The whole search at the first value, and what follows from it.
void CountedSpectra::make_basis() {
  const std::shared_ptr<const SparseSystem> first_kept = systems_.at(range_->first);
  const std::shared_ptr<const SparseSystem> last_kept = systems_.at(range_->second);
  const SparseSystem& first = *first_kept;
  const SparseSystem& last = *last_kept;
  if (last.size() != first.size() || is_full(first) || is_full(last)) return;
  span_.emplace(first);
  if (!span_->factors(last)) return;
  SparseSpectrum spectrum = search_first(first);
  searched_[range_->first] = sampled(eigenvalues_of(spectrum));
  num_first_ = spectrum.num_counted;
  size_ = first.size();
  const double height = spectrum.rectangle.height;
  // Those with left vectors must be those that were counted.
  int num_sided = 0;
  for (const std::complex<double>& s : spectrum.pairs.s)
    if (spectrum.rectangle.contains(s)) num_sided += s.imag() > 0.0 ? 2 : 1;
  if (num_sided != num_first_) return;
  for (const std::complex<double>& s : spectrum.pairs.s)
    if (s.imag() > height) above_.push_back(s);
  for (const double omega : spectrum.omega)
    if (omega > 1.1 * height) above_.emplace_back(0.0, omega);
  basis_.emplace(height);
  basis_->add(std::move(spectrum.pairs));
  if (span_->num_parts() > 1) extend();
}

/// Adds values to the basis until its projections are good between them: the extrema of Chebyshev's
/// polynomials of degree 3, then 5, then halves of intervals.
void CountedSpectra::extend() {
  constexpr int most_levels = 4;  // of halves
  const auto [from, to] = *range_;
  const auto at_share = [low = from, width = to - from](double share) {
    return low + share * width;
  };
  const auto join_at = [&](std::initializer_list<double> shares) {
    for (const double share : shares) join(member(at_share(share)));
  };
  const auto is_good_at = [&](std::initializer_list<double> shares) {
    return std::all_of(shares.begin(), shares.end(), [&](double share) {
      const Member one = member(at_share(share));
      return !one.is_like || project(one).is_certified;
    });
  };
  join_at({1.0, 0.345, 0.655});
  if (is_good_at({0.5, 0.12, 0.88})) return;
  join_at({0.095, 0.905});
  std::vector<std::pair<double, double>> open{
      {0.0, 0.095}, {0.095, 0.345}, {0.345, 0.655}, {0.655, 0.905}, {0.905, 1.0}};
  for (int level = 0; level < most_levels && !open.empty(); ++level) {
    std::vector<std::pair<double, double>> next;
    std::vector<double> poor;
    for (const auto& [low, high] : open) {
      const double between = 0.5 * (low + high);
      if (is_good_at({between})) continue;
      poor.push_back(between);
      next.emplace_back(low, between);
      next.emplace_back(between, high);
    }
    for (const double share : poor) join_at({share});
    open = std::move(next);
  }
}

CountedSpectra::Member CountedSpectra::member(double value) {
  Member one{systems_.at(value)};
  if (!basis_ || one.system->size() != size_) return one;
  one.is_like = true;
  if (!span_) return one;
  one.factors = span_->factors(*one.system);
  if (one.factors) return one;
  one.is_like = size_ <= most_direct;
  if (one.is_like) span_.reset();
  return one;
}

/// Adds a system to the basis. @returns whether it did
bool CountedSpectra::join(const Member& member) {
  constexpr std::size_t most_systems = 24;
  if (!member.is_like || basis_->num_systems() >= most_systems) return false;
  const Activity finding("eigenvectors of a value");
  ++effort_.num_refined;
  int factorisations = 0;
  basis_->add(
      pairs_near(*member.system, basis_->latest(), basis_->rectangle().height, factorisations));
  return true;
}

ProjectedSpectrum CountedSpectra::project(const Member& member,
                                          std::optional<std::complex<double>> place) {
  ++effort_.num_projected;
  if (!span_) return basis_->project(*member.system, place);
  return basis_->project(*span_, *member.factors, *member.system, place);
}

/// Eigenvalues in the rectangle, conjugates counted; nothing where they are not counted.
std::optional<int> CountedSpectra::count(const Member& member,
                                         const std::vector<std::complex<double>>& found) {
  if (!span_ || !member.factors) return std::nullopt;
  const Eigen::VectorXd& factors = *member.factors;
  if (factors.size() == 1) return num_first_;
  if (factors.size() != 2 || !count_) return std::nullopt;
  std::vector<std::complex<double>> known = found;
  known.insert(known.end(), above_.begin(), above_.end());
  return count_->count(factors(1), basis_->rectangle(), known);
}

/// By projection; nothing where an eigenvalue has a large residual, or may be missing.
std::optional<SampledSpectrum> CountedSpectra::counted(const Member& member) {
  const ProjectedSpectrum spectrum = project(member);
  if (!spectrum.is_certified) return std::nullopt;
  int num_found = 0;
  int num_vibrating = 0;
  for (const std::complex<double>& s : spectrum.eigenvalues) {
    num_found += s.imag() > 0.0 ? 2 : 1;
    num_vibrating += s.imag() > 0.0 ? 1 : 0;
  }
  if (window_.count && num_vibrating < *window_.count) return std::nullopt;
  const std::optional<int> number = count(member, spectrum.eigenvalues);
  if (number && *number != num_found) return std::nullopt;
  SampledSpectrum found = sampled(spectrum.eigenvalues);
  found.is_counted = number.has_value();
  return found;
}

SampledSpectrum CountedSpectra::at(double value) {
  const auto known = searched_.find(value);
  if (known != searched_.end()) return known->second;
  if (const auto found = follow(value)) return *found;
  if (!has_begun_) begin();
  if (const auto begun = searched_.find(value); begun != searched_.end()) return begun->second;
  const Member one = member(value);
  if (!one.is_like || value < range_->first || value > range_->second)
    return search(value, *one.system);
  const bool is_first = one.factors && one.factors->size() == 1;  // the same system
  if (is_first) return searched_.at(range_->first);
  if (const auto found = counted(one)) return *found;
  bool has_joined = false;
  try {
    has_joined = join(one);
  } catch (const NumericalError&) {  // the whole search says what is wrong
  }
  if (has_joined) {
    if (const auto found = counted(one)) return *found;
    basis_->drop_latest();
  }
  return search(value, *one.system);
}

SampledSpectrum CountedSpectra::near(double value) {
  if (const auto found = follow(value)) return *found;
  if (!has_begun_) begin();
  const Member one = member(value);
  if (one.is_like) {
    const ProjectedSpectrum spectrum = project(one);
    if (spectrum.is_certified) return sampled(spectrum.eigenvalues);
  }
  return at(value);
}

SampledSpectrum CountedSpectra::around(double value, std::complex<double> place) {
  if (const auto found = follow(value)) return *found;
  if (!has_begun_) begin();
  const Member one = member(value);
  if (one.is_like) {
    const ProjectedSpectrum spectrum = project(one, place);
    if (spectrum.is_certified && !spectrum.eigenvalues.empty())
      return sampled(spectrum.eigenvalues);
  }
  return at(value);
}

SpectrumFamily counted_spectra(CountedSpectra::System system, const SpectrumWindow& window,
                               std::optional<std::pair<double, double>> range) {
  const auto spectra =
      std::make_shared<CountedSpectra>(std::move(system), window, std::move(range));
  return {
      [spectra](double value) { return spectra->at(value); },
      [spectra](double value) { return spectra->near(value); },
      [spectra](double value, std::complex<double> place) { return spectra->around(value, place); }};
}

}  // namespace stridor
