#include "analysis/continuation.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/eigenvalues/eigenvector.hpp"

namespace stridor {

std::vector<int> continuations(SpectrumSource& source, const FormerSpectrum& former,
                               const std::vector<std::complex<double>>& after, double value) {
  using Complex = std::complex<double>;
  std::vector<int> partner(former.s.size(), -1);
  std::vector<bool> is_taken(after.size(), false);
  const auto nearest = [&](Complex s, const std::vector<Complex>& others) {
    return std::min_element(
               others.begin(), others.end(),
               [&](Complex a, Complex b) { return std::abs(a - s) < std::abs(b - s); }) -
           others.begin();
  };
  // Those that have hardly moved, in proportion to their distance to the others.
  for (std::size_t j = 0; j < former.s.size() && !after.empty(); ++j) {
    const auto k = static_cast<std::size_t>(nearest(former.s[j], after));
    const bool is_clear = std::abs(after[k] - former.s[j]) <= 0.1 * former.spacing[j];
    if (!is_clear || is_taken[k] || is_pair(former.s[j]) != is_pair(after[k])) continue;
    partner[j] = static_cast<int>(k);
    is_taken[k] = true;
  }
  struct Candidate {
    double assurance;
    std::size_t j, k;
  };
  std::vector<std::size_t> open_before;
  std::vector<std::size_t> open_after;
  for (std::size_t j = 0; j < former.s.size(); ++j)
    if (partner[j] < 0) open_before.push_back(j);
  for (std::size_t k = 0; k < after.size(); ++k)
    if (!is_taken[k]) open_after.push_back(k);
  if (open_before.empty() || open_after.empty()) return partner;

  std::vector<Eigen::VectorXcd> shapes_after;
  shapes_after.reserve(open_after.size());
  for (const std::size_t k : open_after) shapes_after.push_back(source.shape(after[k]));
  source.move_to(former.value);
  std::vector<Candidate> candidates;
  for (const std::size_t j : open_before) {
    const Eigen::VectorXcd shape = source.shape(former.s[j]);
    for (std::size_t i = 0; i < open_after.size(); ++i) {
      const Complex s = after[open_after[i]];
      // Only what is about as near as the nearest can be its continuation.
      if (std::abs(s - former.s[j]) > 0.1 * std::abs(former.s[j])) continue;
      candidates.push_back({modal_assurance(shape, shapes_after[i]), j, open_after[i]});
    }
  }
  source.move_to(value);
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.assurance > b.assurance; });
  for (const Candidate& candidate : candidates) {
    if (partner[candidate.j] >= 0 || is_taken[candidate.k]) continue;
    partner[candidate.j] = static_cast<int>(candidate.k);
    is_taken[candidate.k] = true;
  }
  return partner;
}

}  // namespace stridor
