#include "models/reduction_error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "substructures/reduction/craig_bampton.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/spring_chain.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::Each;
using ::testing::Lt;
using ::testing::SizeIs;

constexpr int num_masses = 12;

BodyCache::Reduction reduced_chain(const BodyMatrices& chain, const std::vector<int>& interface,
                                   int num_modes) {
  BodyCache::Reduction reduction;
  reduction.reduced = make_craig_bampton(chain, interface, num_modes, interface);
  reduction.modal = make_modal(reduction.reduced);
  return reduction;
}

/// The error at the first mass by fixed-interface modes in closed form, sin(jπi/n) of the other masses
/// between two walls.
double expected_error(int num_modes, double omega) {
  const Eigen::MatrixXd dynamic =
      Eigen::MatrixXd(chain_stiffness(num_masses)) -
      omega * omega * Eigen::MatrixXd::Identity(num_masses, num_masses);
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(num_masses, 1 + num_modes);
  for (int i = 0; i < num_masses; ++i) {
    T(i, 0) = 1.0 - static_cast<double>(i) / num_masses;
    for (int j = 1; j <= num_modes; ++j) T(i, j) = std::sin(j * std::numbers::pi * i / num_masses);
  }
  const double full = dynamic.inverse()(0, 0);
  const double reduced = (T.transpose() * dynamic * T).inverse()(0, 0);
  return std::abs(reduced - full) / std::abs(full);
}

TEST(ReductionError, IsThatOfTheModesLeftOut) {
  const BodyMatrices chain = chain_body(num_masses);
  const std::vector<int> interface{0};
  const std::vector<double> frequencies{0.02, 0.08, 0.15, 0.25};
  for (const int num_modes : {0, 1, 4, 9}) {
    const ReductionError error =
        reduction_error(chain, interface, interface, reduced_chain(chain, interface, num_modes),
                        frequencies);
    EXPECT_EQ(error.num_unknowns, num_masses);
    EXPECT_EQ(error.num_interface, 1);
    EXPECT_EQ(error.num_modes, num_modes);
    ASSERT_THAT(error.errors, SizeIs(4));
    for (std::size_t i = 0; i < 4; ++i) {
      const double expected = expected_error(num_modes, two_pi * frequencies[i]);
      EXPECT_NEAR(error.errors[i], expected, 1e-9 + 1e-7 * expected) << num_modes << " modes";
    }
  }
}

TEST(ReductionError, IsRoundingWithAllModes) {
  const BodyMatrices chain = chain_body(num_masses);
  const std::vector<int> interface{0, 7};
  const ReductionError error = reduction_error(
      chain, interface, interface, reduced_chain(chain, interface, num_masses - 2), {});
  ASSERT_THAT(error.frequencies, SizeIs(5));
  EXPECT_THAT(error.errors, Each(Lt(1e-10)));
}

TEST(ReductionError, NeedsAFrequencyWhereThereIsNoMode) {
  const BodyMatrices chain = chain_body(num_masses);
  const std::vector<int> interface{0};
  EXPECT_THROW(
      reduction_error(chain, interface, interface, reduced_chain(chain, interface, 0), {}),
      std::invalid_argument);
}

/// The larger error of the beams of the main scene at a frequency, by modes of the slider and of the
/// clamped beam.
double worst_of_beams(double frequency, int of_slider, int of_clamped) {
  ModelParameters parameters = paper_model();
  BeamParameters slider = paper_oblique(trailing_angle);
  BeamParameters clamped = paper_cantilever();
  slider.reduction.fixed_interface_modes = of_slider;
  clamped.reduction.fixed_interface_modes = of_clamped;
  parameters.substructures["oblique"] = slider;
  parameters.substructures["cantilever"] = clamped;
  BodyCache cache;
  const std::vector<ReductionError> errors = reduction_errors(parameters, {frequency}, cache);
  EXPECT_THAT(errors, SizeIs(2));
  EXPECT_EQ(errors[0].body, "cantilever");
  EXPECT_EQ(errors[0].dofs.size(), most_compared_dofs);
  EXPECT_EQ(errors[1].body, "oblique");
  return std::max(errors[0].errors[0], errors[1].errors[0]);
}

TEST(ReductionError, OfTheMainSceneFallsWithTheModesKept) {
  for (const double frequency : {1000.0, 5000.0}) {
    double last = 1.0;
    for (const int num_modes : {1, 8, 60}) {
      const double worst = worst_of_beams(frequency, num_modes, num_modes);
      EXPECT_LT(worst, last) << num_modes << " modes at " << frequency << " Hz";
      last = worst;
    }
    // All of them: 371 unknowns less 3 of the interface, 500 less 200.
    EXPECT_LT(worst_of_beams(frequency, 368, 300), 1e-7);
  }
}

}  // namespace
}  // namespace stridor
