// Spectra of large sparse systems along a parameter, counted so that none is missed.
#pragma once

#include <complex>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/followed_spectra.hpp"
#include "analysis/spectrum_sampler.hpp"
#include "solvers/eigenvalues/count_along.hpp"
#include "solvers/eigenvalues/pair_basis.hpp"
#include "solvers/eigenvalues/sparse_spectrum.hpp"

namespace stridor {

/// All eigenvalues of sparse_spectrum() in a window. A count within a frequency is taken from all
/// below it.
/// @throws NumericalError unless every one was found; as sparse_spectrum()
SparseSpectrum whole_spectrum(const SparseSystem& system, SpectrumWindow window,
                              const SpectrumWork& work = {});

/// Work done for spectra along a parameter.
struct CountedEffort {
  int num_searched = 0;   ///< values of sparse systems with a whole search
  int num_refined = 0;    ///< values whose pairs were found from those of others
  int num_projected = 0;  ///< spectra by projection
  int num_followed = 0;   ///< spectra of full systems from those close by
  int num_searched_full = 0;  ///< full systems by the dense method
};

/// Systems along a parameter, the latest of them kept: windows are looked at in turn, many of them
/// at the same values, and an equilibrium may stand behind every system.
class KeptSystems {
 public:
  using System = std::function<SparseSystem(double value)>;
  /// @param most_bytes that those kept may take; what was asked for longest ago goes first
  KeptSystems(System system, double most_bytes)
      : system_(std::move(system)), most_bytes_(most_bytes) {}

  std::shared_ptr<const SparseSystem> at(double value);
  int num_made() const { return num_made_; }

 private:
  struct Kept {
    double value;
    std::shared_ptr<const SparseSystem> system;
    double bytes;
  };

  System system_;
  double most_bytes_;
  std::list<Kept> kept_;  ///< the latest first
  double bytes_ = 0.0;
  int num_made_ = 0;
};

/// Spectra of large matrices along a parameter, for sample_locus().
///
/// The first value of the range takes a whole search. From its vectors those of the last one
/// follow, of the middle, and of the middles between them until the projection on all of them
/// (PairBasis) is good at the next middles. Every eigenvalue of a projection has its residual at
/// full size; where one fails, the value joins the basis, and where that does not help or a count
/// differs, the value takes a whole search. Where the parameter enters as one factor, CountAlong
/// counts at every value; else a spectrum says that it was not counted. What near() and around()
/// find is certified, not counted.
///
/// Where the parameter enters as more functions than a SystemSpan holds, up to 20,000 unknowns are
/// projected all the same, every system by products of its own. Full matrices are followed
/// (FollowedSpectra).
class CountedSpectra {
 public:
  using System = KeptSystems::System;
  /// @param window of the eigenvalues wanted
  /// @param range  of the parameter; where there is none, every value takes a whole search
  CountedSpectra(System system, const SpectrumWindow& window,
                 std::optional<std::pair<double, double>> range = std::nullopt);

  // As the members of SpectrumFamily. They throw as whole_spectrum().
  SampledSpectrum at(double value);
  SampledSpectrum near(double value);
  SampledSpectrum around(double value, std::complex<double> place);

  const CountedEffort& effort() const { return effort_; }

 private:
  struct Member {
    std::shared_ptr<const SparseSystem> system;
    bool is_like = false;  ///< whether the basis, where there is one, is for it
    std::optional<Eigen::VectorXd> factors = std::nullopt;  ///< in the span, where it is in one
  };

  void begin();
  void make_basis();
  SparseSpectrum search_first(const SparseSystem& first);
  void extend();
  Member member(double value);
  bool join(const Member& member);
  ProjectedSpectrum project(const Member& member,
                            std::optional<std::complex<double>> place = std::nullopt);
  std::optional<SampledSpectrum> counted(const Member& member);
  std::optional<int> count(const Member& member, const std::vector<std::complex<double>>& found);
  std::optional<SampledSpectrum> follow(double value);
  SampledSpectrum search(double value, const SparseSystem& system);

  KeptSystems systems_;
  SpectrumWindow window_;
  std::optional<std::pair<double, double>> range_;
  bool has_begun_ = false;
  std::map<double, SampledSpectrum> searched_;
  std::optional<SystemSpan> span_;  ///< none where every system is projected by itself
  std::optional<PairBasis> basis_;
  FollowedSpectra followed_;  ///< of the systems that are full
  std::optional<CountAlong> count_;
  Eigen::Index size_ = 0;  ///< of the systems that the basis is for
  int num_first_ = 0;  ///< eigenvalues in the rectangle at the first value, conjugates counted
  std::vector<std::complex<double>> above_;  ///< about those above the rectangle
  CountedEffort effort_;
};

/// The members of CountedSpectra as a family, which keeps it.
SpectrumFamily counted_spectra(CountedSpectra::System system, const SpectrumWindow& window,
                               std::optional<std::pair<double, double>> range = std::nullopt);

}  // namespace stridor
