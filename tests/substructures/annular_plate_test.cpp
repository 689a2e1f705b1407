#include "substructures/bodies/annular_plate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "tests/support/constants.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;

using test::two_pi;

/// The disc whose frequencies an independent program has computed.
AnnularPlateParameters reference_disc() {
  AnnularPlateParameters plate;
  plate.inner_radius = 0.08;
  plate.outer_radius = 0.16;
  plate.thickness = 0.012;
  plate.material = {2.1e11, 0.3, 7850.0};
  plate.nodal_diameters = 6;
  return plate;
}

TEST(AnnularPlate, FrequencyParametersOfAClampedFreeAnnulus) {
  AnnularPlateParameters parameters = reference_disc();
  parameters.nodal_diameters = 5;
  parameters.radial_terms = 16;  // converged
  const AnnularPlate plate(parameters);
  const double h = parameters.thickness;
  const double bending = 2.1e11 * h * h * h / (12.0 * (1.0 - 0.09));
  // ω b² (ρ h/D)^½ for a/b = 0.5, ν = 0.3 and n = 0 … 5
  const std::array expected{13.024257, 13.289781, 14.703812, 18.561989, 25.595817, 35.730092};
  for (std::size_t n = 0; n < expected.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(n == 0 ? 0 : 2 * n - 1);
    const double found = plate.omega()(i) * 0.16 * 0.16 * std::sqrt(7850.0 * h / bending);
    EXPECT_NEAR(found, expected[n], 6e-7) << n;
  }
}

TEST(AnnularPlate, EightTermsGiveTheReferenceFrequencies) {
  const AnnularPlate plate(reference_disc());
  ASSERT_EQ(plate.size(), 13);
  const std::array expected{1520.8202, 1551.8250, 1716.9390, 2167.4517,
                            2988.7799, 4172.1420, 5683.4135};
  for (std::size_t n = 0; n < expected.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(n == 0 ? 0 : 2 * n - 1);
    EXPECT_NEAR(plate.omega()(i) / two_pi, expected[n], 6e-5) << n;
    if (n > 0) {
      EXPECT_EQ(plate.omega()(i), plate.omega()(i + 1)) << n;
    }
  }
}

TEST(AnnularPlate, SpinningFreelyEveryPairSplitsByItsNumberOfDiameters) {
  const AnnularPlate plate(reference_disc());
  const double speed = 10.0;
  const Eigen::Index n = plate.size();
  const Eigen::MatrixXd S = plate.spin();
  // First-order form, displacements scaled by ω.
  const Eigen::VectorXd& w = plate.omega();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n) = w.asDiagonal();
  A.bottomRightCorner(n, n) = -2.0 * speed * S;
  A.bottomLeftCorner(n, n) = -(Eigen::MatrixXd(w.array().square().matrix().asDiagonal()) -
                               speed * speed * S.transpose() * S) *
                             w.cwiseInverse().asDiagonal();
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A, false);
  std::vector<double> found;
  for (const std::complex<double>& s : solver.eigenvalues())
    if (s.imag() > 0.0) found.push_back(s.imag());
  std::sort(found.begin(), found.end());
  std::vector<double> expected{w(0)};
  for (int d = 1; d <= 6; ++d)
    for (const int sign : {-1, 1}) expected.push_back(w(2 * d - 1) + sign * d * speed);
  std::sort(expected.begin(), expected.end());
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-10 * expected[i]);
  // The pair of one nodal diameter that the misprinted matrices put elsewhere.
  EXPECT_NEAR(found[1] / two_pi, 1550.23, 0.006);
  EXPECT_NEAR(found[2] / two_pi, 1553.42, 0.006);
}

TEST(AnnularPlate, RowsAreDerivativesOfTheDeflection) {
  const AnnularPlate plate(reference_disc());
  const double r = 0.131;
  const double angle = 0.7;
  const double d = 1e-5;
  const PlateRows rows = plate.rows(r, angle);
  const auto derivative = [&](auto part, double dr, double dphi) {
    const Eigen::VectorXd after = part(plate.rows(r + dr, angle + dphi));
    const Eigen::VectorXd before = part(plate.rows(r - dr, angle - dphi));
    return Eigen::VectorXd((after - before) / (2.0 * d));
  };
  const auto w = [](const PlateRows& at) { return at.w; };
  const auto w_phi = [](const PlateRows& at) { return at.w_phi; };
  const auto expect_same = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    EXPECT_LT((a - b).norm(), 1e-7 * b.norm());
  };
  expect_same(derivative(w, d, 0.0), rows.w_r);
  expect_same(derivative(w, 0.0, d), rows.w_phi);
  expect_same(derivative(w_phi, d, 0.0), rows.w_r_phi);
  expect_same(derivative(w_phi, 0.0, d), rows.w_phi_phi);
  expect_same(plate.spin().transpose() * rows.w, rows.w_phi);
}

TEST(AnnularPlate, CentrifugalStressIsInEquilibriumAndMeetsTheEdges) {
  const AnnularPlateParameters plate = reference_disc();
  const double speed = 300.0;
  const auto stress = [&](double r) { return centrifugal_stress(plate, speed, r); };
  const double d = 1e-5;
  const double scale = 7850.0 * speed * speed * 0.16 * 0.16;
  for (const double r : {0.09, 0.12, 0.15}) {
    const double slope =
        ((r + d) * stress(r + d).radial - (r - d) * stress(r - d).radial) / (2.0 * d);
    EXPECT_NEAR(slope - stress(r).circumferential + 7850.0 * speed * speed * r * r, 0.0,
                1e-7 * scale);
  }
  EXPECT_NEAR(stress(0.16).radial, 0.0, 1e-14 * scale);
  // No hoop strain where the disc is held.
  EXPECT_NEAR(stress(0.08).circumferential, 0.3 * stress(0.08).radial, 1e-14 * scale);
}

TEST(AnnularPlate, CentrifugalStressStiffensInProportionToTheSquareOfSpeed) {
  AnnularPlateParameters parameters = reference_disc();
  parameters.radial_terms = 1;  // one shape, whose ω² is linear in the stress
  const auto squares = [&](double speed) {
    return Eigen::ArrayXd(AnnularPlate(parameters, speed).omega().array().square());
  };
  const Eigen::ArrayXd still = squares(0.0);
  const Eigen::ArrayXd once = squares(500.0) - still;
  const Eigen::ArrayXd twice = squares(1000.0) - still;
  EXPECT_GT(once.minCoeff(), 0.0);
  EXPECT_LT((twice - 4.0 * once).abs().maxCoeff(), 1e-9 * twice.maxCoeff());
}

TEST(AnnularPlate, LowestOmittedModeIsTheNextOne) {
  AnnularPlateParameters parameters = reference_disc();
  const double omitted = AnnularPlate(parameters).lowest_omitted();
  parameters.nodal_diameters = 7;
  const AnnularPlate larger(parameters);
  EXPECT_DOUBLE_EQ(omitted, larger.omega()(13));
}

TEST(AnnularPlate, RejectsWhatIsNoAnnulus) {
  AnnularPlateParameters plate = reference_disc();
  plate.outer_radius = 0.05;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { AnnularPlate made(plate); }),
            "annular plate: no annulus between radii 0.08 and 0.05 m");
  plate = reference_disc();
  plate.thickness = 0.0;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { AnnularPlate made(plate); }),
            "annular plate: thickness 0 m");
  plate = reference_disc();
  plate.radial_modes = 9;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { AnnularPlate made(plate); }),
            "annular plate: 9 radial modes of 8 terms");
  plate = reference_disc();
  plate.nodal_diameters = -1;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { AnnularPlate made(plate); }),
            "annular plate: -1 nodal diameters");
}

}  // namespace
}  // namespace stridor
