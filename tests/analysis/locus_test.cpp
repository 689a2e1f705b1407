#include "analysis/locus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "solvers/eigenvalues/residual_modes.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/pencils.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Complex = std::complex<double>;

using test::two_pi;

std::vector<double> range(double from, double to, int number) {
  std::vector<double> values;
  for (int i = 0; i < number; ++i) values.push_back(from + (to - from) * i / (number - 1));
  return values;
}

/// Two masses with K = diag(1, 1.4), the same damping and a circulatory coupling p, the parameter.
PencilFamily flutter_family(double damping) {
  return {[damping](double p, Pencil& pencil) {
            pencil = test::two_masses({1.0, 1.4}, {damping, damping});
            pencil.port_stiffness = test::circulatory(p);
          },
          {}};
}

/// Two masses whose stiffnesses cross: K = diag(1, 1 + v), coupled by [[0, a], [b, 0]].
PencilFamily crossing_family(double a, double b, double damping = 0.0) {
  return {[=](double v, Pencil& pencil) {
            pencil = test::two_masses({1.0, 1.0 + v}, {damping, damping});
            pencil.port_stiffness = Eigen::Matrix2d{{0.0, a}, {b, 0.0}};
          },
          {}};
}

/// Branch of the eigenvalue that is nearest to s at the last value.
const Branch& branch_ending_at(const Locus& locus, Complex s) {
  return *std::min_element(locus.branches.begin(), locus.branches.end(),
                           [&](const Branch& a, const Branch& b) {
                             return std::abs(a.s.back() - s) < std::abs(b.s.back() - s);
                           });
}

TEST(Locus, FlutterBeginsWhereTwoUndampedFrequenciesMeet) {
  // s² = −1.2 ± √(0.04 − p²): both pairs meet at p = 0.2, s = j √1.2.
  for (const int number : {2, 3, 17, 301}) {
    const Locus locus = trace_locus(flutter_family(0.0), range(0.0, 0.3, number));
    ASSERT_THAT(locus.unstable, SizeIs(1)) << number;
    const UnstableWindow& window = locus.unstable[0];
    // The branches are connected anew over an interval of 1e-9 of the range.
    EXPECT_NEAR(window.from, 0.2, 3e-10);
    EXPECT_EQ(window.to, 0.3);
    EXPECT_EQ(window.value_max, 0.3);
    EXPECT_NEAR(window.growth_max, 0.1016256896, 1e-10);
    EXPECT_NEAR(window.frequency, std::sqrt(Complex(-1.2, std::sqrt(0.05))).imag() / two_pi, 1e-12);
    ASSERT_THAT(locus.crossings, SizeIs(1));
    EXPECT_EQ(locus.crossings[0].value, window.from);
    EXPECT_EQ(locus.crossings[0].direction, 1);
    EXPECT_NEAR(locus.crossings[0].frequency, std::sqrt(1.2) / two_pi, 1e-5);
    EXPECT_THAT(locus.branches, SizeIs(2));
    EXPECT_THAT(locus.unverified, IsEmpty());
  }
}

TEST(Locus, DampedFlutterCrossesTheAxisWhereItShould) {
  // Equal damping 0.1 shifts the threshold to p = 0.2280350850, an ordinary crossing.
  double integral = 0.0;
  for (const int number : {2, 5, 100}) {
    const Locus locus = trace_locus(flutter_family(0.1), range(0.0, 0.4, number));
    ASSERT_THAT(locus.unstable, SizeIs(1)) << number;
    EXPECT_NEAR(locus.unstable[0].from, 0.2280350850, 1e-10);
    if (integral == 0.0) {
      // s = −0.05 + √(z), z = −1.2 + 0.0025 + j √(p² − 0.04), by the midpoint rule.
      const double from = locus.unstable[0].from;
      constexpr int parts = 20000;
      for (int i = 0; i < parts; ++i) {
        const double p = from + (0.4 - from) * (i + 0.5) / parts;
        const Complex root = std::sqrt(Complex(-1.1975, std::sqrt(p * p - 0.04)));
        integral += (-0.05 + root.real()) * (0.4 - from) / parts;
      }
    }
    EXPECT_NEAR(locus.unstable[0].growth_integral, integral, 1e-7 * integral);
  }
}

/// A family of systems, each beside another one that is equal.
PencilFamily twice(const PencilFamily& family) {
  return {[place = family.place](double value, Pencil& pencil) {
            Pencil one;
            place(value, one);
            const auto both = [](const Eigen::MatrixXd& matrix) {
              Eigen::MatrixXd blocks = Eigen::MatrixXd::Zero(2 * matrix.rows(), 2 * matrix.cols());
              blocks.topLeftCorner(matrix.rows(), matrix.cols()) = matrix;
              blocks.bottomRightCorner(matrix.rows(), matrix.cols()) = matrix;
              return blocks;
            };
            pencil.omega = one.omega.replicate(2, 1);
            pencil.damping = one.damping.replicate(2, 1);
            pencil.ports = both(one.ports);
            pencil.compatibility = both(one.compatibility);
            pencil.equilibrium = both(one.equilibrium);
            pencil.port_stiffness = both(one.port_stiffness);
          },
          family.kinks};
}

TEST(Locus, EqualSystemsHaveEveryWindowTwice) {
  // Every eigenvalue is double at every value. Those of a search are known to the root of its
  // rounding then, which moves the threshold by that over the slope of the growth.
  for (const LocusMethod method : {LocusMethod::secular, LocusMethod::dense}) {
    LocusOptions options;
    options.method = method;
    const Locus locus = trace_locus(twice(flutter_family(0.1)), range(0.0, 0.4, 5), options);
    ASSERT_THAT(locus.unstable, SizeIs(2));
    for (const UnstableWindow& window : locus.unstable) {
      EXPECT_NEAR(window.from, 0.2280350850, 2e-7);
      EXPECT_EQ(window.to, 0.4);
      EXPECT_NEAR(window.growth_max, locus.unstable[0].growth_max, 1e-7);
    }
    EXPECT_THAT(locus.branches, SizeIs(4));
    EXPECT_THAT(locus.unverified, IsEmpty());
    for (const auto& eigenvalues : locus.eigenvalues) EXPECT_THAT(eigenvalues, SizeIs(4));
  }
  // Without friction, nothing grows: a double eigenvalue on the axis is not taken for one that
  // does.
  const Locus undamped = trace_locus(twice(flutter_family(0.0)), range(0.0, 0.19, 20));
  EXPECT_THAT(undamped.unstable, IsEmpty());
  EXPECT_LT(undamped.num_places, 300);
}

TEST(Locus, HoffmannsModelLosesStabilityAtThreeQuarters) {
  const PencilFamily family{
      [](double friction, Pencil& pencil) {
        pencil = test::two_masses({2.0, 2.0}, {0.0, 0.0});
        pencil.port_stiffness = Eigen::Matrix2d{{0.0, 1.0 - 4.0 * friction / 3.0}, {1.0, 0.0}};
      },
      {}};
  const Locus locus = trace_locus(family, range(0.0, 1.0, 4));
  ASSERT_THAT(locus.unstable, SizeIs(1));
  EXPECT_NEAR(locus.unstable[0].from, 0.75, 1e-9);
}

TEST(Locus, AWindowMuchNarrowerThanTheGridIsFound) {
  // s² = −1 − v/2 ± √(v²/4 − ε²): unstable for |v| < 2ε, largest growth ε/2 to first order. The
  // grid of three values has 64 intervals of 0.03.
  constexpr double coupling = 1e-5;
  for (const int number : {2, 3, 20}) {
    // Not symmetric, so that no value of the grid lies in the window.
    const Locus locus =
        trace_locus(crossing_family(coupling, -coupling), range(-0.83, 0.97, number));
    ASSERT_THAT(locus.unstable, SizeIs(1)) << number;
    // The resolution is 1.8e-9.
    EXPECT_NEAR(locus.unstable[0].from, -2.0 * coupling, 4e-9);
    EXPECT_NEAR(locus.unstable[0].to, 2.0 * coupling, 4e-9);
    EXPECT_NEAR(locus.unstable[0].growth_max, 0.5 * coupling, 1e-4 * coupling);
    // An ellipse of half axes 2ε and ε/2.
    EXPECT_NEAR(locus.unstable[0].growth_integral, 0.5 * std::numbers::pi * coupling * coupling,
                1e-4 * coupling * coupling);
  }
}

TEST(Locus, ADampedWindowThatTheGridMissesHasItsExactEnds) {
  // s = jω on the axis gives ω² = 1 + v/2 and c ω = √(ε² − v²/4), so that
  // v²/4 + c² v/2 + c² − ε² = 0.
  constexpr double coupling = 1e-3;
  constexpr double damping = 6e-4;
  const Locus locus =
      trace_locus(crossing_family(coupling, -coupling, damping), range(-0.83, 0.97, 2));
  const double square = damping * damping;
  const double root = std::sqrt(square * square + 4.0 * (coupling * coupling - square));
  ASSERT_THAT(locus.unstable, SizeIs(1));
  // Two eigenvalues 1e-3 apart are known to eps·1e3, and growth less than 20 times that passes for
  // none: 5e-12 at a slope of 0.3.
  EXPECT_NEAR(locus.unstable[0].from, -square - root, 5e-11);
  EXPECT_NEAR(locus.unstable[0].to, -square + root, 5e-11);
}

TEST(Locus, AGrowthThatOnlyComesNearTheAxisIsNoWindow) {
  // As above with a little more damping than it takes.
  EXPECT_THAT(trace_locus(crossing_family(1e-3, -1e-3, 1.001e-3), range(-0.83, 0.97, 5)).unstable,
              IsEmpty());
  EXPECT_THAT(trace_locus(crossing_family(1e-3, -1e-3, 0.999e-3), range(-0.83, 0.97, 5)).unstable,
              SizeIs(1));
}

TEST(Locus, BranchesVeerWhereTheyAreCoupled) {
  // Symmetric coupling: s² = −1 − v/2 ± √(v²/4 + ε²). The eigenvalues repel each other, and the
  // lower one stays the lower one, taking over the shape of the other.
  const Locus locus = trace_locus(crossing_family(1e-4, 1e-4), range(-0.5, 0.5, 6));
  ASSERT_THAT(locus.branches, SizeIs(2));
  const double root = std::sqrt(0.0625 + 1e-8);
  const Branch& lower = branch_ending_at(locus, Complex(0.0, std::sqrt(1.25 - root)));
  EXPECT_NEAR(lower.s.front().imag(), std::sqrt(0.75 - root), 100 * eps);
  for (std::size_t i = 0; i < lower.s.size(); ++i) {
    const double v = lower.values[i];
    const double expected = std::sqrt(1.0 + 0.5 * v - std::sqrt(0.25 * v * v + 1e-8));
    EXPECT_NEAR(lower.s[i].imag(), expected, 1e-13);
  }
  EXPECT_THAT(locus.unstable, IsEmpty());
}

TEST(Locus, BranchesCrossWhereTheyAreNot) {
  // Uncoupled: each keeps its shape, also where a value (v = 0) hits the meeting itself.
  for (const int number : {2, 3, 6, 65}) {
    const Locus locus = trace_locus(crossing_family(0.0, 0.0), range(-0.5, 0.5, number));
    ASSERT_THAT(locus.branches, SizeIs(2)) << number;
    const Branch& constant = branch_ending_at(locus, Complex(0.0, 1.0));
    for (const Complex s : constant.s) EXPECT_LT(std::abs(s - Complex(0.0, 1.0)), 1e-9);
    const Branch& rising = branch_ending_at(locus, Complex(0.0, std::sqrt(1.5)));
    EXPECT_NEAR(rising.s.front().imag(), std::sqrt(0.5), 100 * eps);
    EXPECT_THAT(locus.unstable, IsEmpty());
  }
}

TEST(Locus, APairThatBecomesRealIsFollowedIntoDivergence) {
  // s² + 0.2 s + 1 − v = 0: real from v = 0.99, one root positive from v = 1.
  const PencilFamily family{[](double v, Pencil& pencil) {
                              pencil = test::two_masses({1.0, 9.0}, {0.2, 0.2});
                              pencil.port_stiffness = Eigen::Matrix2d{{-v, 0.0}, {0.0, 0.0}};
                            },
                            {}};
  const Locus locus = trace_locus(family, range(0.0, 1.5, 4));
  ASSERT_THAT(locus.unstable, SizeIs(1));
  EXPECT_NEAR(locus.unstable[0].from, 1.0, 1e-12);
  EXPECT_EQ(locus.unstable[0].to, 1.5);
  EXPECT_EQ(locus.unstable[0].frequency, 0.0);
  EXPECT_NEAR(locus.unstable[0].growth_max, -0.1 + std::sqrt(0.51), 1e-12);
  ASSERT_THAT(locus.eigenvalues.back(), SizeIs(3));
  EXPECT_NEAR(locus.eigenvalues.back()[0].real(), -0.1 - std::sqrt(0.51), 1e-12);
  EXPECT_EQ(locus.eigenvalues.back()[1].imag(), 0.0);
  // And back.
  const PencilFamily reverse{[&](double v, Pencil& pencil) { family.place(1.5 - v, pencil); }, {}};
  const Locus back = trace_locus(reverse, range(0.0, 1.5, 4));
  ASSERT_THAT(back.unstable, SizeIs(1));
  EXPECT_EQ(back.unstable[0].from, 0.0);
  EXPECT_NEAR(back.unstable[0].to, 0.5, 1e-12);
  EXPECT_THAT(back.eigenvalues.back(), SizeIs(2));
}

/// Eleven uncoupled masses; the last one softens from k = 30 to 0.5, past all the others.
PencilFamily softening_family() {
  return {[](double v, Pencil& pencil) {
            Eigen::VectorXd stiffness = Eigen::VectorXd::LinSpaced(11, 1.0, 11.0);
            stiffness(10) = 30.0;
            const Eigen::VectorXd damping = Eigen::VectorXd::Constant(11, 0.02);
            pencil = test::constrained_modes(stiffness.cwiseSqrt(), damping, Eigen::MatrixXd(0, 11),
                                             Eigen::MatrixXd(0, 11));
            pencil.damping(10) = 0.1;
            pencil.port_stiffness.setZero(11, 11);
            pencil.port_stiffness(10, 10) = -v;
          },
          {}};
}

TEST(Locus, AllBelowAFrequencyAreThoseThatComeDownToo) {
  for (const LocusMethod method : {LocusMethod::secular, LocusMethod::dense}) {
    LocusOptions options;
    options.method = method;
    // The damped mass oscillates with ω² = k − d²/4.
    options.window = SpectrumWindow::below(std::sqrt(8.5) / (2.0 * std::numbers::pi));
    const Locus locus = trace_locus(softening_family(), range(0.0, 29.5, 30), options);
    EXPECT_THAT(locus.unverified, IsEmpty());
    for (std::size_t i = 0; i < locus.values.size(); ++i)
      EXPECT_THAT(locus.eigenvalues[i], SizeIs(locus.values[i] < 21.49 ? 8 : 9));
  }
}

TEST(Locus, WhatComesDownFromAboveIsNotOverlooked) {
  LocusOptions options;
  options.window.count = 3;
  const Locus locus = trace_locus(softening_family(), range(0.0, 29.5, 30), options);
  EXPECT_THAT(locus.unverified, IsEmpty());
  for (std::size_t i = 0; i < locus.values.size(); ++i) {
    std::vector<double> squares{1.0, 2.0, 3.0, 4.0, 30.0 - locus.values[i]};
    std::sort(squares.begin(), squares.end());
    ASSERT_THAT(locus.eigenvalues[i], SizeIs(3));
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(std::norm(locus.eigenvalues[i][j]), squares[j], 1e-12);
  }
}

TEST(Locus, WhatMeetsFarAboveIsNotFollowed) {
  // One constraint couples the modes at 1, 2, 3 and 10 rad/s. Beside the last one lie five others,
  // of which two flutter. There is no room for a line between these poles, so the search finds all
  // eigenvalues and not only the three that it is to find for the one asked for.
  int num_calls = 0;
  const PencilFamily family{
      [&](double v, Pencil& pencil) {
        ++num_calls;
        Eigen::VectorXd omega(9);
        omega << 1.0, 2.0, 3.0, 10.0, 10.000001, 10.000002, 10.000003, 10.000004, 10.000005;
        Eigen::MatrixXd row = Eigen::MatrixXd::Zero(1, 9);
        row.leftCols(4) << 1.0, 1.0, 1.0, 10.0;
        pencil = test::constrained_modes(omega, Eigen::VectorXd::Constant(9, 0.01), row, row);
        pencil.port_stiffness.setZero(9, 9);
        pencil.port_stiffness(7, 8) = v - 0.3141;
        pencil.port_stiffness(8, 7) = 0.3141 - v;
      },
      {}};
  LocusOptions options;
  options.window.count = 1;
  const Locus locus = trace_locus(family, range(0.0, 1.0, 2), options);
  EXPECT_THAT(locus.branches, SizeIs(3));
  EXPECT_THAT(locus.unstable, IsEmpty());
  EXPECT_THAT(locus.unverified, IsEmpty());
  // Nothing moves: the 64 steps of the grid are enough.
  EXPECT_LT(num_calls, 80);
}

TEST(Locus, OneValueIsEnough) {
  const Locus locus = trace_locus(flutter_family(0.0), {0.3});
  ASSERT_THAT(locus.eigenvalues, SizeIs(1));
  ASSERT_THAT(locus.eigenvalues[0], SizeIs(2));
  ASSERT_THAT(locus.unstable, SizeIs(1));
  EXPECT_EQ(locus.unstable[0].from, 0.3);
  EXPECT_EQ(locus.unstable[0].to, 0.3);
  EXPECT_EQ(locus.unstable[0].growth_integral, 0.0);
  EXPECT_NEAR(locus.unstable[0].growth_max, 0.1016256896, 1e-10);
}

TEST(Locus, CountAndFrequencyLimitWhatIsGiven) {
  PencilFamily family{[](double v, Pencil& pencil) {
                        pencil = test::random_pencil(4, 20, 1, test::ContactTerms::rows_only);
                        pencil.equilibrium *= 1.0 + 0.1 * v;
                        pencil.equilibrium(0, 3) += v;
                      },
                      {}};
  LocusOptions options;
  options.window.count = 5;
  const Locus lowest = trace_locus(family, range(0.0, 1.0, 3), options);
  for (std::size_t i = 0; i < 3; ++i) {
    Pencil pencil;
    family.place(lowest.values[i], pencil);
    const auto expected = secular_eigenvalues(pencil, SpectrumWindow::lowest(5));
    ASSERT_EQ(lowest.eigenvalues[i].size(), expected.size());
    for (std::size_t j = 0; j < expected.size(); ++j)
      EXPECT_LT(std::abs(lowest.eigenvalues[i][j] - expected[j].s),
                1e-11 * std::abs(expected[j].s));
    options.window.frequency = 0.5 * (expected[2].frequency() + expected[3].frequency());
    const Locus below = trace_locus(family, {lowest.values[i]}, options);
    EXPECT_THAT(below.eigenvalues[0], SizeIs(3));
  }
}

TEST(Locus, RefusesWhatHasNoMeaning) {
  const auto refusal = [](std::vector<double> values, auto&& change) {
    LocusOptions options;
    PencilFamily family = flutter_family(0.0);
    change(options, family);
    return message_of<std::invalid_argument>([&] { trace_locus(family, values, options); });
  };
  const auto none = [](LocusOptions&, PencilFamily&) {};
  EXPECT_EQ(refusal({}, none), "locus: there are no values");
  EXPECT_EQ(refusal({0.0, 0.1, 0.1}, none), "locus: the values must ascend, but value 3 is 0.1");
  EXPECT_EQ(refusal({std::nan("")}, none), "locus: the values must ascend, but value 1 is nan");
  EXPECT_EQ(refusal({0.0}, [](auto& options, auto&) { options.window.count = 0; }),
            "locus: 0 eigenvalues are none");
  EXPECT_EQ(refusal({0.0}, [](auto& options, auto&) { options.window.frequency = 0.0; }),
            "locus: no eigenvalues below 0 Hz");
  EXPECT_EQ(refusal({0.0}, [](auto& options, auto&) { options.resolution = 0.0; }),
            "locus: the resolution must be positive, is 0");
  EXPECT_EQ(refusal({0.0}, [](auto&, auto& family) { family.place = nullptr; }),
            "locus: there is no family");
  EXPECT_EQ(refusal({0.0},
                    [](auto&, auto& family) {
                      family.kinks = {1.0, 0.0};
                    }),
            "locus: the kinks must ascend");
}

TEST(Locus, SaysWhereTheFirstEigenvaluesAreNotFound) {
  // B_C · B_E = 0: fewer eigenvalues than there should be.
  const PencilFamily family{[](double, Pencil& pencil) {
                              pencil = test::constrained_modes(
                                  Eigen::Vector3d(1, 2, 3), Eigen::Vector3d::Zero(),
                                  Eigen::RowVector3d(1, 1, 0), Eigen::RowVector3d(1, -1, 0));
                            },
                            {}};
  EXPECT_THAT(message_of<NumericalError>([&] {
                trace_locus(family, {0.5, 1.0});
              }),
              HasSubstr("locus: the eigenvalues at the first value, 0.5, were not found"));
}

class PaperLocus : public ::testing::Test {
 protected:
  static PencilFamily family(double angle) {
    static const Model trailing = test::make_paper_model(test::paper_model());
    static const Model leading = test::make_paper_model(test::paper_model(test::leading_angle));
    const Model& model = angle == test::trailing_angle ? trailing : leading;
    return undeformed_family(model.system, 0.3, 1.0, 0.030);
  }

  /// Positions of a grid at which the locus has an unstable eigenvalue near a frequency.
  static std::vector<double> unstable_positions(const Locus& locus, double frequency) {
    std::vector<double> positions;
    for (std::size_t i = 0; i < locus.values.size(); ++i) {
      for (const Complex s : locus.eigenvalues[i]) {
        if (s.real() > 0.0 && std::abs(s.imag() / two_pi - frequency) < 100.0)
          positions.push_back(locus.values[i]);
      }
    }
    return positions;
  }

  static int num_unstable(const Locus& locus) {
    int number = 0;
    for (const auto& eigenvalues : locus.eigenvalues) {
      number += static_cast<int>(std::count_if(eigenvalues.begin(), eigenvalues.end(),
                                               [](Complex s) { return s.real() > 0.0; }));
    }
    return number;
  }
};

TEST_F(PaperLocus, KinksAreTheNodesOfTheMaster) {
  const PencilFamily trailing = family(test::trailing_angle);
  ASSERT_THAT(trailing.kinks, SizeIs(99));
  for (std::size_t i = 0; i < trailing.kinks.size(); ++i)
    EXPECT_NEAR(trailing.kinks[i], 1e-3 * static_cast<double>(i + 1), 1e-15);
}

TEST_F(PaperLocus, HasTheKnownWindowsOnTheKnownGrid) {
  // From an independent calculation at every quarter of a millimetre, from 30 to 98 mm.
  const std::vector<double> grid = range(0.030, 0.098, 273);
  const Locus trailing = trace_locus(family(test::trailing_angle), grid);
  const auto near = [](double position) { return ::testing::DoubleNear(position, 1e-9); };
  using ::testing::ElementsAre;
  EXPECT_THAT(unstable_positions(trailing, 10.57e3),
              ElementsAre(near(0.048), near(0.04825), near(0.0515)));
  EXPECT_THAT(unstable_positions(trailing, 6.95e3), ElementsAre(near(0.0955)));
  EXPECT_EQ(num_unstable(trailing), 4);
  EXPECT_THAT(trailing.unverified, IsEmpty());

  const Locus leading = trace_locus(family(test::leading_angle), grid);
  EXPECT_THAT(unstable_positions(leading, 10.57e3),
              ElementsAre(near(0.04775), near(0.048), near(0.05175), near(0.052)));
  EXPECT_EQ(num_unstable(leading), 4);
  EXPECT_THAT(leading.unverified, IsEmpty());
}

TEST_F(PaperLocus, WindowsDoNotDependOnTheGrid) {
  for (const double angle : {test::trailing_angle, test::leading_angle}) {
    const Locus fine = trace_locus(family(angle), range(0.030, 0.098, 700));
    ASSERT_THAT(fine.unstable, SizeIs(3));
    for (const int number : {2, 7, 61}) {
      const Locus coarse = trace_locus(family(angle), range(0.030, 0.098, number));
      ASSERT_THAT(coarse.unstable, SizeIs(3)) << number;
      for (std::size_t i = 0; i < 3; ++i) {
        const UnstableWindow& a = fine.unstable[i];
        const UnstableWindow& b = coarse.unstable[i];
        EXPECT_NEAR(a.from, b.from, 1e-12);
        EXPECT_NEAR(a.to, b.to, 1e-12);
        // The peak is sought by parabolas until it moves by 1e-8 of an interval.
        EXPECT_NEAR(a.growth_max, b.growth_max, 1e-6 * a.growth_max);
        EXPECT_NEAR(a.frequency, b.frequency, 1e-6 * a.frequency);
        EXPECT_NEAR(a.growth_integral, b.growth_integral, 1e-6 * a.growth_integral);
      }
      EXPECT_THAT(coarse.crossings, SizeIs(6));
    }
    // Each crossing is one.
    for (const Crossing& crossing : fine.crossings) {
      Pencil pencil;
      family(angle).place(crossing.value, pencil);
      double least = INFINITY;
      for (const Eigenvalue& eigenvalue : secular_eigenvalues(pencil, SpectrumWindow::lowest(20)))
        least = std::min(least, std::abs(eigenvalue.growth()));
      EXPECT_LT(least, 1e-6);
    }
  }
}

TEST_F(PaperLocus, WithoutFrictionNothingIsUnstable) {
  const Model model = test::make_paper_model(test::paper_model());
  const Locus locus =
      trace_locus(undeformed_family(model.system, 0.0, 1.0, 0.030), range(0.030, 0.098, 20));
  EXPECT_THAT(locus.unstable, IsEmpty());
  EXPECT_THAT(locus.crossings, IsEmpty());
  EXPECT_EQ(num_unstable(locus), 0);
}

TEST_F(PaperLocus, IsTheSameByTheDenseMethod) {
  // Two windows of the trailing scene, with the modes above 30 kHz as residual.
  PencilFamily all = family(test::trailing_angle);
  PencilFamily few = all;
  few.place = [all](double value, Pencil& pencil) {
    pencil = Pencil{};
    all.place(value, pencil);
    pencil = with_residual_modes(pencil, two_pi * 30e3);
  };
  const std::vector<double> values = range(0.0475, 0.0486, 3);
  LocusOptions options;
  options.window.count = 16;
  const Locus secular = trace_locus(few, values, options);
  options.method = LocusMethod::dense;
  const Locus dense = trace_locus(few, values, options);
  ASSERT_THAT(secular.unstable, SizeIs(1));
  ASSERT_THAT(dense.unstable, SizeIs(1));
  // The dense eigenvalues are good to 1e-11 of their size where two are as close as here, that is
  // 1e-6 1/s; the growth rises by 0.1 1/s per µm.
  EXPECT_NEAR(secular.unstable[0].from, dense.unstable[0].from, 1e-10);
  EXPECT_NEAR(secular.unstable[0].to, dense.unstable[0].to, 1e-10);
  EXPECT_NEAR(secular.unstable[0].growth_max, dense.unstable[0].growth_max, 1e-5);
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(secular.eigenvalues[i].size(), 16);
    ASSERT_EQ(dense.eigenvalues[i].size(), 16);
    for (std::size_t j = 0; j < 16; ++j) {
      EXPECT_LT(std::abs(secular.eigenvalues[i][j] - dense.eigenvalues[i][j]),
                1e-8 * std::abs(dense.eigenvalues[i][j]));
    }
  }
}

TEST(LocusDense, EndsWhereRoundingMovesAnEigenvalueFromValueToValue) {
  // b_C b_Eᵀ = 6e-14: one eigenvalue, near 7e6 j, is known to three digits only, and its real part
  // has no sign. Without a limit the search for its windows would go down to 1e-9 of the range.
  const PencilFamily family{
      [](double v, Pencil& pencil) {
        pencil = test::constrained_modes(
            Eigen::Vector4d(0.3, 0.45, 1.0, 2.0), Eigen::Vector4d(0.02, 0.03, 0.0, 0.0),
            Eigen::RowVector4d(0.0, 0.0, 1.0, 1.0), Eigen::RowVector4d(0.0, 0.0, 1.0, 6e-14 - 1.0));
        pencil.port_stiffness = Eigen::Matrix4d::Zero();
        pencil.port_stiffness.topLeftCorner<2, 2>() = test::circulatory(v);
      },
      {}};
  LocusOptions options;
  options.method = LocusMethod::dense;
  const Locus locus = trace_locus(family, {0.0, 0.05, 0.1}, options);
  EXPECT_LE(locus.num_refined, 60'000);
  EXPECT_GT(locus.unresolved, 0.0) << "what has not been resolved is named";
  EXPECT_EQ(locus.eigenvalues[0].size(), 3u);
}

}  // namespace
}  // namespace stridor
