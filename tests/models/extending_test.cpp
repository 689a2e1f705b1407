// The worked examples of docs/extending.md: a type of body, a friction law and a normal law of one's own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "models/model.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/transient/simulation.hpp"
// example: includes
#include "core/schema.hpp"
#include "substructures/bodies/body_parameters.hpp"
#include "substructures/bodies/lumped_body.hpp"
// end of example
// example: includes of a law
#include <memory>

#include "coupling/laws/friction_law_type.hpp"
// end of example
// example: includes of a normal law
#include <cmath>
#include <memory>
#include <numbers>

#include "coupling/laws/normal_parameters.hpp"
#include "coupling/laws/viscoelastic_law.hpp"
// end of example
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "solvers/equilibrium/linearise.hpp"

namespace stridor {
namespace {

// example: a type
/// Equal masses above each other, joined by equal springs.
struct ColumnParameters : BodyParametersOf<ColumnParameters> {
  static constexpr const char* type_name = "column";

  int masses = 2;          ///< >= 2
  double mass = 0.0;       ///< of each, kg, > 0
  double stiffness = 0.0;  ///< of each spring, N/m, > 0
  static const Schema& schema();

  BodyMatrices make() const override;
};

const Schema& ColumnParameters::schema() {
  using P = ColumnParameters;
  static const Schema keys =
      SchemaOf<P>("column")
          .integer("masses", &P::masses,
                   {.doc = "Number of masses.", .range = Range::between(2, 1000)})
          .real("mass", &P::mass, {.doc = "Of each.", .unit = "kg", .range = Range::positive()})
          .real("stiffness", &P::stiffness,
                {.doc = "Of each spring.", .unit = "N m-1", .range = Range::positive()});
  return keys;
}

/// K and M of the chain; `foot` and `head` are its ends.
BodyMatrices ColumnParameters::make() const {
  LumpedParameters chain;
  chain.directions = {"y"};
  std::string below;
  for (int i = 0; i < masses; ++i) {
    const std::string name = i == 0 ? "foot" : i + 1 == masses ? "head" : std::to_string(i);
    chain.masses[name] = {mass, {0.0, 0.01 * i}};
    if (i > 0) chain.springs[name] = {{below, name}, stiffness, 0.0, {}};
    below = name;
  }
  return chain.make();
}
// end of example

TEST(Extending, BodyOfOnesOwnStandsOnTheGroundUnderALoad) {
  ColumnParameters column;
  column.masses = 4;
  column.mass = 0.1;
  column.stiffness = 1000.0;
  ModelParameters parameters;
  parameters.substructures["column"] = column;
  ContactParameters contact;
  contact.slave = {"column.foot"};
  contact.master = rigid_master;
  contact.assumption = ContactAssumption::film;
  contact.friction.emplace().numbers["coefficient"] = 0.3;
  parameters.contact = contact;
  parameters.drive.emplace().velocity = TimeCurve(0.0);
  parameters.drive->load = TimeCurve(-5.0);
  parameters.drive->load_on = {"column.head"};
  const Model model = make_model(parameters, {{{"column", "head"}, "record.channels.0"}});
  const Equilibrium rest = find_equilibrium(model.system, sliding_state(model.system, 0.0));
  ASSERT_EQ(rest.status, EquilibriumStatus::converged) << rest.failure;
  EXPECT_NEAR(rest.contacts[0].force, 5.0, 1e-12);
  const SystemBody& body = model.system.bodies[0];
  const Model::Point& head = model.points.at({"column", "head"});
  // Three springs in a row.
  EXPECT_NEAR(body.modal.rows.row(head.rows.y) * rest.displacement[0], -5.0 * 3.0 / 1000.0, 1e-13);
  TimeParameters time;
  time.step = 1e-4;
  Simulation simulation(model.system, time);
  EXPECT_EQ(simulation.step_until(1000), StepOutcome::done) << simulation.failure();
}

// example: a law
/// μ(v) = μ_d + (μ_s − μ_d)/(1 + |v|/v_h): half of the fall is done at v_h.
class HyperbolicFriction : public SlidingFriction {
 public:
  HyperbolicFriction(double rest, double fast, double half)
      : fast_(fast), fall_(rest - fast), half_(half) {}
  double coefficient(double speed) const override { return fast_ + fall_ / (1.0 + speed / half_); }
  double slope(double speed) const override {
    const double ratio = 1.0 + speed / half_;
    return -fall_ / (half_ * ratio * ratio);
  }

 private:
  double fast_, fall_, half_;
};

inline FrictionLawType hyperbolic_friction_type() {
  return {.name = "hyperbolic",
          .doc = "from `static` to `dynamic` as 1/(1 + |v|/half_velocity)",
          .keys = {static_coefficient_key(),
                   dynamic_coefficient_key(),
                   {"half_velocity",
                    {.doc = "Sliding velocity at which half of the fall is done.",
                     .unit = "m s-1",
                     .range = Range::positive()}}},
          .make = [](const FrictionNumbers& numbers) {
            const double rest = numbers.at("static");
            const double fast = numbers.at("dynamic");
            return FrictionLaw{
                rest, fast,
                std::make_shared<HyperbolicFriction>(rest, fast, numbers.at("half_velocity"))};
          }};
}
// end of example

TEST(Extending, LawOfOnesOwnHoldsAMassOnABelt) {
  static const FrictionLawType law = hyperbolic_friction_type();
  LumpedParameters slider;
  slider.masses["mass"] = {2.0, {}};
  slider.springs["spring"] = {{"mass"}, 100.0, 20.0, {}};
  ModelParameters parameters;
  parameters.substructures["slider"] = slider;
  ContactParameters contact;
  contact.slave = {"slider.mass"};
  contact.master = rigid_master;
  contact.assumption = ContactAssumption::film;
  contact.friction =
      FrictionParameters{&law, {{"static", 0.5}, {"dynamic", 0.2}, {"half_velocity", 0.05}}};
  parameters.contact = contact;
  parameters.drive.emplace().velocity = TimeCurve(0.1);
  parameters.drive->load = TimeCurve(-10.0);
  parameters.drive->moves = {"contact.master"};
  parameters.drive->load_on = {"slider.mass"};
  const Model model = make_model(parameters, {{{"slider", "mass"}, "record.channels.0"}});
  const double friction = (0.2 + 0.3 / 3.0) * 10.0;
  const double slope = -0.3 / (0.05 * 9.0) * 10.0;
  const SystemBody& body = model.system.bodies[0];
  const int row = model.points.at({"slider", "mass"}).rows.x;

  const Equilibrium rest = find_equilibrium(model.system, sliding_state(model.system, 0.0));
  ASSERT_EQ(rest.status, EquilibriumStatus::converged) << rest.failure;
  EXPECT_NEAR(body.modal.rows.row(row) * rest.displacement[0], friction / 100.0, 1e-12);
  // m ẍ + (c + T'(v)) ẋ + k x = 0 about it.
  const double half = (20.0 + slope) / (2.0 * 2.0);
  const auto list = secular_eigenvalues(linearise(model.system, rest), SpectrumWindow::lowest(1));
  ASSERT_FALSE(list.empty());
  EXPECT_NEAR(list.front().s.real(), -half, 1e-6 * half);

  // And there the motion ends.
  TimeParameters time;
  time.integrator = Integrator::exact;
  time.step = 1e-4;
  Simulation simulation(model.system, time);
  ASSERT_EQ(simulation.step_until(100'000), StepOutcome::done) << simulation.failure();
  EXPECT_NEAR(simulation.displacement(0, row), friction / 100.0, 1e-9);
}

// example: a normal law
/// Hertz: an elastic sphere on an elastic half-space, F̃ = 4/3 ŷ^{3/2}, Ã = π ŷ, at any speed.
class HertzLaw : public ViscoelasticContactLaw {
 public:
  ViscoelasticContact at(double indentation, double /*speed*/) const override {
    ViscoelasticContact contact;
    contact.range = indentation > 0.0 ? LawRange::inside : LawRange::no_contact;
    if (contact.range == LawRange::no_contact) return contact;
    const double root = std::sqrt(indentation);
    contact.force = {4.0 / 3.0 * indentation * root, 2.0 * root, 0.0};
    contact.area = {std::numbers::pi * indentation, std::numbers::pi, 0.0};
    return contact;
  }
};

inline NormalLawType hertz_law_type() {
  return {.name = "hertz",
          .doc = "each slave point carries an elastic sphere of `radius` on an elastic half-space "
                 "(master: half_space) of `modulus`",
          .keys = {indenter_radius_key(true), half_space_modulus_key(true)},
          .make_contact = [](const NormalParameters& normal) {
            const double radius = normal.numbers.at("radius");
            SubstrateContact contact;
            contact.law = std::make_shared<HertzLaw>();
            contact.indentation_unit = radius;
            contact.force_unit = normal.numbers.at("modulus") * radius * radius;
            return contact;
          }};
}
// end of example

TEST(Extending, NormalLawOfOnesOwnCarriesAMass) {
  static const NormalLawType law = hertz_law_type();
  constexpr double radius = 0.01;
  constexpr double modulus = 1e6;
  constexpr double load = 0.2;
  constexpr double mass = 0.05;
  constexpr double spring = 50.0;
  LumpedParameters slider;
  slider.masses["mass"] = {mass, {}};
  slider.springs["along"] = {{"mass"}, spring, 0.0, {}};
  ModelParameters parameters;
  parameters.substructures["slider"] = slider;
  ContactParameters contact;
  contact.slave = {"slider.mass"};
  contact.master = half_space_master;
  contact.normal.law = &law;
  contact.normal.numbers = {{"radius", radius}, {"modulus", modulus}};
  contact.friction.emplace().numbers["coefficient"] = 0.3;
  std::vector<Problem> problems;
  for (const auto& check : ContactParameters::schema().checks) check(&contact, problems);
  EXPECT_TRUE(problems.empty());
  parameters.contact = contact;
  parameters.drive.emplace().velocity = TimeCurve(0.1);
  parameters.drive->load = TimeCurve(-load);
  parameters.drive->moves = {"contact.master"};
  parameters.drive->load_on = {"slider.mass"};
  const Model model = make_model(parameters, {{{"slider", "mass"}, "record.channels.0"}});
  const SystemBody& body = model.system.bodies[0];
  const PointRows rows = model.points.at({"slider", "mass"}).rows;

  // F = 4/3 E* R^½ y^{3/2}, and friction μ F against the spring.
  const double indentation = std::cbrt(std::pow(0.75 * load / (modulus * std::sqrt(radius)), 2.0));
  const Equilibrium rest = find_equilibrium(model.system, sliding_state(model.system, 0.0));
  ASSERT_EQ(rest.status, EquilibriumStatus::converged) << rest.failure;
  EXPECT_NEAR(body.modal.rows.row(rows.y) * rest.displacement[0], -indentation, 1e-9 * indentation);
  EXPECT_NEAR(body.modal.rows.row(rows.x) * rest.displacement[0], 0.3 * load / spring,
              1e-9 * load / spring);
  // About it k_yy = 2 E* (R y)^½ and k_xy = μ k_yy alone couple the two, in one direction: ω² = k/m.
  const double stiffness = 2.0 * modulus * std::sqrt(radius * indentation);
  const auto list = secular_eigenvalues(linearise(model.system, rest), SpectrumWindow::lowest(2));
  ASSERT_EQ(list.size(), 2u);
  const double highest = std::max(list[0].s.imag(), list[1].s.imag());
  EXPECT_NEAR(highest, std::sqrt(stiffness / mass), 1e-8 * highest);
}

TEST(Extending, RegisteredLawsAreInTheSchema) {
  // What a line in friction_laws.cpp or normal_laws.cpp does for the law: its name and keys are those of scenes.
  const Schema& schema = FrictionParameters::schema();
  for (const FrictionLawType& type : friction_law_types()) {
    EXPECT_THAT(schema.find("law")->choices, ::testing::Contains(type.name));
    EXPECT_THAT(schema.find("law")->doc, ::testing::HasSubstr(type.name + ": " + type.doc));
    for (const FrictionKey& key : type.keys) {
      ASSERT_NE(schema.find(key.name), nullptr) << key.name;
      EXPECT_EQ(schema.find(key.name)->doc, key.says.doc);
    }
  }
  const Schema& normal = NormalParameters::schema();
  for (const NormalLawType& type : normal_law_types()) {
    EXPECT_THAT(normal.find("law")->choices, ::testing::Contains(type.name));
    EXPECT_THAT(normal.find("law")->doc, ::testing::HasSubstr(type.name + ": " + type.doc));
    for (const NormalKey& key : type.keys) {
      ASSERT_NE(normal.find(key.name), nullptr) << key.name;
      EXPECT_EQ(normal.find(key.name)->doc, key.says.doc);
    }
  }
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

TEST(Extending, PageShowsWhatIsCompiledHere) {
  const std::filesystem::path root = STRIDOR_SOURCE_DIR;
  const std::string page = text_of(root / "docs" / "extending.md");
  const std::string source = text_of(root / "tests" / "models" / "extending_test.cpp");
  int shown = 0;
  const std::string begin = "\n// example: ";
  for (std::size_t at = source.find(begin); at != std::string::npos;
       at = source.find(begin, at + 1)) {
    const std::size_t first = source.find('\n', at + 1) + 1;
    const std::size_t last = source.find("// end of example", first);
    ASSERT_NE(last, std::string::npos);
    const std::string example = source.substr(first, last - first);
    EXPECT_NE(page.find(example), std::string::npos) << example;
    ++shown;
  }
  EXPECT_EQ(shown, 6);
}

}  // namespace
}  // namespace stridor
