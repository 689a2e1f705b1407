// Windows of instability between the values looked at, in systems whose windows have closed forms.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "analysis/pair_model.hpp"
#include "analysis/sampled_locus.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"

namespace stridor {
namespace {

/// A system over a parameter from 0 to 1 that is unstable between two values, if at all.
struct KnownSystem {
  std::function<LinearSystem(double)> at;
  bool is_unstable = true;
  double from = 0.0, to = 0.0;
  const char* kind = "";
};

LinearSystem free_system(Eigen::Index size) {
  LinearSystem system;
  system.mass = Eigen::MatrixXd::Identity(size, size);
  system.velocity = system.position = Eigen::MatrixXd::Zero(size, size);
  system.gaps = system.forces = Eigen::MatrixXd(0, size);
  return system;
}

class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}

  KnownSystem next();

 private:
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  /// From 1e-5 to 1e-1 of the range.
  double width() { return std::pow(10.0, uniform(-5.0, -1.0)); }

  KnownSystem circulatory();
  KnownSystem damped_circulatory();
  KnownSystem falling_damping();
  KnownSystem rotating();
  KnownSystem hidden(KnownSystem known);

  std::mt19937 random_;
};

/// Two modes whose stiffnesses cross with slope c, coupled by b ± e:
/// they flutter where (c (p − p_c)/2)² + b² < e².
KnownSystem Generator::circulatory() {
  const double place = uniform(0.06, 0.94), half = 0.5 * width();
  const double slope = uniform(0.3, 2.0), stiffness = uniform(2.0, 9.0), mean = uniform(-1.0, 1.0);
  const double reach = 0.5 * slope * half;
  const double symmetric = uniform(0.0, 2.0) * reach;
  const bool is_unstable = uniform(0.0, 1.0) < 0.8;
  const double skew = is_unstable ? std::hypot(reach, symmetric) : 0.9 * symmetric;
  const auto at = [=](double p) {
    LinearSystem system = free_system(2);
    const double detuning = 0.5 * slope * (p - place);
    system.position << stiffness + mean * p + detuning, symmetric + skew, symmetric - skew,
        stiffness + mean * p - detuning;
    return system;
  };
  return {at, is_unstable, place - half, place + half, "circulatory"};
}

/// The same with damping d of both: unstable where e² − (c (p − p_c)/2)² > d² k.
KnownSystem Generator::damped_circulatory() {
  const double place = uniform(0.06, 0.94), half = 0.5 * width();
  const double slope = uniform(0.3, 2.0), stiffness = uniform(2.0, 9.0);
  const double reach = 0.5 * slope * half;
  const double threshold = uniform(0.1, 10.0) * reach;
  const bool is_unstable = uniform(0.0, 1.0) < 0.8;
  const double skew = is_unstable ? std::hypot(reach, threshold) : 0.9 * threshold;
  const auto at = [=](double p) {
    LinearSystem system = free_system(2);
    const double detuning = 0.5 * slope * (p - place);
    system.position << stiffness + detuning, skew, -skew, stiffness - detuning;
    system.velocity = threshold / std::sqrt(stiffness) * Eigen::MatrixXd::Identity(2, 2);
    return system;
  };
  return {at, is_unstable, place - half, place + half, "damped circulatory"};
}

/// One mode with damping γ ((p − p_c)² ∓ w²/4), beside one that is damped.
KnownSystem Generator::falling_damping() {
  const double place = uniform(0.06, 0.94), half = 0.5 * width();
  const double factor = uniform(0.2, 2.0), stiffness = uniform(2.0, 9.0);
  const bool is_unstable = uniform(0.0, 1.0) < 0.8;
  const auto at = [=](double p) {
    LinearSystem system = free_system(2);
    system.position << stiffness, 0.0, 0.0, 13.0;
    const double square = (p - place) * (p - place);
    system.velocity << factor * (square + (is_unstable ? -1.0 : 1.0) * half * half), 0.0, 0.0, 0.01;
    return system;
  };
  return {at, is_unstable, place - half, place + half, "falling damping"};
}

/// A mass on a shaft that rotates at Ω = 1 + p, in its frame: it diverges between its two natural
/// frequencies.
KnownSystem Generator::rotating() {
  const double place = uniform(0.06, 0.94), half = 0.5 * width();
  const double first = 1.0 + place - half, second = 1.0 + place + half;
  const auto at = [=](double p) {
    LinearSystem system = free_system(2);
    const double speed = 1.0 + p;
    system.position << first * first - speed * speed, 0.0, 0.0, second * second - speed * speed;
    system.velocity << 0.0, -2.0 * speed, 2.0 * speed, 0.0;
    return system;
  };
  return {at, true, place - half, place + half, "rotating"};
}

/// Stable modes beside it, whose frequencies may cross, and other coordinates.
KnownSystem Generator::hidden(KnownSystem known) {
  const auto others = std::uniform_int_distribution<Eigen::Index>(0, 4)(random_);
  const Eigen::Index size = 2 + others;
  Eigen::VectorXd stiffness(others), slope(others);
  for (double& one : stiffness) one = uniform(2.0, 9.0);
  for (double& one : slope) one = uniform(-1.0, 1.0);
  Eigen::MatrixXd random(size, size);
  for (double& one : random.reshaped()) one = uniform(-1.0, 1.0);
  const Eigen::MatrixXd turn = Eigen::HouseholderQR<Eigen::MatrixXd>(random).householderQ();
  known.at = [=, two = known.at](double p) {
    const LinearSystem inner = two(p);
    LinearSystem system = free_system(size);
    system.position.topLeftCorner(2, 2) = inner.position;
    system.velocity.topLeftCorner(2, 2) = inner.velocity;
    system.position.diagonal().tail(others) = stiffness + p * slope;
    system.position = (turn * system.position * turn.transpose()).eval();
    system.velocity = (turn * system.velocity * turn.transpose()).eval();
    return system;
  };
  return known;
}

KnownSystem Generator::next() {
  switch (std::uniform_int_distribution<int>(0, 3)(random_)) {
    case 0:
      return hidden(circulatory());
    case 1:
      return hidden(damped_circulatory());
    case 2:
      return hidden(falling_damping());
    default:
      return hidden(rotating());
  }
}

Locus locus_of(const KnownSystem& known, const std::vector<double>& values,
               const SamplingEffort& effort = {}) {
  PencilFamily family;
  family.place = [&](double value, Pencil& pencil) { pencil = make_pencil(known.at(value)); };
  return sample_locus(family, values, {}, effort);
}

TEST(NarrowWindow, AThousandRandomSystemsHideNone) {
  Generator generator(19);
  int num_found = 0;
  for (int i = 0; i < 1000; ++i) {
    const KnownSystem known = generator.next();
    const Locus locus = locus_of(known, {0.0, 1.0});
    SCOPED_TRACE(testing::Message() << "system " << i << ", " << known.kind << ", from "
                                    << known.from << " to " << known.to);
    EXPECT_EQ(locus.unresolved, 0.0);
    if (!known.is_unstable) {
      EXPECT_TRUE(locus.unstable.empty());
      continue;
    }
    EXPECT_EQ(locus.unstable.size(), 1U);
    if (locus.unstable.size() != 1) continue;
    // Growth of the order of rounding at the ends counts as none.
    const double tolerance = 1e-3 * (known.to - known.from) + 1e-9;
    EXPECT_NEAR(locus.unstable[0].from, known.from, tolerance);
    EXPECT_NEAR(locus.unstable[0].to, known.to, tolerance);
    ++num_found;
  }
  EXPECT_GT(num_found, 800);
}

TEST(NarrowWindow, AThousandRandomSystemsHideNoneWhereStabilityAloneIsWanted) {
  Generator generator(20);
  int num_found = 0;
  for (int i = 0; i < 1000; ++i) {
    const KnownSystem known = generator.next();
    const Locus locus = locus_of(known, {0.0, 0.5, 1.0}, stability_effort);
    SCOPED_TRACE(testing::Message() << "system " << i << ", " << known.kind << ", from "
                                    << known.from << " to " << known.to);
    EXPECT_EQ(locus.unresolved, 0.0);
    EXPECT_EQ(locus.unstable.size(), known.is_unstable ? 1U : 0U);
    EXPECT_EQ(locus.crossings.size(), known.is_unstable ? 2U : 0U);
    if (locus.crossings.size() != 2) continue;
    const double tolerance = 1e-3 * (known.to - known.from) + 1e-9;
    EXPECT_NEAR(locus.crossings[0].value, known.from, tolerance);
    EXPECT_NEAR(locus.crossings[1].value, known.to, tolerance);
    ++num_found;
  }
  EXPECT_GT(num_found, 800);
}

/// s² + k = 0 twice, with (1 − p) − (k₂ + ...) apart and e between them as in a scene.
KnownSystem crossing_at(double stiffness, double circulatory) {
  KnownSystem known;
  known.at = [=](double load) {
    LinearSystem system = free_system(2);
    system.position << 1.0 + load, circulatory, -circulatory, stiffness - load;
    return system;
  };
  const double place = 0.5 * (stiffness - 1.0);
  known.from = place - circulatory;
  known.to = place + circulatory;
  return known;
}

TEST(NarrowWindow, FlutterBetweenTwoValuesIsFound) {
  const KnownSystem known = crossing_at(2.0437, 1e-3);
  for (const int number : {2, 3, 101}) {
    std::vector<double> values;
    for (int i = 0; i < number; ++i) values.push_back(i / (number - 1.0));
    const Locus locus = locus_of(known, values);
    ASSERT_EQ(locus.unstable.size(), 1U) << number;
    EXPECT_NEAR(locus.unstable[0].from, 0.52085, 1e-11);
    EXPECT_NEAR(locus.unstable[0].to, 0.52285, 1e-11);
    EXPECT_EQ(locus.unresolved, 0.0);
  }
}

TEST(NarrowWindow, AnEndFarBelowTheRangeIsFound) {
  // k = 1 and 1.4 with ± p between them flutter from 0.2 on.
  KnownSystem known;
  known.at = [](double load) {
    LinearSystem system = free_system(2);
    system.position << 1.0, load, -load, 1.4;
    return system;
  };
  for (const double to : {1e3, 1e12, 1e100}) {
    const Locus locus = locus_of(known, {0.0, to});
    ASSERT_EQ(locus.unstable.size(), 1U) << to;
    EXPECT_NEAR(locus.unstable[0].from, 0.2, 1e-12) << to;
  }
}

TEST(NarrowWindow, EveryEigenvalueThatGrowsHasItsOwn) {
  // Two modes with damping that becomes negative between 0.3 and 0.7 and from 0.5 on, and one that
  // stops where another begins, between two values looked at.
  KnownSystem known;
  known.at = [](double p) {
    LinearSystem system = free_system(4);
    system.position.diagonal() << 1.0, 4.0, 9.0, 9.5;
    system.velocity.diagonal() << (p - 0.3) * (p - 0.7), 0.5 - p, p - 0.2051, 0.2052 - p;
    return system;
  };
  const Locus locus = locus_of(known, {0.0, 0.5, 1.0});
  ASSERT_EQ(locus.unstable.size(), 4U);
  const auto expect_window = [&](std::size_t i, double from, double to, double growth) {
    EXPECT_NEAR(locus.unstable[i].from, from, 1e-10);
    EXPECT_NEAR(locus.unstable[i].to, to, 1e-10);
    EXPECT_NEAR(locus.unstable[i].growth_max, growth, 1e-9);
  };
  expect_window(0, 0.0, 0.2051, 0.5 * 0.2051);
  expect_window(1, 0.2052, 1.0, 0.5 * 0.7948);
  expect_window(2, 0.3, 0.7, 0.02);
  expect_window(3, 0.5, 1.0, 0.25);
  EXPECT_EQ(locus.crossings.size(), 5U);
}

/// D = e² − 40² u² + c u⁴ with u from the middle between 2 and 3.
double square_at(double x, double e, double c) {
  const double u2 = (x - 2.5) * (x - 2.5);
  return e * e - 1600.0 * u2 + c * u2 * u2;
}

/// Looks at 0 to 5 of such a pair with Re m = −5.
std::vector<PairLook> looks_of(double e, double c) {
  std::vector<PairLook> looks;
  for (int i = 0; i < 6; ++i)
    looks.push_back({static_cast<double>(i), {-5.0, 100.0}, {square_at(i, e, c), 0.0}});
  return looks;
}

TEST(GrowthBound, IsCloseToTheLargestGrowthWhereParabolasAreExact) {
  // The rise between two of 65 places is 1600/64² · 2 · 0.25 at most.
  const double rise = 1600.0 / (64.0 * 64.0) * 0.5;
  EXPECT_NEAR(growth_bound(looks_of(3.0, 0.0), 2.0, 3.0), -5.0 + std::sqrt(9.0 + rise), 1e-5);
  EXPECT_NEAR(growth_bound(looks_of(6.0, 0.0), 2.0, 3.0), -5.0 + std::sqrt(36.0 + rise), 1e-5);
}

TEST(GrowthBound, LeavesRoomForWhatIsEvenAboutTheMiddle) {
  // Polynomials of degree 3 through four looks would see nothing of u⁴; those of degree 5 do.
  for (const double c : {-20.0, 20.0}) {
    const double bound = growth_bound(looks_of(3.0, c), 2.0, 3.0);
    EXPECT_GT(bound, -5.0 + std::sqrt(square_at(2.5, 3.0, c)) + 1.0);
    EXPECT_LT(bound, 100.0);
  }
}

TEST(GrowthBound, IsInfiniteWithoutSixLooks) {
  std::vector<PairLook> few = looks_of(3.0, 0.0);
  few.pop_back();
  EXPECT_EQ(growth_bound(few, 2.0, 3.0), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace stridor
