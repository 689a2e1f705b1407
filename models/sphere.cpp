#include "models/sphere.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

/// A dimensionless number and the dimensional one that may replace it.
struct Twin {
  const char* ratio;
  const char* dimensional;
  std::optional<double> SphereParameters::*ratio_member;
  std::optional<double> SphereParameters::*dimensional_member;
};

constexpr Twin twins[] = {
    {"normal_load", "normal_force", &SphereParameters::normal_load,
     &SphereParameters::normal_force},
    {"shear_strength", "shear_stress", &SphereParameters::shear_strength,
     &SphereParameters::shear_stress},
    {"speed", "substrate_speed", &SphereParameters::speed, &SphereParameters::substrate_speed},
    {"frequency_ratio", "stiffness_y", &SphereParameters::frequency_ratio,
     &SphereParameters::stiffness_y},
    {"coupling_ratio", "coupling_stiffness", &SphereParameters::coupling_ratio,
     &SphereParameters::coupling_stiffness},
    {"damping_x", "damper_x", &SphereParameters::damping_x, &SphereParameters::damper_x},
    {"damping_y", "damper_y", &SphereParameters::damping_y, &SphereParameters::damper_y},
};

void check_twins(const SphereParameters& parameters, std::vector<Problem>& problems) {
  for (const Twin& twin : twins) {
    const bool has_ratio = (parameters.*twin.ratio_member).has_value();
    const bool has_dimensional = (parameters.*twin.dimensional_member).has_value();
    if (has_ratio && has_dimensional) {
      problems.push_back({twin.dimensional,
                          fmt::format("says the same as `{}`; give one of them", twin.ratio),
                          {},
                          0,
                          0});
    } else if (!has_ratio && !has_dimensional) {
      problems.push_back(
          {"", fmt::format("`{}` or `{}` is missing", twin.ratio, twin.dimensional), {}, 0, 0});
    }
  }
}

std::shared_ptr<const ViscoelasticContactLaw> law_of(const SphereModelParameters& parameters) {
  if (parameters.contact_law == SphereModelParameters::published_fit)
    return shipped_law(SphereContactLaw::published_fit);
  if (parameters.contact_law == SphereModelParameters::boundary_element)
    return shipped_law(SphereContactLaw::boundary_element);
  if (!parameters.table)
    throw std::invalid_argument("make_sphere: the table of the contact law has not been read");
  return parameters.table;
}

void check_contact_law(const SphereModelParameters& parameters, std::vector<Problem>& problems) {
  if (parameters.has_table() && !parameters.contact_law.ends_with(".h5")) {
    problems.push_back({"contact_law",
                        fmt::format("'{}' is neither published_fit nor boundary_element nor a file "
                                    "of `stridor contact --table` (*.h5)",
                                    parameters.contact_law),
                        {},
                        0,
                        0});
  }
}

}  // namespace

const Schema& SphereParameters::schema() {
  static const Schema keys =
      SchemaOf<SphereParameters>("sphere")
          .real(
              "stiffness_x", &SphereParameters::stiffness_x,
              {.doc = "k_x of the horizontal spring.", .unit = "N m-1", .range = Range::positive()})
          .real("natural_frequency", &SphereParameters::natural_frequency,
                {.doc = "ω_nx = (k_x/m)^1/2; 1/ω_nx is the unit of time of all results.",
                 .unit = "rad s-1",
                 .range = Range::positive()})
          .real("radius", &SphereParameters::radius,
                {.doc = "R of the sphere.", .unit = "m", .range = Range::positive()})
          .real("modulus", &SphereParameters::modulus,
                {.doc = "E_0* = E_0/(1 − ν²) of the substrate at frequency zero.",
                 .unit = "Pa",
                 .range = Range::positive()})
          .real("creep_time", &SphereParameters::creep_time,
                {.doc = "τ of the substrate.", .unit = "s", .range = Range::positive()})
          .real("normal_load", &SphereParameters::normal_load,
                {.doc = "F_n/(E_0* R²), by which the sphere is pressed on; F_n/k_x is the unit of "
                        "length of all results. This, or `normal_force`.",
                 .range = Range::positive(),
                 .optional = true})
          .real("normal_force", &SphereParameters::normal_force,
                {.doc = "F_n.", .unit = "N", .range = Range::positive(), .optional = true})
          .real("shear_strength", &SphereParameters::shear_strength,
                {.doc = "τ_0/E_0*, friction of the interface per area of contact. This, or "
                        "`shear_stress`.",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("shear_stress", &SphereParameters::shear_stress,
                {.doc = "τ_0.", .unit = "Pa", .range = Range::non_negative(), .optional = true})
          .real("speed", &SphereParameters::speed,
                {.doc = "v_d τ/R of the substrate, towards +x. This, or `substrate_speed`.",
                 .range = Range::positive(),
                 .optional = true})
          .real("substrate_speed", &SphereParameters::substrate_speed,
                {.doc = "v_d.", .unit = "m s-1", .range = Range::positive(), .optional = true})
          .real("frequency_ratio", &SphereParameters::frequency_ratio,
                {.doc = "Ω = ω_ny/ω_nx = (k_y/k_x)^1/2. This, or `stiffness_y`.",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("stiffness_y", &SphereParameters::stiffness_y,
                {.doc = "k_y of the vertical spring.",
                 .unit = "N m-1",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("coupling_ratio", &SphereParameters::coupling_ratio,
                {.doc = "η = (k_xy/k_x)^1/2. This, or `coupling_stiffness`.",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("coupling_stiffness", &SphereParameters::coupling_stiffness,
                {.doc = "k_xy of the inclined spring.",
                 .unit = "N m-1",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("angle", &SphereParameters::angle,
                {.doc = "α between the inclined spring and the horizontal.", .unit = "rad"})
          .real("damping_x", &SphereParameters::damping_x,
                {.doc = "ξ_x = c_x/(2 (k_x m)^1/2). This, or `damper_x`.",
                 .range = Range::non_negative(),
                 .optional = true})
          .real(
              "damper_x", &SphereParameters::damper_x,
              {.doc = "c_x.", .unit = "N s m-1", .range = Range::non_negative(), .optional = true})
          .real("damping_y", &SphereParameters::damping_y,
                {.doc = "ξ_y as it stands in PPH (12): c_y/(2 (k_x m)^1/2), which is Ω times the "
                        "damping ratio of (9). This, or `damper_y`.",
                 .range = Range::non_negative(),
                 .optional = true})
          .real(
              "damper_y", &SphereParameters::damper_y,
              {.doc = "c_y.", .unit = "N s m-1", .range = Range::non_negative(), .optional = true})
          .check(check_twins);
  return keys;
}

const Schema& RegularisationParameters::schema() {
  using Kind = RegularisedSign::Kind;
  static const Schema keys =
      SchemaOf<RegularisationParameters>("regularisation")
          .choice("law", &RegularisationParameters::law,
                  {{"none", Kind::none},
                   {"tanh", Kind::tanh},
                   {"linear", Kind::linear},
                   {"square_root", Kind::square_root},
                   {"atan", Kind::atan}},
                  {.doc = "What stands in the place of the sign of the slip, with u the slip over "
                          "`speed`: tanh u, u up to 1, u/(1 + u²)^1/2 or (2/π) arctan u; none: the "
                          "sign itself, and sticking.",
                   .optional = true})
          .real("speed", &RegularisationParameters::speed,
                {.doc = "In multiples of the speed of the substrate.",
                 .range = Range::positive(),
                 .optional = true})
          .check(
              [](const RegularisationParameters& regularisation, std::vector<Problem>& problems) {
                const bool is_wanted = regularisation.law != Kind::none;
                if (is_wanted == regularisation.speed.has_value()) return;
                problems.push_back({"speed",
                                    is_wanted ? "missing: needed by a `law` other than none"
                                              : "not used by the law `none`",
                                    {},
                                    0,
                                    0});
              });
  return keys;
}

const Schema& SphereModelParameters::schema() {
  static const Schema keys =
      SchemaOf<SphereModelParameters>("sphere_model")
          .section("sphere", &SphereModelParameters::sphere,
                   {.doc = "A sphere on springs and dampers, pressed against a sliding "
                           "viscoelastic substrate."})
          .text("contact_law", &SphereModelParameters::contact_law,
                {.doc = "Force, area and friction of the contact: published_fit, the fits as "
                        "published, whose axis of speed is off by about two decades; "
                        "boundary_element, the boundary elements of a paraboloid with one creep "
                        "time and E∞/E0 = 10; or a file, from the folder of the scene: a table "
                        "of `stridor contact --table` (*.h5).",
                 .optional = true})
          .choice("friction_normal_force", &SphereModelParameters::friction_normal_force,
                  {{"applied", FrictionLoad::applied}, {"contact", FrictionLoad::contact}},
                  {.doc = "What the viscoelastic friction coefficient is multiplied with: the "
                          "applied load, as published, or the force of the contact.",
                   .optional = true})
          .section("regularisation", &SphereModelParameters::regularisation,
                   {.doc = "Friction without sticking, only for comparison: it moves thresholds "
                           "and amplitudes.",
                    .optional = true})
          .choice(
              "small_motion", &SphereModelParameters::small_motion,
              {{"damped", SmallMotionTerms::all}, {"undamped", SmallMotionTerms::without_damping}},
              {.doc = "Whether the eigenvalues are those of the whole system or of the one "
                      "without its damping matrix (PPH, 4.2).",
               .optional = true})
          .check(check_contact_law);
  return keys;
}

SphereNumbers sphere_numbers(const SphereParameters& p) {
  const auto either = [](const std::optional<double>& ratio,
                         const std::optional<double>& dimensional, auto&& convert) {
    return ratio ? *ratio : convert(dimensional.value_or(0.0));
  };
  const double force_scale = p.modulus * p.radius * p.radius;
  const double mass_rate = p.stiffness_x / p.natural_frequency;  // m ω_nx
  const auto root_ratio = [&](double stiffness) { return std::sqrt(stiffness / p.stiffness_x); };
  const auto damping = [&](double damper) { return damper / (2.0 * mass_rate); };
  SphereNumbers numbers;
  numbers.normal_load =
      either(p.normal_load, p.normal_force, [&](double force) { return force / force_scale; });
  numbers.shear_strength =
      either(p.shear_strength, p.shear_stress, [&](double stress) { return stress / p.modulus; });
  numbers.speed = either(p.speed, p.substrate_speed,
                         [&](double speed) { return speed * p.creep_time / p.radius; });
  numbers.frequency_ratio = either(p.frequency_ratio, p.stiffness_y, root_ratio);
  numbers.coupling_ratio = either(p.coupling_ratio, p.coupling_stiffness, root_ratio);
  numbers.damping_x = either(p.damping_x, p.damper_x, damping);
  numbers.damping_y = either(p.damping_y, p.damper_y, damping);
  numbers.force_unit = numbers.normal_load * force_scale;
  numbers.length_unit = numbers.force_unit / p.stiffness_x;
  numbers.time_unit = 1.0 / p.natural_frequency;
  numbers.radius_ratio = p.stiffness_x / (p.modulus * p.radius) / numbers.normal_load;
  numbers.time_ratio = p.natural_frequency * p.creep_time;
  if (numbers.frequency_ratio > 0.0)
    numbers.vertical_damping_ratio = numbers.damping_y / numbers.frequency_ratio;
  return numbers;
}

SubstrateOscillator make_sphere(const SphereModelParameters& parameters) {
  const SphereNumbers numbers = sphere_numbers(parameters.sphere);
  const double cosine = std::cos(parameters.sphere.angle);
  const double sine = std::sin(parameters.sphere.angle);
  const double spring = numbers.coupling_ratio * numbers.coupling_ratio;
  SubstrateOscillator oscillator;
  oscillator.damping.diagonal() << 2.0 * numbers.damping_x, 2.0 * numbers.damping_y;
  oscillator.stiffness << 1.0 + spring * cosine * cosine, spring * sine * cosine,
      spring * sine * cosine,
      numbers.frequency_ratio * numbers.frequency_ratio + spring * sine * sine;
  oscillator.load = {0.0, 1.0};
  SubstrateContact& contact = oscillator.contact;
  contact.law = law_of(parameters);
  contact.indentation_unit = numbers.radius_ratio;
  contact.speed_unit = numbers.radius_ratio / numbers.time_ratio;
  contact.force_unit = 1.0 / numbers.normal_load;
  contact.shear = numbers.shear_strength / numbers.normal_load;
  contact.load = 1.0;
  contact.friction_load = parameters.friction_normal_force;
  oscillator.substrate_speed = numbers.speed * contact.speed_unit;
  contact.sign = {parameters.regularisation.law,
                  parameters.regularisation.speed.value_or(1.0) * oscillator.substrate_speed};
  return oscillator;
}

}  // namespace stridor
