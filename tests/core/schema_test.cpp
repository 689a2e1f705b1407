#include "core/schema.hpp"
#include "tests/support/constants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace stridor {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

using test::infinity;
using test::not_a_number;

enum class Colour { red, green };

struct Spring {
  double stiffness = 0.0;
  std::optional<double> preload;
  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<Spring>("spring")
            .real("stiffness", &Spring::stiffness,
                  {.doc = "Stiffness.", .unit = "N m-1", .range = Range::positive()})
            .real("preload", &Spring::preload, {.doc = "Preload.", .unit = "N", .optional = true})
            .check([](const Spring& spring, std::vector<Problem>& problems) {
              if (spring.preload && *spring.preload > spring.stiffness)
                problems.push_back({Refusal::wrong_value, "preload", "exceeds the stiffness"});
            });
    return keys;
  }
};

struct Damper {
  double viscosity = 3.0;
  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<Damper>("damper").real("viscosity", &Damper::viscosity, {.doc = "Viscosity."});
    return keys;
  }
};

struct Everything {
  bool flag = true;
  int number = 4;
  std::uint8_t small = 0;
  std::optional<std::int64_t> large;
  double real = 1.5;
  std::string text = "hello";
  Colour colour = Colour::green;
  std::vector<double> reals{1.0, 2.0};
  std::vector<std::string> texts{"a"};
  TimeCurve curve{0.5};
  Spring nested{7.0, {}};
  std::optional<Spring> maybe;
  std::map<std::string, Spring> springs;
  std::map<std::string, std::variant<Spring, Damper>> parts;
  std::vector<Spring> row;

  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<Everything>("everything")
            .flag("flag", &Everything::flag, {.doc = "A flag.", .optional = true})
            .integer("number", &Everything::number,
                     {.doc = "An integer.", .range = Range::between(1, 10)})
            .integer("small", &Everything::small, {.doc = "A small integer."})
            .integer("large", &Everything::large, {.doc = "A large integer.", .optional = true})
            .real("real", &Everything::real, {.doc = "A real.", .unit = "m"})
            .text("text", &Everything::text, {.doc = "A text."})
            .choice("colour", &Everything::colour, {{"red", Colour::red}, {"green", Colour::green}},
                    {.doc = "A colour.", .optional = true})
            .real_list("reals", &Everything::reals, {.doc = "Reals.", .unit = "s"})
            .text_list("texts", &Everything::texts, {.doc = "Texts."})
            .curve("curve", &Everything::curve, {.doc = "A curve.", .unit = "N"})
            .section("nested", &Everything::nested, {.doc = "A spring."})
            .section("maybe", &Everything::maybe, {.doc = "A spring or none.", .optional = true})
            .named_sections("springs", &Everything::springs, {.doc = "Springs by name."})
            .named_variants("parts", &Everything::parts, "type", {"spring", "damper"},
                            {.doc = "Parts by name."})
            .section_list("row", &Everything::row, {.doc = "Springs in a row."});
    return keys;
  }
};

/// Keys of Spring, taken into the map of the outer struct.
struct Outer {
  double mass = 2.0;
  Spring spring{5.0, {}};
  Everything all;
  static const Schema& schema() {
    static const Schema keys = SchemaOf<Outer>("outer")
                                   .real("mass", &Outer::mass, {.doc = "Mass.", .unit = "kg"})
                                   .include(&Outer::spring)
                                   .include(&Outer::all);
    return keys;
  }
};

const Key& key_of(const Schema& schema, const std::string& name) {
  const Key* key = schema.find(name);
  if (key == nullptr) throw std::out_of_range(name);
  return *key;
}

/// (name, alternative, struct) of every entry of a section key.
using Entries = std::vector<std::tuple<std::string, std::size_t, const void*>>;
Entries entries(const Key& key, const void* object) {
  Entries seen;
  key.visit(object, [&](const std::string& name, std::size_t alternative, const void* entry) {
    seen.emplace_back(name, alternative, entry);
  });
  return seen;
}

TEST(Range, TextSaysTheBounds) {
  EXPECT_EQ(Range::any().text(), "a finite number");
  EXPECT_EQ(Range::positive().text(), "> 0");
  EXPECT_EQ(Range::non_negative().text(), ">= 0");
  EXPECT_EQ(Range::between(1, 10).text(), "in [1, 10]");
  EXPECT_EQ(Range::inside(-1.0, 0.5).text(), "in (-1, 0.5)");
  EXPECT_EQ((Range{0.0, 1.0, true, false}.text()), "in (0, 1]");
  EXPECT_EQ((Range{0.0, 1.0, false, true}.text()), "in [0, 1)");
  EXPECT_EQ((Range{-infinity, 3.0, false, true}.text()), "< 3");
  EXPECT_EQ((Range{-infinity, 3.0, false, false}.text()), "<= 3");
}

TEST(Range, ClosedBoundsBelongToIt) {
  const Range range = Range::between(1.0, 10.0);
  EXPECT_TRUE(range.contains(1.0));
  EXPECT_TRUE(range.contains(10.0));
  EXPECT_FALSE(range.contains(std::nextafter(1.0, 0.0)));
  EXPECT_FALSE(range.contains(std::nextafter(10.0, 11.0)));
}

TEST(Range, OpenBoundsDoNotBelongToIt) {
  const Range range = Range::inside(-1.0, 0.5);
  EXPECT_FALSE(range.contains(-1.0));
  EXPECT_FALSE(range.contains(0.5));
  EXPECT_TRUE(range.contains(std::nextafter(-1.0, 0.0)));
  EXPECT_TRUE(range.contains(std::nextafter(0.5, 0.0)));
}

TEST(Range, ZeroIsNotPositiveButNonNegative) {
  for (const double zero : {0.0, -0.0}) {
    EXPECT_FALSE(Range::positive().contains(zero));
    EXPECT_TRUE(Range::non_negative().contains(zero));
  }
  EXPECT_TRUE(Range::positive().contains(std::numeric_limits<double>::denorm_min()));
  EXPECT_FALSE(Range::non_negative().contains(-std::numeric_limits<double>::denorm_min()));
}

TEST(Range, NoRangeContainsWhatIsNotFinite) {
  for (const Range& range : {Range::any(), Range::positive(), Range::non_negative(),
                             Range::between(-infinity, infinity), Range::inside(-1.0, 1.0)}) {
    EXPECT_FALSE(range.contains(not_a_number)) << range.text();
    EXPECT_FALSE(range.contains(infinity)) << range.text();
    EXPECT_FALSE(range.contains(-infinity)) << range.text();
  }
  EXPECT_TRUE(Range::any().contains(std::numeric_limits<double>::max()));
  EXPECT_TRUE(Range::any().contains(std::numeric_limits<double>::lowest()));
}

TEST(Schema, FindsKeysByTheirExactName) {
  const Schema& schema = Spring::schema();
  ASSERT_NE(schema.find("stiffness"), nullptr);
  EXPECT_EQ(schema.find("stiffness")->name, "stiffness");
  EXPECT_EQ(schema.find("Stiffness"), nullptr);
  EXPECT_EQ(schema.find(""), nullptr);
}

TEST(Schema, KeepsWhatIsDeclaredInOrder) {
  const Schema& schema = Spring::schema();
  EXPECT_EQ(schema.name, "spring");
  ASSERT_THAT(schema.keys, SizeIs(2));
  EXPECT_EQ(schema.keys[0].name, "stiffness");
  EXPECT_EQ(schema.keys[0].kind, KeyKind::real);
  EXPECT_EQ(schema.keys[0].doc, "Stiffness.");
  EXPECT_EQ(schema.keys[0].unit, "N m-1");
  EXPECT_EQ(schema.keys[0].range.text(), "> 0");
  EXPECT_FALSE(schema.keys[0].is_optional);
  EXPECT_EQ(schema.keys[1].name, "preload");
  EXPECT_TRUE(schema.keys[1].is_optional);
}

TEST(Schema, KindFollowsTheDeclaration) {
  const Schema& schema = Everything::schema();
  EXPECT_EQ(key_of(schema, "flag").kind, KeyKind::flag);
  EXPECT_EQ(key_of(schema, "number").kind, KeyKind::integer);
  EXPECT_EQ(key_of(schema, "real").kind, KeyKind::real);
  EXPECT_EQ(key_of(schema, "text").kind, KeyKind::text);
  EXPECT_EQ(key_of(schema, "colour").kind, KeyKind::choice);
  EXPECT_EQ(key_of(schema, "reals").kind, KeyKind::real_list);
  EXPECT_EQ(key_of(schema, "texts").kind, KeyKind::text_list);
  EXPECT_EQ(key_of(schema, "curve").kind, KeyKind::curve);
  EXPECT_EQ(key_of(schema, "nested").kind, KeyKind::section);
  EXPECT_EQ(key_of(schema, "springs").kind, KeyKind::named_sections);
  EXPECT_EQ(key_of(schema, "parts").kind, KeyKind::named_sections);
  EXPECT_EQ(key_of(schema, "row").kind, KeyKind::section_list);
}

TEST(Schema, DefaultsAreThoseOfADefaultConstructedStruct) {
  const Schema& schema = Everything::schema();
  const auto default_of = [&](const std::string& name) {
    return schema.default_of(key_of(schema, name));
  };
  EXPECT_EQ(default_of("flag"), Value(true));
  EXPECT_EQ(default_of("number"), Value(std::int64_t{4}));
  EXPECT_EQ(default_of("large"), Value());
  EXPECT_EQ(default_of("real"), Value(1.5));
  EXPECT_EQ(default_of("text"), Value(std::string("hello")));
  EXPECT_EQ(default_of("colour"), Value(std::string("green")));
  EXPECT_EQ(default_of("reals"), Value(std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(default_of("texts"), Value(std::vector<std::string>{"a"}));
  EXPECT_EQ(default_of("curve"), Value(0.5));
  EXPECT_EQ(default_of("nested"), Value());
}

TEST(Schema, WhatIsAssignedIsReadBack) {
  const Schema& schema = Everything::schema();
  const std::vector<std::pair<std::string, Value>> given{
      {"flag", false},
      {"number", std::int64_t{9}},
      {"large", std::int64_t{1} << 60},
      {"real", -0.25},
      {"text", std::string("other")},
      {"colour", std::string("red")},
      {"reals", std::vector<double>{3.0}},
      {"texts", std::vector<std::string>{"x", "y"}},
      {"curve", TimeTable{{0.0, 1.0}, {2.0, 3.0}}}};
  Everything all;
  for (const auto& [name, value] : given) key_of(schema, name).assign(&all, value);
  for (const auto& [name, value] : given) EXPECT_EQ(key_of(schema, name).read(&all), value) << name;
  EXPECT_FALSE(all.flag);
  EXPECT_EQ(all.number, 9);
  EXPECT_EQ(all.large, std::int64_t{1} << 60);
  EXPECT_EQ(all.real, -0.25);
  EXPECT_EQ(all.text, "other");
  EXPECT_EQ(all.colour, Colour::red);
  EXPECT_EQ(all.curve.value(1.0), 3.0);
}

TEST(Schema, CurveTakesANumber) {
  Everything all;
  key_of(Everything::schema(), "curve").assign(&all, Value(-0.2));
  EXPECT_TRUE(all.curve.is_constant());
  EXPECT_EQ(all.curve.value(1.0), -0.2);
}

TEST(Schema, OptionalMemberIsEmptyUntilItIsAssigned) {
  const Key& key = key_of(Spring::schema(), "preload");
  Spring spring;
  EXPECT_EQ(key.read(&spring), Value());
  key.assign(&spring, Value(2.0));
  EXPECT_EQ(spring.preload, 2.0);
  EXPECT_EQ(key.read(&spring), Value(2.0));
}

TEST(Schema, IntegerKnowsWhatItsMemberCanHold) {
  const Schema& schema = Everything::schema();
  const Range small = key_of(schema, "small").storable;
  EXPECT_TRUE(small.contains(255.0));
  EXPECT_FALSE(small.contains(256.0));
  EXPECT_FALSE(small.contains(-1.0));
  const Range number = key_of(schema, "number").storable;
  EXPECT_TRUE(number.contains(2147483647.0));
  EXPECT_FALSE(number.contains(2147483648.0));
  EXPECT_TRUE(key_of(schema, "large").storable.contains(2147483648.0));
  EXPECT_EQ(key_of(schema, "number").range.text(), "in [1, 10]");
}

TEST(Schema, ChoiceListsItsTextsInOrder) {
  EXPECT_THAT(key_of(Everything::schema(), "colour").choices, ElementsAre("red", "green"));
}

TEST(Schema, SectionOpensTheNestedStruct) {
  const Key& key = key_of(Everything::schema(), "nested");
  Everything all;
  EXPECT_EQ(key.open(&all, "", 0), &all.nested);
  EXPECT_EQ(entries(key, &all), (Entries{{"", 0, &all.nested}}));
  ASSERT_THAT(key.alternatives, SizeIs(1));
  EXPECT_EQ(&key.alternatives[0].schema(), &Spring::schema());
}

TEST(Schema, OptionalSectionIsAbsentUntilItIsOpened) {
  const Key& key = key_of(Everything::schema(), "maybe");
  Everything all;
  EXPECT_THAT(entries(key, &all), IsEmpty());
  void* const opened = key.open(&all, "", 0);
  ASSERT_TRUE(all.maybe.has_value());
  EXPECT_EQ(opened, &*all.maybe);
  EXPECT_EQ(entries(key, &all), (Entries{{"", 0, &*all.maybe}}));
}

TEST(Schema, NamedSectionsAreMadeByName) {
  const Key& key = key_of(Everything::schema(), "springs");
  Everything all;
  static_cast<Spring*>(key.open(&all, "b", 0))->stiffness = 2.0;
  static_cast<Spring*>(key.open(&all, "a", 0))->stiffness = 1.0;
  ASSERT_THAT(all.springs, SizeIs(2));
  EXPECT_EQ(all.springs["a"].stiffness, 1.0);
  EXPECT_EQ(all.springs["b"].stiffness, 2.0);
  EXPECT_EQ(entries(key, &all),
            (Entries{{"a", 0, &all.springs["a"]}, {"b", 0, &all.springs["b"]}}));
}

TEST(Schema, SectionListGrowsByOnePerEntry) {
  const Key& key = key_of(Everything::schema(), "row");
  Everything all;
  static_cast<Spring*>(key.open(&all, "", 0))->stiffness = 1.0;
  static_cast<Spring*>(key.open(&all, "", 0))->stiffness = 2.0;
  ASSERT_THAT(all.row, SizeIs(2));
  EXPECT_EQ(all.row[0].stiffness, 1.0);
  EXPECT_EQ(all.row[1].stiffness, 2.0);
  EXPECT_EQ(entries(key, &all), (Entries{{"", 0, &all.row[0]}, {"", 0, &all.row[1]}}));
}

TEST(Schema, VariantIsMadeByItsAlternative) {
  const Key& key = key_of(Everything::schema(), "parts");
  EXPECT_EQ(key.discriminator, "type");
  ASSERT_THAT(key.alternatives, SizeIs(2));
  EXPECT_EQ(key.alternatives[0].name, "spring");
  EXPECT_EQ(&key.alternatives[0].schema(), &Spring::schema());
  EXPECT_EQ(key.alternatives[1].name, "damper");
  EXPECT_EQ(&key.alternatives[1].schema(), &Damper::schema());

  Everything all;
  static_cast<Damper*>(key.open(&all, "d", 1))->viscosity = 9.0;
  static_cast<Spring*>(key.open(&all, "s", 0))->stiffness = 8.0;
  ASSERT_TRUE(std::holds_alternative<Damper>(all.parts["d"]));
  ASSERT_TRUE(std::holds_alternative<Spring>(all.parts["s"]));
  EXPECT_EQ(std::get<Damper>(all.parts["d"]).viscosity, 9.0);
  EXPECT_EQ(std::get<Spring>(all.parts["s"]).stiffness, 8.0);
  EXPECT_EQ(entries(key, &all), (Entries{{"d", 1, &std::get<Damper>(all.parts["d"])},
                                         {"s", 0, &std::get<Spring>(all.parts["s"])}}));
}

TEST(Schema, IncludedKeysStandOnTheOuterLevelAndFillTheInnerStruct) {
  const Schema& schema = Outer::schema();
  Outer outer;
  key_of(schema, "stiffness").assign(&outer, Value(11.0));
  EXPECT_EQ(outer.spring.stiffness, 11.0);
  EXPECT_EQ(key_of(schema, "stiffness").read(&outer), Value(11.0));
  EXPECT_EQ(key_of(schema, "stiffness").unit, "N m-1");
  key_of(schema, "colour").assign(&outer, Value(std::string("red")));
  EXPECT_EQ(outer.all.colour, Colour::red);
  EXPECT_EQ(schema.keys.size(),
            1 + Spring::schema().keys.size() + Everything::schema().keys.size());
}

TEST(Schema, IncludedSectionsOpenInTheInnerStruct) {
  const Schema& schema = Outer::schema();
  Outer outer;
  EXPECT_EQ(key_of(schema, "nested").open(&outer, "", 0), &outer.all.nested);
  static_cast<Damper*>(key_of(schema, "parts").open(&outer, "d", 1))->viscosity = 4.0;
  EXPECT_EQ(std::get<Damper>(outer.all.parts.at("d")).viscosity, 4.0);
  EXPECT_EQ(entries(key_of(schema, "parts"), &outer),
            (Entries{{"d", 1, &std::get<Damper>(outer.all.parts.at("d"))}}));
}

TEST(Schema, IncludedDefaultsAreThoseTheOuterStructGives) {
  const Schema& schema = Outer::schema();
  EXPECT_EQ(schema.default_of(key_of(schema, "stiffness")), Value(5.0));
  EXPECT_EQ(schema.default_of(key_of(schema, "mass")), Value(2.0));
}

TEST(Schema, ChecksSeeTheWholeStructAndAddTheirProblems) {
  std::vector<Problem> problems;
  Spring spring{1.0, 0.5};
  for (const auto& check : Spring::schema().checks) check(&spring, problems);
  EXPECT_THAT(problems, IsEmpty());
  spring.preload = 2.0;
  for (const auto& check : Spring::schema().checks) check(&spring, problems);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].text(), "preload: exceeds the stiffness");
}

TEST(Schema, IncludedChecksSeeTheInnerStruct) {
  Outer outer;
  outer.spring = {1.0, 2.0};
  std::vector<Problem> problems;
  for (const auto& check : Outer::schema().checks) check(&outer, problems);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].text(), "preload: exceeds the stiffness");
}

}  // namespace
}  // namespace stridor
