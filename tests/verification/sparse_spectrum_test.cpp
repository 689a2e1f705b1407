// Thousands of unknowns, two methods.
#include "solvers/eigenvalues/sparse_spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/elastic_pads.hpp"
#include "tests/support/shift_invert.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

TEST(SparseSpectrum, DiscWithElasticPadsAgreesWithArnoldi) {
  const SparseSystem system = test::ElasticPads().system();
  ASSERT_GT(system.size(), 4000);
  ASSERT_LT(system.size(), 5000);
  constexpr double frequency = 8000.0;
  const SparseSpectrum found = sparse_spectrum(system, SpectrumWindow::below(frequency));
  ASSERT_TRUE(found.is_complete);
  for (const double error : found.backward_errors) EXPECT_LT(error, 1e-8);
  EXPECT_TRUE(std::any_of(found.eigenvalues.begin(), found.eigenvalues.end(),
                          [](const Eigenvalue& one) { return one.growth() > 100.0; }));

  // Two shifts whose discs cover the window; everything next to them is found and finds.
  constexpr double omega = 2.0 * std::numbers::pi * frequency;
  std::vector<Complex> other;
  for (const Complex shift : {Complex(100.0, 0.25 * omega), Complex(100.0, 0.75 * omega)}) {
    for (const Complex& s : test::eigenvalues_next_to(system, shift, 160)) {
      const bool is_new = std::none_of(other.begin(), other.end(), [&](const Complex& known) {
        return std::abs(known - s) < 1e-6 * std::abs(s);
      });
      if (is_new && s.imag() > 0.0 && found.rectangle.contains(s)) other.push_back(s);
    }
  }
  ASSERT_EQ(other.size(), found.eigenvalues.size());
  for (const Eigenvalue& one : found.eigenvalues) {
    EXPECT_TRUE(std::any_of(other.begin(), other.end(), [&](const Complex& s) {
      return std::abs(s - one.s) < 1e-8 * std::abs(s);
    })) << one.frequency();
  }
}

}  // namespace
}  // namespace stridor
