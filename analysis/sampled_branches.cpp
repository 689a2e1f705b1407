#include "analysis/sampled_branches.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>

#include "analysis/sample_chains.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// How far a branch is from a place in the complex plane at a value; infinitely where it has ended.
double distance_at(const Branch& branch, double value, Complex place) {
  const std::vector<double>& values = branch.values;
  if (value < values.front() || value > values.back())
    return std::numeric_limits<double>::infinity();
  const auto upper = std::upper_bound(values.begin(), values.end(), value);
  if (upper == values.end()) return std::abs(branch.s.back() - place);
  const auto i = static_cast<std::size_t>(upper - values.begin());
  const double share = (value - values[i - 1]) / (values[i] - values[i - 1]);
  return std::abs((1.0 - share) * branch.s[i - 1] + share * branch.s[i] - place);
}

/// The branch nearest to a place; −1 where none is there.
int nearest_branch(const std::vector<Branch>& branches, double value, Complex place) {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const double distance = distance_at(branches[b], value, place);
    if (distance >= least) continue;
    least = distance;
    nearest = static_cast<int>(b);
  }
  return nearest;
}

}  // namespace

void add_branches(const std::vector<Sample>& whole, Locus& locus) {
  const SampleChains chains(whole);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    Branch branch;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      if (chains.index(i, c) < 0) continue;
      branch.values.push_back(whole[i].value);
      branch.s.push_back(chains.s(i, c));
    }
    locus.branches.push_back(std::move(branch));
  }
  const auto place = [](double growth, double frequency) {
    return Complex(growth, 2.0 * std::numbers::pi * frequency);
  };
  for (UnstableWindow& window : locus.unstable)
    window.branch = nearest_branch(locus.branches, window.value_max,
                                   place(window.growth_max, window.frequency));
  for (Crossing& crossing : locus.crossings)
    crossing.branch =
        nearest_branch(locus.branches, crossing.value, place(0.0, crossing.frequency));
}

}  // namespace stridor
