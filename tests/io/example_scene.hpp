// A small tree of parameter structs in which every kind of key occurs, and a scene that fills it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/schema.hpp"

namespace stridor::test {

struct Material {
  double youngs_modulus = 0.0;
  double poissons_ratio = 0.0;
  bool operator==(const Material&) const = default;
  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<Material>("material")
            .real("youngs_modulus", &Material::youngs_modulus,
                  {.doc = "Young's modulus.", .unit = "Pa", .range = Range::positive()})
            .real("poissons_ratio", &Material::poissons_ratio,
                  {.doc = "Poisson's ratio.", .range = Range::inside(-1.0, 0.5)});
    return keys;
  }
};

struct Beam {
  double length = 0.0;
  double angle = 0.25;
  int elements = 0;
  std::optional<std::int64_t> modes;
  Material material;
  bool operator==(const Beam&) const = default;
  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<Beam>("beam")
            .real("length", &Beam::length,
                  {.doc = "Length of the axis.", .unit = "m", .range = Range::positive()})
            .real("angle", &Beam::angle,
                  {.doc = "Angle of the axis.",
                   .unit = "rad",
                   .range = Range::between(-3.2, 3.2),
                   .optional = true})
            .integer("elements", &Beam::elements,
                     {.doc = "Elements along the axis.", .range = Range::positive()})
            .integer("modes", &Beam::modes,
                     {.doc = "Modes kept.", .optional = true, .range = Range::non_negative()})
            .section("material", &Beam::material, {.doc = "What it is made of."})
            .check([](const Beam& beam, std::vector<Problem>& problems) {
              if (beam.modes && *beam.modes > beam.elements) {
                problems.push_back({Refusal::wrong_value, "modes", "must not exceed elements"});
              }
            });
    return keys;
  }
};

struct Lumped {
  double mass = 0.0;
  bool operator==(const Lumped&) const = default;
  static const Schema& schema() {
    static const Schema keys = SchemaOf<Lumped>("lumped").real(
        "mass", &Lumped::mass, {.doc = "Mass.", .unit = "kg", .range = Range::positive()});
    return keys;
  }
};

struct Friction {
  double coefficient = 0.0;
  std::optional<double> decay_velocity;
  bool operator==(const Friction&) const = default;
  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<Friction>("friction")
            .real("coefficient", &Friction::coefficient,
                  {.doc = "Coefficient of friction.", .range = Range::non_negative()})
            .real("decay_velocity", &Friction::decay_velocity,
                  {.doc = "Velocity of the decay.",
                   .unit = "m/s",
                   .range = Range::positive(),
                   .optional = true});
    return keys;
  }
};

struct ExampleExpectation {
  std::string result;
  double value = 0.0;
  bool operator==(const ExampleExpectation&) const = default;
  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<ExampleExpectation>("expectation")
            .text("result", &ExampleExpectation::result, {.doc = "Result."})
            .real("value", &ExampleExpectation::value, {.doc = "Its value."});
    return keys;
  }
};

struct Recording {
  bool energy = true;
  std::vector<std::string> channels{"force"};
  bool operator==(const Recording&) const = default;
  static const Schema& schema() {
    static const Schema keys = SchemaOf<Recording>("recording")
                                   .flag("energy", &Recording::energy,
                                         {.doc = "Whether energies are kept.", .optional = true})
                                   .text_list("channels", &Recording::channels,
                                              {.doc = "Channels kept.", .optional = true});
    return keys;
  }
};

enum class Scheme { central, exact };

struct Example {
  std::uint8_t format = 0;
  NamedNumbers parameters;
  std::string title;
  Scheme scheme = Scheme::central;
  std::vector<double> band;
  TimeCurve velocity{};
  std::optional<TimeCurve> load;
  std::map<std::string, std::variant<Beam, Lumped>> bodies;
  std::map<std::string, Material> materials;
  std::optional<Friction> friction;
  std::vector<ExampleExpectation> expect;
  Recording recording;

  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<Example>("example")
            .integer("format", &Example::format,
                     {.doc = "Version of the format.", .range = Range::positive()})
            .parameters("parameters", &Example::parameters,
                        {.doc = "Numbers with names.", .optional = true})
            .text("title", &Example::title, {.doc = "Title.", .optional = true})
            .choice("scheme", &Example::scheme,
                    {{"central", Scheme::central}, {"exact", Scheme::exact}},
                    {.doc = "Integrator.", .optional = true})
            .real_list(
                "band", &Example::band,
                {.doc = "Band.", .unit = "Hz", .range = Range::non_negative(), .optional = true})
            .curve("velocity", &Example::velocity,
                   {.doc = "Velocity.", .unit = "m/s", .range = Range::between(-10.0, 10.0)})
            .curve("load", &Example::load, {.doc = "Load.", .unit = "N", .optional = true})
            .named_variants("bodies", &Example::bodies, "type", {"beam", "lumped"},
                            {.doc = "Bodies."})
            .named_sections("materials", &Example::materials,
                            {.doc = "Materials.", .optional = true})
            .section("friction", &Example::friction, {.doc = "Friction.", .optional = true})
            .section_list("expect", &Example::expect,
                          {.doc = "Expected results.", .optional = true})
            .include(&Example::recording)
            .check([](const Example& example, std::vector<Problem>& problems) {
              if (example.band.size() == 2 && example.band[0] > example.band[1]) {
                problems.push_back({Refusal::wrong_value, "band", "must begin below its end"});
              }
            });
    return keys;
  }

  bool operator==(const Example& other) const {
    const auto same_curve = [](const TimeCurve& a, const TimeCurve& b) {
      return a.table() == b.table();
    };
    return format == other.format && parameters == other.parameters && title == other.title &&
           scheme == other.scheme && band == other.band && same_curve(velocity, other.velocity) &&
           load.has_value() == other.load.has_value() &&
           (!load || same_curve(*load, *other.load)) && bodies == other.bodies &&
           materials == other.materials && friction == other.friction && expect == other.expect &&
           recording == other.recording;
  }
};

/// Every key of Example and below, each in a line of its own.
inline const std::string kExampleText = R"(format: 2
title: squeal
scheme: exact
band: [2.5 kHz, 15 kHz]
velocity: 30 mm/s
load:
  times: [0, 100 ms]
  values: [0, -0.2]
bodies:
  oblique:
    type: beam
    length: 75 mm
    angle: 30 deg
    elements: 37
    modes: 20
    material:
      youngs_modulus: 71 GPa
      poissons_ratio: 0.33
  tip:
    type: lumped
    mass: 2 g
materials:
  steel:
    youngs_modulus: 210 GPa
    poissons_ratio: 0.3
friction:
  coefficient: 0.3
  decay_velocity: 10 mm/s
expect:
  -
    result: force.min
    value: 0.19751
  -
    result: force.max
    value: 0.21
energy: false
channels: [force, tip.y]
)";

}  // namespace stridor::test
