// Refusal of steps that grow by themselves, against dense eigenvalues of random bodies.
#include "analysis/step_guard.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/face_contacts.hpp"
#include "tests/support/face_system.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/step_growth_cases.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::_;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST(StepGuard, FindsAllAndOnlyStepsThatGrowByThemselves) {
  const StepGrowthCases found = uncoupled_cases(1, 31);
  RecordProperty("cases", found.summary());
  EXPECT_THAT(found.missed, IsEmpty());
  EXPECT_THAT(found.refused, IsEmpty());
  EXPECT_GT(found.cases, 400) << found.summary();
  EXPECT_GT(found.by_itself, 5) << found.summary();
  EXPECT_GT(found.bodies, 20) << found.summary();
}

TEST(StepGuard, FindsAllAndOnlyStepsOfCoupledBodiesThatGrowByThemselves) {
  const StepGrowthCases found = coupled_cases(1, 76);
  RecordProperty("cases", found.summary());
  EXPECT_THAT(found.missed, IsEmpty());
  EXPECT_THAT(found.refused, IsEmpty());
  EXPECT_GT(found.cases, 200) << found.summary();
  EXPECT_GT(found.by_itself, 3) << found.summary();
}

/// Two systems beside each other that do not touch.
System beside(System one, const System& other) {
  const auto num_bodies = static_cast<int>(one.bodies.size());
  const auto num_surfaces = static_cast<int>(one.surfaces.size());
  one.bodies.insert(one.bodies.end(), other.bodies.begin(), other.bodies.end());
  for (MasterSurface surface : other.surfaces) {
    surface.body += num_bodies;
    one.surfaces.push_back(surface);
  }
  for (ContactPoint contact : other.contacts) {
    contact.slave_body += num_bodies;
    contact.surface += num_surfaces;
    one.contacts.push_back(contact);
  }
  return one;
}

TEST(StepGuard, GrowthOfBodiesElsewhereExcusesNothing) {
  int hidden = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const System growing = random_sliding_bodies(seed, 0.6, true);
    for (const double share : {0.5, 1.0, 2.0}) {
      const TimeParameters time = steps_of(Integrator::exact, share * step_limit(growing).step);
      const auto truth = [&](const System& system) {
        return truth_of(system, time, held_contacts(system, time).front().rows);
      };
      if (truth(growing) != StepTruth::by_itself) continue;
      for (unsigned other = 100; other < 120; ++other) {
        const System fluttering = random_sliding_bodies(other, 0.6, false);
        if (truth(fluttering) != StepTruth::bodies) continue;
        EXPECT_FALSE(own_growth(fluttering, time, held_contacts(fluttering, time)));
        const System both = beside(growing, fluttering);
        // Of several contacts the instantaneous response gets more, which may cure the step.
        if (truth(both) != StepTruth::by_itself) continue;
        EXPECT_TRUE(own_growth(both, time, held_contacts(both, time)))
            << "seeds " << seed << " and " << other;
        ++hidden;
      }
    }
  }
  EXPECT_GT(hidden, 5);
}

TEST(StepGuard, HoldsContactsInEveryStateThatMatters) {
  const auto names = [](const System& system) {
    std::vector<std::string> found;
    for (const HeldContacts& held : held_contacts(system, steps_of(Integrator::exact, 1e-3)))
      found.push_back(held.name);
    return found;
  };
  System system = random_sliding_bodies(1, 0.3, true, 9);
  system.contacts[8].name = "last";
  EXPECT_THAT(names(system),
              ElementsAre(StartsWith("9 contacts from 'contact' to 'last' sliding")));
  system = random_sliding_bodies(1, 0.3, true, 2);
  system.contacts[1].name = "other";
  EXPECT_THAT(names(system), ElementsAre(StartsWith("'contact', 'other' sliding at")));
  for (ContactPoint& contact : system.contacts) contact.assumption = ContactAssumption::film;
  EXPECT_THAT(names(system), ElementsAre(StartsWith("'contact', 'other' sliding"),
                                         StartsWith("'contact' sliding alone"),
                                         StartsWith("'other' sliding alone")));
  system = with_coupling(system, 1, {.gyroscopic = 0.1});
  EXPECT_THAT(names(system), ElementsAre(_, _, _, StartsWith("'contact', 'other' sticking")));
  for (ContactPoint& contact : system.contacts) contact.friction = constant_friction(0.0);
  EXPECT_EQ(names(system).size(), 3u);
  system.contacts[0].substrate.emplace();
  EXPECT_THAT(names(system), IsEmpty());
  system.contacts.clear();
  EXPECT_THAT(names(system), IsEmpty());
}

TEST(StepGuard, PlacesFollowThePathOfTheDrive) {
  const auto count = [](double moved, double gyroscopic) {
    System system = random_sliding_bodies(4, 0.0, true);
    system.contacts[0].slave_position.x() = 0.5;
    system.contacts[0].first_segment = 0;
    system.drives[0].is_frozen = false;
    system.drives[0].velocity = TimeCurve(moved);
    if (gyroscopic > 0.0) system = with_coupling(system, 1, {.gyroscopic = gyroscopic});
    TimeParameters time = steps_of(Integrator::exact, 1e-4);
    time.end = 1.0;
    return held_contacts(system, time).size();
  };
  // Segments of 1 m.
  EXPECT_EQ(count(0.49, 0.0), 1u);
  EXPECT_EQ(count(1.01, 0.0), 3u);
  EXPECT_EQ(count(2.0, 0.0), 5u);
  EXPECT_EQ(count(2.0, 0.1), 3u);
  // Beyond the end of the master there is nothing to hold.
  EXPECT_LT(count(20.0, 0.0), 4u);
}

TEST(StepGuard, NamesContactPlaceGrowthStepAndRemedy) {
  for (unsigned seed = 1;; ++seed) {
    ASSERT_LT(seed, 200u);
    System system = random_sliding_bodies(seed, 0.3, false);
    const TimeParameters time =
        steps_of(Integrator::central_difference, 0.999 * step_limit(system).step);
    const auto held = held_contacts(system, time);
    const auto found = own_growth(system, time, held);
    if (!found) continue;
    const StepRemedy remedy = step_remedy(system, time, held);
    ASSERT_TRUE(remedy.step);
    EXPECT_THAT(message_of<NumericalError>([&] { require_no_own_growth(system, time); }),
                AllOf(HasSubstr(fmt::format("time.step: with a step of {:.6g} s", time.step)),
                      HasSubstr(fmt::format("grows by {:.4g} 1/s", found->stability.growth)),
                      HasSubstr("'contact' sliding at"),
                      HasSubstr(fmt::format("take time.step: {:.6g}", *remedy.step))));
    EXPECT_THROW(make_run_simulation(system, time), NumericalError);
    TimeParameters finer = time;
    finer.step = *remedy.step;
    EXPECT_NO_THROW(make_run_simulation(system, finer));
    // A tenth until the end is no matter.
    finer = time;
    finer.end = 0.05 / found->stability.growth;
    EXPECT_NO_THROW(require_no_own_growth(system, finer));
    return;
  }
}

TEST(StepGuard, HoldsContactsOnFacesInBothTangents) {
  DiscModelParameters brake = test::squealing_brake();
  brake.contact.formulation = ContactFormulation::lagrange;
  const System system = test::disc_system(brake);
  TimeParameters time;
  time.integrator = Integrator::exact;
  time.step = 2e-6;
  time.end = 0.1;
  const std::vector<HeldContacts> held = held_contacts(system, time);
  // Both sliding, each alone, and both sticking with a normal and two tangents each.
  ASSERT_EQ(held.size(), 4U);
  EXPECT_THAT(held[0].name, HasSubstr("'upper[0]', 'lower[0]' sliding at a radius of 0.13 m"));
  EXPECT_EQ(held[0].rows.num_constraints(), 2);
  EXPECT_THAT(held[3].name, HasSubstr("sticking"));
  EXPECT_EQ(held[3].rows.num_constraints(), 6);
  // The squeal is that of the bodies, whatever the step; damped bodies that stick decay.
  for (const double step : {2e-6, 1e-5, 4e-5}) {
    time.step = step;
    EXPECT_NO_THROW(require_no_own_growth(system, time)) << step;
  }
  const FrozenStep frozen(system, time);
  EXPECT_GT(spectral_radius(frozen.factors(held[0].rows)), 1.0);
  EXPECT_LT(spectral_radius(frozen.factors(held[3].rows)), 1.0);
  // Coupled modes turn by at most 2 in a step.
  time.step = 1e-4;
  EXPECT_THAT(message_of<ConfigError>([&] { require_no_own_growth(system, time); }),
              HasSubstr("take a step of 5.59e-05 s or less"));
}

// Twice as many contacts that stick at the same places are as many constraints again, of the same
// rank.
TEST(StepGuard, ContactsThatStickHoldNoMotionTwice) {
  DiscModelParameters brake = test::squealing_brake();
  brake.contact.formulation = ContactFormulation::lagrange;
  System system = test::disc_system(brake);
  TimeParameters time;
  time.integrator = Integrator::exact;
  time.step = 2e-6;
  time.end = 0.1;
  const HeldContacts once = held_contacts(system, time).back();
  const std::vector<ContactPoint> contacts = system.contacts;
  system.contacts.insert(system.contacts.end(), contacts.begin(), contacts.end());
  const HeldContacts twice = held_contacts(system, time).back();
  ASSERT_THAT(twice.name, HasSubstr("sticking"));
  EXPECT_EQ(twice.rows.num_constraints(), once.rows.num_constraints());
  EXPECT_EQ(twice.rows.equilibrium, twice.rows.compatibility);
  const auto radius_of = [&](const HeldContacts& held) {
    return spectral_radius(FrozenStep(system, time).factors(held.rows));
  };
  EXPECT_NEAR(radius_of(twice),
              spectral_radius(FrozenStep(test::disc_system(brake), time).factors(once.rows)), 1e-9);
}

}  // namespace
}  // namespace stridor
