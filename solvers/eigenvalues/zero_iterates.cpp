#include "solvers/eigenvalues/zero_iterates.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/eigenvalues/secular_kernel.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

}  // namespace

ZeroIterates::ZeroIterates(const std::vector<Complex>& upper, const std::vector<Complex>& alone)
    : num_upper_(upper.size()),
      size_(2 * upper.size() + alone.size()),
      re_((size_ + secular_block - 1) / secular_block * secular_block),
      im_(re_.size()) {
  constexpr double far = 1e100;
  std::fill_n(re_.data(), re_.size(), far);
  for (std::size_t j = 0; j < upper.size(); ++j) set(j, upper[j]);
  for (std::size_t j = 0; j < alone.size(); ++j) set(num_upper_ + j, alone[j]);
}

void ZeroIterates::set(std::size_t free, Complex value) {
  const std::size_t j = index(free);
  re_[j] = value.real();
  im_[j] = value.imag();
  if (free >= num_upper_) return;
  re_[num_upper_ + j] = value.real();
  im_[num_upper_ + j] = -value.imag();
}

std::vector<Complex> ZeroIterates::all() const {
  std::vector<Complex> values(size_);
  for (std::size_t j = 0; j < size_; ++j) values[j] = {re_[j], im_[j]};
  return values;
}

ZeroIterates::Surroundings ZeroIterates::around(std::size_t free) const {
  const std::size_t j = index(free);
  const Repulsion sum = sum_repulsion(re_.data(), im_.data(), re_.size(), re_[j], im_[j]);
  return {{sum.re, sum.im}, std::sqrt(sum.least)};
}

}  // namespace stridor
