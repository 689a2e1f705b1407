#include "app/stability/stability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "app/stability/family_locus.hpp"
#include "app/stability/verdict.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/search_failure.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/pencils.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

TEST(PrintedUnits, AreWrittenAsInRunFiles) {
  const auto printed = [](const char* unit) { return printed_units({"key", unit, {}, false}); };
  EXPECT_EQ(printed(""), "1");
  EXPECT_EQ(printed("m"), "m");
  EXPECT_EQ(printed("s-1"), "1/s");
  EXPECT_EQ(printed("m s-1"), "m/s");
  EXPECT_EQ(printed("kg m-3"), "kg/m^3");
  EXPECT_EQ(value_text({"drive.load", "N", {}, false}, -0.2), "drive.load = -0.2 N");
  EXPECT_EQ(value_text({"friction", "", {}, false}, 0.3), "friction = 0.3");
}

TEST(StabilityChanges, AreWhereTheFirstBeginsAndTheLastEnds) {
  // Two windows that overlap, and one apart that begins with the range.
  Locus locus;
  locus.values = {0.0, 1.0};
  locus.unstable = {{0.0, 0.1, 5.0, 1.0, 0.1, 0.0, 0},
                    {0.3, 0.5, 10.0, 1.0, 0.1, 0.4, 0},
                    {0.4, 0.6, 20.0, 1.0, 0.1, 0.5, 1}};
  locus.crossings = {{0.1, 5.0, -1, 0},
                     {0.3, 10.0, 1, 0},
                     {0.4, 20.0, 1, 1},
                     {0.5, 11.0, -1, 0},
                     {0.6, 21.0, -1, 1}};
  const auto changes = stability_changes(locus);
  ASSERT_EQ(changes.size(), 3u);
  EXPECT_EQ(changes[0].value, 0.1);
  EXPECT_FALSE(changes[0].is_unstable_beyond);
  EXPECT_EQ(changes[1].value, 0.3);
  EXPECT_EQ(changes[1].frequency, 10.0);
  EXPECT_TRUE(changes[1].is_unstable_beyond);
  EXPECT_EQ(changes[2].value, 0.6);
  EXPECT_FALSE(changes[2].is_unstable_beyond);
  EXPECT_TRUE(stability_changes({{0.0, 1.0}, {}, {}, {}, {}, {}, 0, 0}).empty());
}

TEST(TrustedFrequency, IsHalfThatOfTheHighestFixedInterfaceModeKept) {
  const Model model = make_paper_model(paper_model());
  double lowest = std::numeric_limits<double>::infinity();
  for (const SystemBody& body : model.system.bodies) {
    const Eigen::VectorXd squares =
        body.reduced.stiffness.diagonal().tail(body.reduced.size() - body.reduced.num_interface);
    lowest = std::min(lowest, std::sqrt(squares.maxCoeff()));
  }
  EXPECT_NEAR(trusted_frequency(model.system), 0.5 * lowest / (2.0 * std::numbers::pi),
              1e-9 * lowest);
  System rigid;
  rigid.bodies.emplace_back();
  EXPECT_EQ(trusted_frequency(rigid), std::numeric_limits<double>::infinity());
}

TEST(IsGrowing, LeavesRoomForRounding) {
  EXPECT_FALSE(is_growing({{1e-9, 1e5}, 0.0}));
  EXPECT_TRUE(is_growing({{1e-3, 1e5}, 0.0}));
  EXPECT_FALSE(is_growing({{-1.0, 1e5}, 0.0}));
}

TEST(BodyStabilityFamily, NamesTheValuesWhereThereIsNoEquilibrium) {
  const LoadedScene loaded =
      load_scene(scene_path("beam_on_beam.yaml"), {"contact.assumption=film"});
  const NumericKey start = find_stability_key(loaded.scene, "contact.start", "--parameter");
  // A load that lifts the oblique beam off the cantilever: nothing holds it any more.
  BodyStabilityFamily family(loaded,
                             {start, find_stability_key(loaded.scene, "drive.load", "--parameter")},
                             ContactGeometry::deformed);
  EXPECT_THAT(
      message_of<NumericalError>([&] {
        family.at(std::array{0.0999, 0.2});
      }),
      HasSubstr("no sliding equilibrium at contact.start = 0.0999 m, drive.load = 0.2 N: "));
}

TEST(BodyStabilityFamily, ContactStandsWhereItIsWantedInEitherGeometry) {
  const LoadedScene loaded = load_scene(scene_path("beam_on_beam.yaml"), {});
  const NumericKey start = find_stability_key(loaded.scene, "contact.start", "--parameter");
  BodyStabilityFamily undeformed(loaded, {start}, ContactGeometry::undeformed);
  BodyStabilityFamily deformed(loaded, {start}, ContactGeometry::deformed);
  const SlidingState straight = undeformed.at(std::array{0.048});
  const SlidingState bent = deformed.at(std::array{0.048});
  EXPECT_NEAR(straight.equilibrium.contacts[0].position, 0.048, 1e-12);
  EXPECT_NEAR(bent.equilibrium.contacts[0].position, 0.048, 1e-12);
  // The tip is bent back by friction, so the drive has gone farther.
  EXPECT_NEAR(straight.equilibrium.state.drive_displacement, 0.018, 1e-12);
  EXPECT_GT(bent.equilibrium.state.drive_displacement, 0.018 + 1e-5);
  EXPECT_LT(bent.equilibrium.state.drive_displacement, 0.018 + 2e-4);
}

TEST(BodyStabilityFamily, KinksAreTheMasterNodes) {
  const LoadedScene loaded = load_scene(scene_path("beam_on_beam.yaml"), {});
  const NumericKey start = find_stability_key(loaded.scene, "contact.start", "--parameter");
  BodyStabilityFamily undeformed(loaded, {start}, ContactGeometry::undeformed);
  const auto nodes = undeformed.along(0, {0.03}, 0.0305, 0.0335).kinks;
  ASSERT_EQ(nodes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(nodes[i], 0.031 + 0.001 * static_cast<double>(i), 1e-12);
  BodyStabilityFamily friction(
      loaded, {find_stability_key(loaded.scene, "contact.friction.coefficient", "--parameter")},
      ContactGeometry::undeformed);
  EXPECT_TRUE(friction.along(0, {0.3}, 0.1, 0.4).kinks.empty());
}

/// Rows whose product all but vanishes, and what the rounding of 1 against that does to eigenvalues.
constexpr double jammed_product = 6e-14;
constexpr double jammed_rounding = std::numeric_limits<double>::epsilon() / jammed_product;

/// Two modes that a circulatory term v couples, and two more whose contact almost jams:
/// b_C b_Eᵀ = 6e-14, so that the secular function has zeros too far away to be found, and rounding
/// in the dense method is magnified by the inverse of that.
class NearlyJammed : public StabilityFamily {
 public:
  Pencil pencil(std::span<const double> values) override { return of(values[0]); }
  double trusted_frequency(std::span<const double>) override {
    return std::numeric_limits<double>::infinity();
  }
  static Pencil of(double v) {
    Pencil pencil = constrained_modes(
        Eigen::Vector4d(0.3, 0.45, 1.0, 2.0), Eigen::Vector4d(0.02, 0.03, 0.0, 0.0),
        Eigen::RowVector4d(0.0, 0.0, 1.0, 1.0), Eigen::RowVector4d(0.0, 0.0, 1.0, jammed_product - 1.0));
    pencil.port_stiffness = Eigen::Matrix4d::Zero();
    pencil.port_stiffness.topLeftCorner<2, 2>() = circulatory(v);
    return pencil;
  }
  /// The two modes alone.
  static Pencil coupled_modes_of(double v) {
    Pencil pencil = two_masses({0.09, 0.2025}, {0.02, 0.03});
    pencil.port_stiffness = circulatory(v);
    return pencil;
  }
};

TEST(DenseFallback, FindsWhatTheSearchForZerosMisses) {
  EXPECT_THROW(secular_eigenvalues(NearlyJammed::of(0.05), {}), SearchFailure);
  const LowestEigenvalues found =
      find_lowest(NearlyJammed::of(0.05), EigenvalueMethod::secular, {2, 1.0});
  EXPECT_EQ(found.method, EigenvalueMethod::dense);
  EXPECT_THAT(found.remark, HasSubstr("did not converge: all 6 eigenvalues by the dense method"));
  const auto expected = dense_eigenvalues(NearlyJammed::coupled_modes_of(0.05));
  ASSERT_EQ(found.eigenvalues.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LT(std::abs(found.eigenvalues[i].s - expected[i].s), jammed_rounding);
}

TEST(DenseFallback, LocusHasTheWindowOfTheModesThatAreCoupled) {
  const NumericKey coupling{"parameters.v", "", {}, false};
  NearlyJammed family;
  LocusOptions options;
  options.window.frequency = 1.0;
  const std::vector<double> range{0.0, 0.05, 0.1};
  const Locus locus = locus_along(family, coupling, 0, {0.0}, range, options);
  const Locus expected = trace_locus(
      {[](double v, Pencil& pencil) { pencil = NearlyJammed::coupled_modes_of(v); }, {}}, range,
      options);
  ASSERT_EQ(expected.unstable.size(), 1u);
  ASSERT_EQ(locus.unstable.size(), 1u);
  EXPECT_NEAR(locus.unstable[0].from, expected.unstable[0].from, jammed_rounding);
  EXPECT_NEAR(locus.unstable[0].growth_max, expected.unstable[0].growth_max, jammed_rounding);
  EXPECT_EQ(stability_changes(locus).size(), 1u);
  for (std::size_t i = 0; i < range.size(); ++i) {
    ASSERT_EQ(locus.eigenvalues[i].size(), expected.eigenvalues[i].size());
    for (std::size_t k = 0; k < expected.eigenvalues[i].size(); ++k)
      EXPECT_LT(std::abs(locus.eigenvalues[i][k] - expected.eigenvalues[i][k]), jammed_rounding);
  }
}

}  // namespace
}  // namespace stridor
