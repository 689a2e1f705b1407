#include "coupling/substrate_parameters.hpp"

namespace stridor {

std::shared_ptr<const ViscoelasticContactLaw> shipped_law(SphereContactLaw law) {
  using Law = std::shared_ptr<const ViscoelasticContactLaw>;
  static const Law published = std::make_shared<FittedLaw>(published_coefficients());
  static const Law boundary_element = std::make_shared<BoundaryElementLaw>(shipped_master_curve());
  return law == SphereContactLaw::boundary_element ? boundary_element : published;
}

const Schema& SubstrateParameters::schema() {
  static const Schema keys =
      SchemaOf<SubstrateParameters>("substrate")
          .real(
              "radius", &SubstrateParameters::radius,
              {.doc = "Of the sphere at the slave point.", .unit = "m", .range = Range::positive()})
          .real("modulus", &SubstrateParameters::modulus,
                {.doc = "E_0* = E_0/(1 − ν²) of the substrate at frequency zero.",
                 .unit = "Pa",
                 .range = Range::positive()})
          .real("creep_time", &SubstrateParameters::creep_time,
                {.doc = "τ of the substrate.", .unit = "s", .range = Range::positive()})
          .real("shear_strength", &SubstrateParameters::shear_strength,
                {.doc = "τ_0/E_0*, friction of the interface per area of contact.",
                 .range = Range::non_negative()})
          .choice("contact_law", &SubstrateParameters::law,
                  {{"published_fit", SphereContactLaw::published_fit},
                   {"boundary_element", SphereContactLaw::boundary_element}},
                  {.doc = "The fits as published, whose axis of speed is off by about two "
                          "decades, or the boundary elements.",
                   .optional = true});
  return keys;
}

SubstrateContact make_substrate_contact(const SubstrateParameters& p) {
  const double force = p.modulus * p.radius * p.radius;
  SubstrateContact contact;
  contact.law = shipped_law(p.law);
  contact.indentation_unit = p.radius;
  contact.speed_unit = p.radius / p.creep_time;
  contact.force_unit = force;
  contact.shear = p.shear_strength * force;
  contact.friction_load = FrictionLoad::contact;
  return contact;
}

}  // namespace stridor
