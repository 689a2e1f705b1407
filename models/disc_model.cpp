#include "models/disc_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/suggestion.hpp"

namespace stridor {
namespace {

constexpr Eigen::Index pad_size = 3;

/// A row of the plate on the coordinates of the whole system.
Eigen::VectorXd padded(const Eigen::VectorXd& row, Eigen::Index size) {
  Eigen::VectorXd whole = Eigen::VectorXd::Zero(size);
  whole.head(row.size()) = row;
  return whole;
}

Eigen::Matrix3d pad_stiffness(const PadStiffness& springs, int side) {
  Eigen::Matrix3d K =
      Eigen::Vector3d(springs.radial, springs.circumferential, springs.normal).asDiagonal();
  K(1, 2) = K(2, 1) = side * springs.coupling;
  return K;
}

/// A contact point of a pad, `offset` along φ from its centre. The pad moves as a whole, in the
/// directions r and φ of its centre.
FaceContact make_contact(const AnnularPlate& plate, const DiscModelParameters& parameters, int side,
                         Eigen::Index first_pad, Eigen::Index size, double offset) {
  const PadsParameters& pads = parameters.pads;
  const double turned = offset / pads.radius;
  PlateRows rows = plate.rows(pads.radius, pads.angle + turned);
  for (Eigen::VectorXd* row : {&rows.w, &rows.w_r, &rows.w_phi, &rows.w_r_phi, &rows.w_phi_phi})
    *row = padded(*row, size);
  FaceContact contact;
  contact.plate = std::move(rows);
  contact.pad_r = contact.pad_phi = contact.pad_z = Eigen::VectorXd::Zero(size);
  contact.pad_r(first_pad) = std::cos(turned);
  contact.pad_r(first_pad + 1) = std::sin(turned);
  contact.pad_phi(first_pad) = -std::sin(turned);
  contact.pad_phi(first_pad + 1) = std::cos(turned);
  contact.pad_z(first_pad + 2) = 1.0;
  contact.radius = pads.radius;
  contact.half_thickness = 0.5 * parameters.disc.plate.thickness;
  contact.side = side;
  return contact;
}

/// Bodies without contact.
LinearSystem free_bodies(const AnnularPlate& plate, const DiscModelParameters& parameters,
                         const DiscTerms& terms) {
  const Eigen::Index n = plate.size();
  const Eigen::Index size = n + 2 * pad_size;
  const double speed = parameters.disc.speed;
  const Eigen::MatrixXd spin = plate.spin();
  const Eigen::MatrixXd elastic = plate.omega().array().square().matrix().asDiagonal();
  LinearSystem system;
  system.mass = Eigen::MatrixXd::Identity(size, size);
  system.velocity = Eigen::MatrixXd::Zero(size, size);
  system.position = Eigen::MatrixXd::Zero(size, size);
  system.position.topLeftCorner(n, n) = elastic;
  if (terms.gyroscopic) {
    system.velocity.topLeftCorner(n, n) = 2.0 * speed * spin;
    system.position.topLeftCorner(n, n) -= speed * speed * spin.transpose() * spin;
  }
  if (terms.structural_damping) {
    const MaterialDamping& damping = parameters.disc.damping;
    const Eigen::MatrixXd C =
        damping.alpha * Eigen::MatrixXd::Identity(n, n) + damping.beta * elastic;
    system.velocity.topLeftCorner(n, n) += C;
    if (terms.gyroscopic) system.position.topLeftCorner(n, n) += speed * C * spin;
  }
  for (const int side : {1, -1}) {
    const Eigen::Index first = side > 0 ? n : n + pad_size;
    const Eigen::Matrix3d M = parameters.pads.mass * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d K = pad_stiffness(parameters.pads.stiffness, side);
    system.mass.block<3, 3>(first, first) = M;
    system.position.block<3, 3>(first, first) = K;
    if (terms.structural_damping) {
      const MaterialDamping& damping = parameters.pads.damping;
      system.velocity.block<3, 3>(first, first) = damping.alpha * M + damping.beta * K;
    }
  }
  return system;
}

/// Adds what the forces of the sliding state do.
void add_preload(LinearSystem& system, const FaceContact& contact, double normal_force,
                 double friction, double speed, const DiscTerms& terms) {
  const double friction_force = terms.friction ? friction * normal_force : 0.0;
  if (terms.geometric) {
    system.position += normal_preload_stiffness(contact, normal_force) +
                       friction_preload_stiffness(contact, friction_force);
  }
  if (terms.friction_damping && friction_force > 0.0) {
    system.velocity += friction_damping(contact, friction_force, speed);
    system.position += friction_turning_stiffness(contact, friction_force);
  }
}

void check(const DiscModelParameters& parameters, const DiscTerms& terms) {
  const AnnularPlateParameters& plate = parameters.disc.plate;
  const double radius = parameters.pads.radius;
  if (!(radius > plate.inner_radius && radius < plate.outer_radius)) {
    throw std::invalid_argument(
        fmt::format("disc: pads at a radius of {:g} m are off the disc", radius));
  }
  if (parameters.contact.formulation == ContactFormulation::penalty && !parameters.contact.penalty)
    throw std::invalid_argument("disc: the penalty formulation needs a penalty");
  if (terms.friction_damping && !(parameters.disc.speed > 0.0))
    throw std::invalid_argument("disc: friction damping is infinite at no speed");
}

}  // namespace

const std::vector<std::string>& disc_term_names() {
  static const std::vector<std::string> names{"gyroscopic", "friction", "friction_damping",
                                              "geometric", "structural_damping"};
  return names;
}

DiscTerms disc_terms(const std::vector<std::string>& names) {
  DiscTerms terms;
  const std::vector<bool*> switches{&terms.gyroscopic, &terms.friction, &terms.friction_damping,
                                    &terms.geometric, &terms.structural_damping};
  for (const std::string& name : names) {
    const auto& known = disc_term_names();
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw std::invalid_argument(fmt::format("disc: there is no term '{}'", name));
    *switches[static_cast<std::size_t>(found - known.begin())] = true;
  }
  return terms;
}

DiscModel make_disc_model(const DiscModelParameters& parameters) {
  const DiscTerms terms = disc_terms(parameters.terms);
  check(parameters, terms);
  const double speed = parameters.disc.speed;
  const AnnularPlate plate(parameters.disc.plate, parameters.disc.centrifugal ? speed : 0.0);
  DiscModel model;
  model.highest_frequency = plate.lowest_omitted() / (2.0 * std::numbers::pi);
  model.system = free_bodies(plate, parameters, terms);
  const Eigen::Index size = model.system.size();

  const FaceContactParameters& contact = parameters.contact;
  const std::vector<double> offsets =
      contact.offsets.empty() ? std::vector<double>{0.0} : contact.offsets;
  model.contact_preload = contact.preload / static_cast<double>(offsets.size());
  for (const int side : {1, -1}) {
    const Eigen::Index first = side > 0 ? plate.size() : plate.size() + pad_size;
    for (const double offset : offsets)
      model.contacts.push_back(make_contact(plate, parameters, side, first, size, offset));
  }
  const double friction = terms.friction ? contact.friction.coefficient : 0.0;
  const auto num_contacts = static_cast<Eigen::Index>(model.contacts.size());
  const bool is_constrained = contact.formulation == ContactFormulation::lagrange;
  model.system.gaps.resize(is_constrained ? num_contacts : 0, size);
  model.system.forces.resize(is_constrained ? num_contacts : 0, size);
  for (Eigen::Index i = 0; i < num_contacts; ++i) {
    const FaceContact& point = model.contacts[static_cast<std::size_t>(i)];
    const Eigen::VectorXd gap = point.gap();
    const Eigen::VectorXd force = gap + friction * point.friction();
    if (is_constrained) {
      model.system.gaps.row(i) = gap;
      model.system.forces.row(i) = force;
    } else {
      model.system.position += *contact.penalty * force * gap.transpose();
    }
    add_preload(model.system, point, model.contact_preload, friction, speed, terms);
  }
  return model;
}

const Schema& MaterialDamping::schema() {
  static const Schema keys = SchemaOf<MaterialDamping>("material_damping")
                                 .real("alpha", &MaterialDamping::alpha,
                                       {.doc = "Damping in proportion to mass.",
                                        .unit = "s-1",
                                        .range = Range::non_negative(),
                                        .optional = true})
                                 .real("beta", &MaterialDamping::beta,
                                       {.doc = "Damping in proportion to stiffness.",
                                        .unit = "s",
                                        .range = Range::non_negative(),
                                        .optional = true});
  return keys;
}

const Schema& DiscParameters::schema() {
  static const Schema keys =
      SchemaOf<DiscParameters>("disc")
          .include(&DiscParameters::plate)
          .real("speed", &DiscParameters::speed,
                {.doc = "Angular velocity, towards growing angles. At 0 friction acts as in the "
                        "limit of slow rotation.",
                 .unit = "rad s-1",
                 .range = Range::non_negative()})
          .section("damping", &DiscParameters::damping,
                   {.doc = "Of the material, which turns with the disc.", .optional = true})
          .flag("centrifugal", &DiscParameters::centrifugal,
                {.doc = "Whether the stress of the rotation stiffens the disc.", .optional = true});
  return keys;
}

const Schema& PadStiffness::schema() {
  const auto spring = [](const char* doc) {
    return RealKey{.doc = doc, .unit = "N m-1", .range = Range::positive()};
  };
  static const Schema keys =
      SchemaOf<PadStiffness>("pad_stiffness")
          .real("radial", &PadStiffness::radial, spring("Along the radius."))
          .real("circumferential", &PadStiffness::circumferential,
                spring("Along the circumference."))
          .real("normal", &PadStiffness::normal, spring("Along the axis of the disc."))
          .real("coupling", &PadStiffness::coupling,
                {.doc = "Between circumference and axis, for the pad on the face of larger z; the "
                        "other pad is its mirror image.",
                 .unit = "N m-1",
                 .optional = true})
          .check([](const PadStiffness& springs, std::vector<Problem>& problems) {
            if (springs.coupling * springs.coupling >= springs.circumferential * springs.normal) {
              problems.push_back({"coupling",
                                  "must be smaller than the geometric mean of circumferential and "
                                  "normal, else the pad is unstable by itself",
                                  {},
                                  0,
                                  0});
            }
          });
  return keys;
}

const Schema& PadsParameters::schema() {
  static const Schema keys =
      SchemaOf<PadsParameters>("pads")
          .real("mass", &PadsParameters::mass,
                {.doc = "Of each pad.", .unit = "kg", .range = Range::positive()})
          .section("stiffness", &PadsParameters::stiffness, {.doc = "Springs that hold a pad."})
          .real("radius", &PadsParameters::radius,
                {.doc = "Where the pads stand, from the axis of the disc.",
                 .unit = "m",
                 .range = Range::positive()})
          .real("angle", &PadsParameters::angle,
                {.doc = "Where they stand around the disc; nothing depends on it.",
                 .unit = "rad",
                 .optional = true})
          .section("damping", &PadsParameters::damping, {.doc = "Of each pad.", .optional = true});
  return keys;
}

const Schema& FaceFrictionParameters::schema() {
  static const Schema keys =
      SchemaOf<FaceFrictionParameters>("face_friction")
          .real("coefficient", &FaceFrictionParameters::coefficient,
                {.doc = "Coefficient of sliding friction.", .range = Range::non_negative()});
  return keys;
}

const Schema& FaceContactParameters::schema() {
  using P = FaceContactParameters;
  static const Schema keys =
      SchemaOf<P>("face_contact")
          .real("preload", &P::preload,
                {.doc = "Normal force of each pad in the sliding state.",
                 .unit = "N",
                 .range = Range::non_negative()})
          .section("friction", &P::friction, {.doc = "Friction of both contacts."})
          .choice("formulation", &P::formulation,
                  {{"lagrange", ContactFormulation::lagrange},
                   {"penalty", ContactFormulation::penalty}},
                  {.doc = "Contact by Lagrange multipliers, or by springs.", .optional = true})
          .real("penalty", &P::penalty,
                {.doc = "Stiffness of the springs, one per contact point.",
                 .unit = "N m-1",
                 .range = Range::positive(),
                 .optional = true})
          .real_list("offsets", &P::offsets,
                     {.doc = "Contact points of a pad: distances from its centre along the "
                             "circumference; they share the preload. Default: one at the centre.",
                      .unit = "m",
                      .optional = true})
          .check([](const P& contact, std::vector<Problem>& problems) {
            if (contact.formulation == ContactFormulation::penalty && !contact.penalty) {
              problems.push_back({"penalty", "is required with `formulation: penalty`", {}, 0, 0});
            }
          });
  return keys;
}

const Schema& DiscModelParameters::schema() {
  using P = DiscModelParameters;
  static const Schema keys =
      SchemaOf<P>("disc_model")
          .section("disc", &P::disc, {.doc = "The disc: an annular plate that spins."})
          .section("pads", &P::pads, {.doc = "Two pads, one on each face of the disc."})
          .section("contact", &P::contact, {.doc = "Contact between disc and pads."})
          .text_list("terms", &P::terms,
                     {.doc = "What is kept of the linearised equations: gyroscopic, friction, "
                             "friction_damping, geometric, structural_damping."})
          .check([](const P& model, std::vector<Problem>& problems) {
            const auto& known = disc_term_names();
            bool has_friction_damping = false;
            for (std::size_t i = 0; i < model.terms.size(); ++i) {
              const std::string& name = model.terms[i];
              has_friction_damping |= name == "friction_damping";
              if (std::find(known.begin(), known.end(), name) != known.end()) continue;
              std::string advice = did_you_mean(name, known);
              if (advice.empty()) advice = fmt::format("; known: {}", fmt::join(known, ", "));
              problems.push_back({"terms." + std::to_string(i),
                                  fmt::format("there is no term '{}'{}", name, advice),
                                  {},
                                  0,
                                  0});
            }
            if (has_friction_damping && !(model.disc.speed > 0.0)) {
              problems.push_back({"disc.speed",
                                  "must be positive with the term friction_damping, which grows "
                                  "without bound as the disc slows down",
                                  {},
                                  0,
                                  0});
            }
            const AnnularPlateParameters& plate = model.disc.plate;
            if (model.pads.radius <= plate.inner_radius ||
                model.pads.radius >= plate.outer_radius) {
              problems.push_back(
                  {"pads.radius",
                   fmt::format("must lie between the edges of the disc, {:g} and "
                               "{:g} m, got {:g} m",
                               plate.inner_radius, plate.outer_radius, model.pads.radius),
                   {},
                   0,
                   0});
            }
          });
  return keys;
}

}  // namespace stridor
