#include "analysis/counted_spectra.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/sampled_locus.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/full_spectrum.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"
#include "tests/support/elastic_pads.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// The disc with elastic pads, 316 unknowns, over its friction.
SparseSystem pads_with(double friction) {
  test::ElasticPads pads;
  pads.along = 6;
  pads.through = 2;
  pads.nodal_diameters = 4;
  pads.friction = friction;
  return pads.system();
}

std::vector<Complex> dense_eigenvalues_below(const SparseSystem& sparse, double frequency) {
  const Eigen::Index n = sparse.size();
  const LinearSystem system{Eigen::MatrixXd(sparse.mass), Eigen::MatrixXd(sparse.velocity),
                            Eigen::MatrixXd(sparse.position), Eigen::MatrixXd(0, n),
                            Eigen::MatrixXd(0, n)};
  const SpectrumRectangle rectangle{2.0 * std::numbers::pi * frequency};
  std::vector<Complex> found;
  for (const Eigenvalue& one : dense_eigenvalues(make_pencil(system), DenseWork::eigenvalues))
    if (rectangle.contains(one.s)) found.push_back(one.s);
  return found;
}

/// Every eigenvalue of either list is close to one of the other.
void expect_equal(const std::vector<Complex>& found, const std::vector<Complex>& expected,
                  double tolerance, double value) {
  EXPECT_EQ(found.size(), expected.size()) << value;
  for (const Complex& s : expected) {
    const bool is_found = std::any_of(found.begin(), found.end(), [&](const Complex& other) {
      return std::abs(other - s) <= tolerance;
    });
    EXPECT_TRUE(is_found) << s << " at " << value;
  }
}

TEST(KeptSystems, AreMadeOnceUntilTheyTakeTooMuchMemory) {
  const auto make = [](double value) {
    SparseMatrix one(1, 1);
    one.insert(0, 0) = value;
    return SparseSystem{one, one, one};
  };
  constexpr double bytes_of_one = 3 * (sizeof(double) + sizeof(int));
  KeptSystems systems(make, 2.5 * bytes_of_one);
  for (const double value : {1.0, 2.0, 1.0, 2.0})
    EXPECT_EQ(systems.at(value)->mass.coeff(0, 0), value);
  EXPECT_EQ(systems.num_made(), 2);
  systems.at(1.0);
  const std::shared_ptr<const SparseSystem> third = systems.at(3.0);  // 2 was asked for before 1
  systems.at(1.0);
  EXPECT_EQ(systems.num_made(), 3);
  systems.at(2.0);
  EXPECT_EQ(systems.num_made(), 4);
  EXPECT_EQ(third->mass.coeff(0, 0), 3.0);

  KeptSystems none(make, 0.0);
  EXPECT_EQ(none.at(5.0)->mass.coeff(0, 0), 5.0);
  none.at(5.0);
  EXPECT_EQ(none.num_made(), 2);
}

TEST(CountedSpectra, EveryEigenvalueAlongAParameterIsThatOfTheDenseProblem) {
  constexpr double frequency = 8000.0;
  CountedSpectra spectra(pads_with, SpectrumWindow::below(frequency), std::pair(0.0, 0.6));
  for (int i = 0; i <= 24; ++i) {
    const double value = 0.6 * i / 24.0;
    const SampledSpectrum found = spectra.at(value);
    EXPECT_TRUE(found.is_counted) << value;
    // The dense method has an absolute error of the highest frequency, 3e7 rad/s, times rounding.
    expect_equal(found.eigenvalues, dense_eigenvalues_below(pads_with(value), frequency), 1e-4,
                 value);
  }
  EXPECT_EQ(spectra.effort().num_searched, 1);
  EXPECT_LE(spectra.effort().num_refined, 12);
}

/// Two chains of many masses side by side with springs between them at a few places, and friction there that
/// pushes one chain by what compresses the springs.
SparseSystem rubbing_chains(double friction) {
  constexpr int n = 2000;
  std::vector<Eigen::Triplet<double>> entries;
  for (int chain = 0; chain < 2; ++chain) {
    for (int i = 0; i < n; ++i) {
      const int dof = 2 * i + chain;
      entries.emplace_back(dof, dof, chain == 0 ? 2.0 : 2.1);
      if (i + 1 == n) continue;
      entries.emplace_back(dof, dof + 2, chain == 0 ? -1.0 : -1.05);
      entries.emplace_back(dof + 2, dof, chain == 0 ? -1.0 : -1.05);
    }
  }
  for (const int i : {301, 700, 702, 1333}) {
    constexpr double stiffness = 0.7;
    const int x = 2 * i, y = 2 * i + 1;
    entries.emplace_back(y, y, stiffness);
    entries.emplace_back(x, y, friction * stiffness);
  }
  SparseSystem system;
  for (SparseMatrix* matrix : {&system.mass, &system.velocity, &system.position})
    matrix->resize(2 * n, 2 * n);
  system.mass.setIdentity();
  system.velocity.setIdentity();
  system.velocity *= 1e-6;
  system.position.setFromTriplets(entries.begin(), entries.end());
  return system;
}

TEST(CountedSpectra, FineMeshesNeedNoMoreSearchesThanCoarseOnes) {
  // The stiffest motions are a million times as stiff as the slowest here: what is rough in a vector by a part
  // of 1e-10 has a residual of 1e-4.
  const SpectrumWindow window = SpectrumWindow::below(0.03 / (2.0 * std::numbers::pi));
  CountedSpectra spectra(rubbing_chains, window, std::pair(0.0, 0.6));
  for (int i = 0; i <= 12; ++i) {
    const double value = 0.05 * i;
    const SampledSpectrum found = spectra.at(value);
    EXPECT_TRUE(found.is_counted) << value;
    if (i % 4 != 1) continue;
    const SparseSpectrum whole = whole_spectrum(rubbing_chains(value), window);
    std::vector<Complex> expected;
    for (const Eigenvalue& one : whole.eigenvalues) expected.push_back(one.s);
    ASSERT_GT(expected.size(), 15U);
    expect_equal(found.eigenvalues, expected, 1e-9, value);
  }
  // One more value than the first may be searched whole, where two eigenvalues all but meet.
  EXPECT_LE(spectra.effort().num_searched, 2);
  EXPECT_LE(spectra.effort().num_refined, 3);
}

TEST(CountedSpectra, AModeThatEntersTheWindowBetweenValuesOfTheBasisIsFound) {
  // A spring on the first mass of a chain lifts or lowers all of its frequencies: the window ends
  // where the 10th passes at a stiffness within the range.
  constexpr int n = 400;
  const auto chain = [](double stiffness) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < n; ++i) {
      entries.emplace_back(i, i, 2.0);
      if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
      if (i + 1 < n) entries.emplace_back(i + 1, i, -1.0);
    }
    entries.emplace_back(n / 2, n / 2, stiffness);
    SparseSystem system;
    for (SparseMatrix* matrix : {&system.mass, &system.velocity, &system.position})
      matrix->resize(n, n);
    system.mass.setIdentity();
    system.velocity.setIdentity();
    system.velocity *= 1e-5;
    system.position.setFromTriplets(entries.begin(), entries.end());
    return system;
  };
  const auto tenth = [&](double stiffness) {
    const SparseSpectrum all = sparse_spectrum(chain(stiffness), SpectrumWindow::lowest(12));
    return all.eigenvalues[9].s.imag();
  };
  // Its own frequency at 0.0008, which no value of the basis is.
  const double height = tenth(0.0008);
  const SpectrumWindow window =
      SpectrumWindow::below(height * (1.0 + 1e-7) / (2.0 * std::numbers::pi));
  CountedSpectra spectra(chain, window, std::pair(0.0, 0.004));
  std::vector<std::size_t> numbers;
  for (int i = 0; i <= 20; ++i) {
    const double value = 0.0002 * i;
    const SampledSpectrum found = spectra.at(value);
    EXPECT_TRUE(found.is_counted);
    const SparseSpectrum whole = whole_spectrum(chain(value), window);
    std::vector<Complex> expected;
    for (const Eigenvalue& one : whole.eigenvalues) expected.push_back(one.s);
    expect_equal(found.eigenvalues, expected, 1e-9 * height, value);
    numbers.push_back(found.eigenvalues.size());
  }
  EXPECT_EQ(numbers.front(), 10U);
  EXPECT_EQ(numbers.back(), 9U);
  EXPECT_LE(spectra.effort().num_searched, 3);
}

TEST(CountedSpectra, ANearlyDefectivePairIsFoundOnBothSidesOfItsFlutter) {
  // Two oscillators that circulatory forces couple among many that they leave alone: undamped, their
  // squares are ω² ± sqrt(δ² − p²).
  constexpr int n = 300;
  static constexpr double first = 4.0, delta = 1e-3;
  const auto system_of = [](double p) {
    SparseSystem system;
    for (SparseMatrix* matrix : {&system.mass, &system.velocity, &system.position})
      matrix->resize(n, n);
    system.mass.setIdentity();
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, i < 2 ? first : 1.0 + 2.0 * i);
    entries.emplace_back(0, 0, delta);
    entries.emplace_back(1, 1, -delta);
    entries.emplace_back(0, 1, p);
    entries.emplace_back(1, 0, -p);
    system.position.setFromTriplets(entries.begin(), entries.end());
    return system;
  };
  CountedSpectra spectra(system_of, SpectrumWindow::below(1.0), std::pair(0.0, 2e-3));
  for (int i = 0; i <= 40; ++i) {
    const double p = 5e-5 * i;
    const SampledSpectrum found = spectra.at(p);
    for (const double sign : {1.0, -1.0}) {
      const Complex square = -(first + sign * std::sqrt(Complex(delta * delta - p * p)));
      Complex s = std::sqrt(square);
      if (s.imag() < 0.0) s = -s;
      const bool is_found =
          std::any_of(found.eigenvalues.begin(), found.eigenvalues.end(), [&](const Complex& one) {
            // Where both coincide they move with the square root of rounding.
            return std::abs(one - s) < (std::abs(p - delta) < 1e-9 ? 1e-6 : 1e-10);
          });
      EXPECT_TRUE(is_found) << p << ' ' << s;
    }
  }
}

TEST(PairBasis, ResidualsTellThatABasisIsTooPoor) {
  const SpectrumWork work{SpectrumWork::Sides::both, nullptr};
  SparseSpectrum first = sparse_spectrum(pads_with(0.0), SpectrumWindow::below(8000.0), work);
  SystemSpan span(pads_with(0.0));
  (void)span.factors(pads_with(0.6));
  PairBasis basis(first.rectangle.height);
  const std::size_t num = first.eigenvalues.size();
  basis.add(std::move(first.pairs));
  const auto at = [&](double friction) {
    const SparseSystem system = pads_with(friction);
    return basis.project(span, *span.factors(system), system);
  };
  EXPECT_TRUE(at(0.0).is_certified);
  EXPECT_EQ(at(0.0).eigenvalues.size(), num);
  EXPECT_FALSE(at(0.3).is_certified);
  EXPECT_FALSE(at(0.6).is_certified);
  int factorisations = 0;
  basis.add(pairs_near(pads_with(0.6), basis.latest(), basis.rectangle().height, factorisations));
  EXPECT_TRUE(at(0.6).is_certified);
  EXPECT_LT(at(0.6).largest_residual, 1e-6);
  EXPECT_FALSE(at(0.3).is_certified);
}

TEST(SystemSpan, FindsTheFactorsOfItsParts) {
  SystemSpan span(pads_with(0.1));
  EXPECT_EQ(span.factors(pads_with(0.1))->size(), 1);
  EXPECT_EQ((*span.factors(pads_with(0.3)))(1), 1.0);
  EXPECT_NEAR((*span.factors(pads_with(0.2)))(1), 0.5, 1e-9);
  EXPECT_EQ(span.num_parts(), 2U);
  SparseSystem other = pads_with(0.2);
  other.velocity *= 2.0;
  EXPECT_EQ(span.factors(other)->size(), 3);
}

TEST(CountAlong, CountsEverySystemOfALine) {
  SystemSpan span(pads_with(0.0));
  (void)span.factors(pads_with(0.6));
  CountAlong along(pads_with(0.0), span.part(1), 1.0);
  for (const double friction : {0.1, 0.35, 0.6}) {
    const SparseSpectrum whole =
        sparse_spectrum(pads_with(friction), SpectrumWindow::below(8000.0));
    std::vector<Complex> known;
    for (const Eigenvalue& one : whole.eigenvalues) known.push_back(one.s);
    known.pop_back();  // a count does not rest on what is known
    EXPECT_EQ(along.count(friction / 0.6, whole.rectangle, known), whole.num_counted) << friction;
  }
  EXPECT_FALSE(along.count(1.1, SpectrumRectangle{5e4}, {}));
}

TEST(CountedSpectra, WhereAParameterEntersAsSeveralFunctionsNothingIsSaidToBeCounted) {
  const auto system_of = [](double value) {
    SparseSystem system = pads_with(value);
    system.velocity *= 1.0 + value * value;
    return system;
  };
  LocusOptions options;
  options.window.frequency = 8000.0;
  options.window.count = 100;
  const SpectrumFamily family = counted_spectra(
      system_of, SpectrumWindow::below(8000.0), std::pair(0.0, 0.2));
  const SampledSpectrum first = family.at(0.0);
  EXPECT_TRUE(first.is_counted);
  const SampledSpectrum between = family.at(0.1234);
  expect_equal(between.eigenvalues, dense_eigenvalues_below(system_of(0.1234), 8000.0), 1e-4,
               0.1234);
  EXPECT_FALSE(between.is_counted);
}

/// pads_with(), every eighth of whose unknowns has a stiffness of its own function of the value.
SparseSystem pads_of_many_functions(double value) {
  SparseSystem system = pads_with(value);
  Eigen::VectorXd root = Eigen::VectorXd::Ones(system.size());
  for (Eigen::Index i = 0; i < root.size(); ++i)
    root(i) += 0.01 * std::sin(3.0 * static_cast<double>(i % 8 + 1) * value);
  system.position = SparseMatrix(root.asDiagonal() * system.position * root.asDiagonal());
  return system;
}

TEST(CountedSpectra, AParameterMayEnterAsMoreFunctionsThanASpanHolds) {
  constexpr double frequency = 8000.0;
  SystemSpan span(pads_of_many_functions(0.0));
  bool is_in_span = true;
  for (int i = 1; i <= 8 && is_in_span; ++i)
    is_in_span = span.factors(pads_of_many_functions(0.06 * i)).has_value();
  ASSERT_FALSE(is_in_span);

  CountedSpectra spectra(pads_of_many_functions, SpectrumWindow::below(frequency),
                         std::pair(0.0, 0.6));
  for (int i = 0; i <= 12; ++i) {
    const double value = 0.6 * i / 12.0;
    const SampledSpectrum found = spectra.at(value);
    EXPECT_EQ(found.is_counted, i == 0) << value;
    expect_equal(found.eigenvalues,
                 dense_eigenvalues_below(pads_of_many_functions(value), frequency), 1e-4, value);
  }
  EXPECT_EQ(spectra.effort().num_searched, 1);
}

Pencil pencil_of(const SparseSystem& sparse) {
  const Eigen::MatrixXd none(0, sparse.size());
  return make_pencil({Eigen::MatrixXd(sparse.mass), Eigen::MatrixXd(sparse.velocity),
                      Eigen::MatrixXd(sparse.position), none, none});
}

/// pads_with() in the modes that it has without friction.
SparseSystem pads_in_modes(double friction) {
  static const Eigen::MatrixXd modes = pencil_of(pads_with(0.0)).ports;
  SparseSystem system = pads_with(friction);
  for (SparseMatrix* matrix : {&system.velocity, &system.position})
    *matrix = (modes.transpose() * (*matrix * modes)).eval().sparseView(1.0, 0.0);
  system.mass.setIdentity();
  return system;
}

/// pads_with() in modes of its own.
SparseSystem pads_in_own_modes(double friction) {
  return modal_system(pencil_of(pads_with(friction)));
}

TEST(FullSpectrum, IsThatOfTheDenseProblemWithPairs) {
  constexpr double frequency = 8000.0;
  const SparseSystem system = pads_in_own_modes(0.3);
  ASSERT_TRUE(is_full(system));
  EXPECT_FALSE(is_full(pads_with(0.3)));
  const SparseSpectrum spectrum = full_spectrum(system, SpectrumWindow::below(frequency));
  std::vector<Complex> found;
  for (const Eigenvalue& one : spectrum.eigenvalues) found.push_back(one.s);
  expect_equal(found, dense_eigenvalues_below(pads_with(0.3), frequency), 1e-4, 0.3);
  const TwoSidedPairs& pairs = spectrum.pairs;
  EXPECT_GE(pairs.s.size(), found.size());
  const Eigen::MatrixXd velocity = system.velocity, position = system.position;
  for (Eigen::Index i = 0; i < pairs.size(); ++i) {
    const Complex s = pairs.s[static_cast<std::size_t>(i)];
    Eigen::MatrixXcd P = s * velocity.cast<Complex>() + position.cast<Complex>();
    P.diagonal().array() += s * s;
    EXPECT_LT((P * pairs.right.col(i)).norm(), 1e-6 * std::norm(s)) << s;
  }
  // A count ends in the gap above the last one wanted.
  const SparseSpectrum lowest = full_spectrum(system, SpectrumWindow::lowest(7));
  EXPECT_EQ(std::count_if(lowest.eigenvalues.begin(), lowest.eigenvalues.end(),
                          [](const Eigenvalue& one) { return one.s.imag() > 0.0; }),
            7);
  Pencil constrained = make_pencil({Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Zero(2, 2),
                                    Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Ones(1, 2),
                                    Eigen::MatrixXd::Ones(1, 2)});
  EXPECT_THROW((void)modal_system(constrained), std::invalid_argument);
}

TEST(CountedSpectra, CoordinatesThatChangeWithTheValueAreNoticed) {
  constexpr double frequency = 8000.0;
  CountedSpectra spectra(pads_in_own_modes, SpectrumWindow::below(frequency), std::pair(0.0, 0.6));
  for (const double value : {0.0, 0.1, 0.45})
    expect_equal(spectra.at(value).eigenvalues,
                 dense_eigenvalues_below(pads_with(value), frequency), 1e-4, value);
}

TEST(CountedSpectra, FullMatricesAreFollowedAfterOneDenseProblem) {
  constexpr double frequency = 8000.0;
  for (const bool is_by_count : {false, true}) {
    const SpectrumWindow window =
        is_by_count ? SpectrumWindow::lowest(12) : SpectrumWindow::below(frequency);
    CountedSpectra spectra(pads_in_modes, window, std::pair(0.0, 0.6));
    for (const double value : {0.0, 0.1, 0.2, 0.37, 0.5, 0.6}) {
      const SampledSpectrum found = spectra.at(value);
      // Two of the twelve are above 8 kHz.
      const std::vector<Complex> all =
          dense_eigenvalues_below(pads_with(value), is_by_count ? 2.0 * frequency : frequency);
      if (!is_by_count) {
        expect_equal(found.eigenvalues, all, 1e-4, value);
        continue;
      }
      EXPECT_GE(found.eigenvalues.size(), 12u);
      for (const Complex& s : found.eigenvalues) {
        const bool is_known = std::any_of(all.begin(), all.end(), [&](const Complex& other) {
          return std::abs(other - s) <= 1e-4;
        });
        EXPECT_TRUE(is_known) << s << " at " << value;
      }
    }
    EXPECT_EQ(spectra.effort().num_searched_full, 1);
    EXPECT_EQ(spectra.effort().num_searched, 0);
  }
}

}  // namespace
}  // namespace stridor
