#include "substructures/elements/viscoelastic_material.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace stridor {
namespace {

ViscoelasticMaterial rubber() {
  ViscoelasticMaterial material;
  material.rubbery_modulus = 1e6;
  material.glassy_modulus = 1e7;
  material.poissons_ratio = 0.5;
  material.creep_times = {0.01};
  return material;
}

TEST(ViscoelasticMaterial, ModulusGoesFromRubberyToGlassy) {
  const ViscoelasticMaterial material = rubber();
  EXPECT_NEAR(material.modulus(0.0).real(), 1e6, 1e-9);
  EXPECT_EQ(material.modulus(0.0).imag(), 0.0);
  // 1 − O(1/(e0 ω τ)) of it.
  EXPECT_NEAR(std::abs(material.modulus(1e12)) / 1e7, 1.0, 1e-8);
  EXPECT_DOUBLE_EQ(material.composite_modulus(), 1e6 / 0.75);
}

TEST(ViscoelasticMaterial, OneTimeHasItsLossPeakBetweenCreepAndRelaxation) {
  // tan φ = (1 − e0) ω τ/(1 + e0 ω² τ²), largest at ω τ = e0^−½: (1 − e0)/(2 e0^½).
  const ViscoelasticMaterial material = rubber();
  const double omega = 100.0 / std::sqrt(0.1);
  const std::complex<double> modulus = material.modulus(omega);
  EXPECT_NEAR(modulus.imag() / modulus.real(), 0.9 / (2.0 * std::sqrt(0.1)), 1e-12);
  EXPECT_GT(modulus.imag(), 0.0);
}

std::vector<Problem> problems_of_material(const ViscoelasticMaterial& material) {
  std::vector<Problem> problems;
  for (const auto& check : ViscoelasticMaterial::schema().checks) check(&material, problems);
  return problems;
}

TEST(ViscoelasticMaterial, SchemaChecksModuliAndShares) {
  ViscoelasticMaterial material = rubber();
  EXPECT_TRUE(problems_of_material(material).empty());
  EXPECT_DOUBLE_EQ(material.creep_weight(0), 0.9);
  const auto only_problem = [&] {
    const std::vector<Problem> problems = problems_of_material(material);
    return problems.size() == 1 ? problems[0].key + ": " + problems[0].message : "not one problem";
  };
  material.glassy_modulus = 1e6;
  EXPECT_EQ(only_problem(), "glassy_modulus: 1e+06 Pa must be above rubbery_modulus = 1e+06 Pa");
  material = rubber();
  material.creep_times.clear();
  EXPECT_EQ(only_problem(), "creep_times: needs one time or more");
  material.creep_times = {0.01, 0.1};
  EXPECT_EQ(only_problem(), "creep_shares: has 0 entries, `creep_times` 2");
  material.creep_shares = {0.5, 0.6};
  EXPECT_EQ(only_problem(), "creep_shares: must sum to 1, is 1.1");
  material.creep_shares = {0.4, 0.6};
  EXPECT_TRUE(problems_of_material(material).empty());
  EXPECT_DOUBLE_EQ(material.creep_weight(1), 0.9 * 0.6);
}

}  // namespace
}  // namespace stridor
