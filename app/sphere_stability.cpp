#include "app/sphere_stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/errors.hpp"

namespace stridor {
namespace {

class SphereFamily : public StabilityFamily {
 public:
  SphereFamily(const LoadedSphereScene& loaded, std::vector<NumericKey> keys)
      : loaded_(loaded), keys_(std::move(keys)) {}

  Pencil pencil(std::span<const double> values) override {
    const SphereModelParameters model = with_values(loaded_, keys_, values).model;
    const SubstrateOscillator oscillator = make_sphere(model);
    return make_pencil(
        oscillator, small_motion(oscillator, sphere_equilibrium(oscillator), model.small_motion));
  }
  double trusted_frequency(std::span<const double>) override {
    return std::numeric_limits<double>::infinity();
  }

 private:
  LoadedSphereScene loaded_;
  std::vector<NumericKey> keys_;
};

/// The closed forms, without anything that allocates per point unless parameters vary.
class SphereField : public GrowthField {
 public:
  SphereField(const LoadedSphereScene& loaded, const std::vector<NumericKey>& keys)
      : parameters_(loaded.scene.model) {
    if (std::any_of(keys.begin(), keys.end(), is_parameter)) {
      varied_ = keys;
      loaded_ = loaded;
      return;
    }
    // Refuses a number whose twin is given.
    std::vector<double> as_they_are(keys.size(), 1.0);
    (void)with_values(loaded, keys, as_they_are);
    for (const NumericKey& key : keys) {
      const std::string name = key.path.substr(key.path.find('.') + 1);
      if (key.path.starts_with("sphere.")) {
        keys_.push_back({SphereParameters::schema().find(name), &parameters_.sphere});
      } else {
        keys_.push_back(
            {RegularisationParameters::schema().find(name), &parameters_.regularisation});
      }
    }
  }

  std::complex<double> leading(double x, double y) override {
    return solve(x, y) ? leading_eigenvalue(motion_) : std::complex<double>(nan, nan);
  }
  double margin(double x, double y) override {
    return solve(x, y) ? stability_margin(motion_) : nan;
  }

 private:
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  bool solve(double x, double y) {
    if (loaded_) {
      const std::array<double, 2> values{x, y};
      parameters_ = with_values(*loaded_, varied_, std::span(values).first(varied_.size())).model;
    } else {
      keys_[0].key->assign(keys_[0].object, x);
      if (keys_.size() > 1) keys_[1].key->assign(keys_[1].object, y);
    }
    const SubstrateOscillator oscillator = make_sphere(parameters_);
    // The indentation over R changes less from point to point than that over F_n/k_x.
    const double unit = oscillator.contact.indentation_unit;
    const SubstrateEquilibrium found = find_equilibrium(oscillator, last_ * unit);
    if (!found.converged) return false;
    last_ = found.displacement.y() / unit;
    motion_ = small_motion(oscillator, found, parameters_.small_motion);
    return true;
  }

  SphereModelParameters parameters_;
  struct Place {
    const Key* key;
    void* object;
  };
  std::vector<Place> keys_;
  std::optional<LoadedSphereScene> loaded_;  ///< where parameters vary
  std::vector<NumericKey> varied_;           ///< likewise
  SmallMotion motion_;
  double last_ = 1e-2;  ///< ŷ
};

const char* range_text(LawRange range) {
  switch (range) {
    case LawRange::inside:
      return "inside";
    case LawRange::no_contact:
      return "no contact";
    case LawRange::too_deep:
      return "deeper than the contact law was made for (y/R > 0.3)";
    case LawRange::beyond_data:
      return "at a speed or indentation beyond the data of the contact law";
  }
  return "";
}

}  // namespace

NumericKey find_sphere_key(const SphereScene& scene, const std::string& path,
                           const std::string& option) {
  NumericKey key = find_numeric_key(SphereScene::schema(), &scene, path, option);
  if (!is_parameter(key) && !path.starts_with("sphere.") && !path.starts_with("regularisation."))
    throw ConfigError(option, fmt::format("'{}' has no influence on the eigenvalues", path));
  return key;
}

std::unique_ptr<StabilityFamily> SphereStabilityScene::family(std::vector<NumericKey> keys,
                                                              ContactGeometry) const {
  return std::make_unique<SphereFamily>(loaded_, std::move(keys));
}

std::unique_ptr<GrowthField> SphereStabilityScene::growth_field(
    const std::vector<NumericKey>& keys) const {
  return std::make_unique<SphereField>(loaded_, keys);
}

SubstrateEquilibrium sphere_equilibrium(const SubstrateOscillator& oscillator) {
  SubstrateEquilibrium found =
      find_equilibrium(oscillator, 1e-2 * oscillator.contact.indentation_unit);
  if (!found.converged) {
    throw NumericalError(fmt::format(
        "no sliding equilibrium: Newton's method with bisection did not converge in {} evaluations "
        "of the contact law; the load is {:g} of what F_n/k_x is one of",
        found.evaluations, oscillator.load.y()));
  }
  return found;
}

Json sphere_equilibrium_json(const SphereNumbers& numbers, const SubstrateOscillator& oscillator,
                             const SubstrateEquilibrium& equilibrium) {
  const SmallMotion motion = small_motion(oscillator, equilibrium);
  const double x = equilibrium.displacement.x();
  const double y = equilibrium.displacement.y();
  const double normal = equilibrium.forces.normal.value;
  const double tangential = equilibrium.forces.tangential.value;
  const ViscoelasticContact contact =
      oscillator.contact.law->at(y / oscillator.contact.indentation_unit, numbers.speed);
  return {{"x", number(x)},
          {"y", number(y)},
          {"indentation", number(y / oscillator.contact.indentation_unit)},
          {"normal_force", number(normal)},
          {"friction_force", number(tangential)},
          {"area", number(contact.area.value)},
          {"viscous_friction", number(contact.friction.value)},
          {"equivalent_damping", number(0.5 * motion.damping(0, 0))},
          {"flutter_discriminant", number(flutter_discriminant(motion))},
          {"law_range", range_text(equilibrium.forces.range)},
          {"dimensional",
           {{"x", number(x * numbers.length_unit)},
            {"y", number(y * numbers.length_unit)},
            {"normal_force", number(normal * numbers.force_unit)},
            {"friction_force", number(tangential * numbers.force_unit)},
            {"length_unit", number(numbers.length_unit)},
            {"time_unit", number(numbers.time_unit)},
            {"force_unit", number(numbers.force_unit)}}},
          {"numbers",
           {{"normal_load", number(numbers.normal_load)},
            {"shear_strength", number(numbers.shear_strength)},
            {"speed", number(numbers.speed)},
            {"frequency_ratio", number(numbers.frequency_ratio)},
            {"coupling_ratio", number(numbers.coupling_ratio)},
            {"damping_x", number(numbers.damping_x)},
            {"damping_y", number(numbers.damping_y)},
            {"vertical_damping_ratio", numbers.vertical_damping_ratio
                                           ? number(*numbers.vertical_damping_ratio)
                                           : Json(nullptr)}}}};
}

ExitCode eig_of_sphere(const StabilityOptions& options) {
  if (options.below) throw ConfigError("--below", "is for scenes whose frequencies are in Hz");
  const LoadedSphereScene loaded = load_sphere_scene(options.scene, options.common.sets);
  const SphereModelParameters& model = loaded.scene.model;
  const SphereNumbers numbers = sphere_numbers(model.sphere);
  const SubstrateOscillator oscillator = make_sphere(model);
  const SubstrateEquilibrium equilibrium = sphere_equilibrium(oscillator);
  const SmallMotion motion = small_motion(oscillator, equilibrium, model.small_motion);
  const std::vector<Eigenvalue> found = lowest_eigenvalues(
      make_pencil(oscillator, motion), options.eigenvalue_method(), options.window());
  bool is_stable = true;
  for (const Eigenvalue& one : found) is_stable = is_stable && !is_growing(one);

  const Json state = sphere_equilibrium_json(numbers, oscillator, equilibrium);
  if (options.common.json) {
    Json object = {{"method", options.method},
                   {"equilibrium", state},
                   {"eigenvalues", eigenvalues_json(found)},
                   {"residuals", Json::array()},
                   {"stable", is_stable},
                   {"window", {0.0, nullptr}}};
    for (const Eigenvalue& one : found) object["residuals"].push_back(number(one.residual));
    print_json(object);
    return ExitCode::done;
  }
  const auto print = [&](const char* name, double value, double unit, const char* units) {
    fmt::print("{:<28}{:>16.9g}", name, value);
    if (units[0] != '\0') fmt::print("  ({:.6g} {})", value * unit, units);
    fmt::print("\n");
  };
  print("x", equilibrium.displacement.x(), numbers.length_unit, "m");
  print("y", equilibrium.displacement.y(), numbers.length_unit, "m");
  print("normal force", equilibrium.forces.normal.value, numbers.force_unit, "N");
  print("friction force", equilibrium.forces.tangential.value, numbers.force_unit, "N");
  print("equivalent damping ratio", state["equivalent_damping"].get<double>(), 0.0, "");
  if (equilibrium.forces.range != LawRange::inside)
    fmt::print("the contact is {}\n", range_text(equilibrium.forces.range));
  fmt::print("{:>16}  {:>16}  {:>14}  {:>14}\n", "growth", "frequency", "growth (1/s)",
             "frequency (Hz)");
  for (const Eigenvalue& one : found) {
    fmt::print("{:>16.9g}  {:>16.9g}  {:>14.6g}  {:>14.6g}{}\n", one.growth(), one.s.imag(),
               one.growth() / numbers.time_unit, one.frequency() / numbers.time_unit,
               is_growing(one) ? "  unstable" : "");
  }
  fmt::print("{}\n", is_stable ? "stable" : "unstable");
  return ExitCode::done;
}

}  // namespace stridor
