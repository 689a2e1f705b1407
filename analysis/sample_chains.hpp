// Eigenvalues of samples along a parameter, connected to curves.
#pragma once

#include <algorithm>
#include <complex>
#include <cstddef>
#include <vector>

#include "analysis/spectrum_sampler.hpp"

namespace stridor {

/// Eigenvalues connected from sample to sample.
class SampleChains {
 public:
  explicit SampleChains(const std::vector<Sample>& samples) : samples_(samples) { connect(); }

  std::size_t size() const { return num_chains_; }
  /// Index of a chain's eigenvalue in a sample; −1 where it is not there.
  int index(std::size_t sample, std::size_t chain) const {
    const std::vector<int>& row = index_[sample];
    return chain < row.size() ? row[chain] : -1;
  }
  bool has(std::ptrdiff_t sample, std::size_t chain) const {
    return sample >= 0 && sample < static_cast<std::ptrdiff_t>(samples_.size()) &&
           index(static_cast<std::size_t>(sample), chain) >= 0;
  }
  std::complex<double> s(std::size_t sample, std::size_t chain) const {
    return samples_[sample].eigenvalues[static_cast<std::size_t>(index(sample, chain))];
  }
  double excess(std::size_t sample, std::size_t chain) const {
    return samples_[sample].excess[static_cast<std::size_t>(index(sample, chain))];
  }
  double width(std::size_t interval) const {
    return samples_[interval + 1].value - samples_[interval].value;
  }

  /// Expected position of a chain after an interval, by its last two samples.
  std::complex<double> expected(std::size_t interval, std::size_t chain) const {
    const std::complex<double> here = s(interval, chain);
    if (interval == 0 || !has(static_cast<std::ptrdiff_t>(interval) - 1, chain)) return here;
    // Beside a branch point slopes are steep; they lead no farther than they were seen.
    const double ratio = std::min(width(interval) / width(interval - 1), 2.0);
    const std::complex<double> there = here + ratio * (here - s(interval - 1, chain));
    return {there.real(), std::abs(there.imag())};
  }

 private:
  void connect() {
    index_.assign(samples_.size(), {});
    num_chains_ = samples_.front().eigenvalues.size();
    for (std::size_t j = 0; j < num_chains_; ++j) index_[0].push_back(static_cast<int>(j));
    for (std::size_t i = 0; i + 1 < samples_.size(); ++i) {
      std::vector<std::size_t> chains;
      std::vector<std::complex<double>> places;
      for (std::size_t b = 0; b < num_chains_; ++b) {
        if (index(i, b) < 0) continue;
        chains.push_back(b);
        places.push_back(expected(i, b));
      }
      const std::vector<std::complex<double>>& found = samples_[i + 1].eigenvalues;
      const std::vector<int> partner = continuations(places, found);
      index_[i + 1].assign(num_chains_, -1);
      std::vector<bool> is_taken(found.size(), false);
      for (std::size_t j = 0; j < chains.size(); ++j) {
        if (partner[j] < 0) continue;
        index_[i + 1][chains[j]] = partner[j];
        is_taken[static_cast<std::size_t>(partner[j])] = true;
      }
      for (std::size_t k = 0; k < found.size(); ++k) {
        if (is_taken[k]) continue;
        index_[i + 1].push_back(static_cast<int>(k));
        ++num_chains_;
      }
    }
  }

  const std::vector<Sample>& samples_;
  std::size_t num_chains_ = 0;
  std::vector<std::vector<int>> index_;  ///< of every sample
};

enum class Outcome { resolved, halve };

}  // namespace stridor
