#include "app/disc_stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "app/eigenvalue_report.hpp"
#include "app/found_spectrum.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "solvers/linear_pencil.hpp"

namespace stridor {
namespace {

class DiscFamily : public StabilityFamily {
 public:
  DiscFamily(LoadedDiscScene loaded, std::vector<NumericKey> keys)
      : loaded_(std::move(loaded)), keys_(std::move(keys)) {}

  Pencil pencil(std::span<const double> values) override { return make_pencil(at(values).system); }
  double trusted_frequency(std::span<const double> values) override {
    return at(values).highest_frequency;
  }
  SpectrumMethod method(std::span<const double>) override { return SpectrumMethod::sampled; }

 private:
  /// @throws NumericalError naming the values where there is no sliding state
  DiscModel at(std::span<const double> values) const {
    try {
      return loaded_.model(keys_, values);
    } catch (const NumericalError& error) {
      std::string place;
      for (std::size_t i = 0; i < keys_.size(); ++i)
        place += (i > 0 ? ", " : "at ") + value_text(keys_[i], values[i]);
      throw NumericalError(place + ": " + error.what());
    }
  }

  LoadedDiscScene loaded_;
  std::vector<NumericKey> keys_;
};

/// The contacts of the sliding state about which the system is linearised.
Json equilibrium_json(const DiscModel& model) {
  Json contacts = Json::array();
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const FaceContact& contact = model.contacts[i];
    const FaceContactPoint& point = model.state.contacts[i];
    const Eigen::VectorXd& q = model.state.displacement;
    contacts.push_back({{"side", contact.side},
                        {"closed", point.is_closed},
                        {"force", number(point.force)},
                        {"friction_force", number(model.law.friction * point.force)},
                        {"gap", number(point.gap)},
                        {"slip_velocity", number(point.velocity.norm())},
                        {"pad_displacement",
                         {number(contact.pad_r.dot(q)), number(contact.pad_phi.dot(q)),
                          number(contact.pad_z.dot(q))}}});
  }
  return {{"contacts", contacts}};
}

/// The same in two lines: the forces of the contact points of each pad, along the circumference.
void print_equilibrium(const DiscModel& model) {
  const std::size_t per_pad = model.contacts.size() / 2;
  for (std::size_t pad = 0; pad < 2; ++pad) {
    std::string forces;
    double sum = 0.0;
    for (std::size_t i = pad * per_pad; i < (pad + 1) * per_pad; ++i) {
      const FaceContactPoint& point = model.state.contacts[i];
      forces += point.is_closed ? fmt::format(" {:.6g}", point.force) : std::string(" open");
      sum += point.force;
    }
    fmt::print("{:<24}{:.8g} N{}\n", pad == 0 ? "contact force, upper" : "contact force, lower",
               sum, per_pad > 1 ? ", of its points" + forces : "");
  }
}

}  // namespace

std::unique_ptr<StabilityFamily> DiscStabilityScene::family(std::vector<NumericKey> keys,
                                                            ContactGeometry) const {
  return std::make_unique<DiscFamily>(loaded_, std::move(keys));
}

ExitCode eig_of_disc(const StabilityOptions& options, bool explain,
                     const std::optional<int>& mode) {
  const LoadedDiscScene loaded = load_disc_scene(options.scene, options.common.sets);
  std::optional<Activity> solving(std::in_place, "state of sliding and eigenvalues");
  const DiscModel model = loaded.model();
  const FoundSpectrum found =
      find_dense(make_pencil(model.system), options.window(), model.highest_frequency);
  solving.reset();
  const std::vector<Eigenvalue>& eigenvalues = found.eigenvalues;
  const double highest = found.highest;
  const bool is_stable = std::none_of(
      eigenvalues.begin(), eigenvalues.end(),
      [&](const Eigenvalue& one) { return one.frequency() <= highest && is_growing(one); });

  Json object = {{"about", options.about},
                 {"method", found.method},
                 {"equilibrium", equilibrium_json(model)},
                 {"eigenvalues", eigenvalues_json(eigenvalues)},
                 {"residuals", Json::array()},
                 {"stable", is_stable},
                 {"doubtful", doubtful_json(eigenvalues)},
                 {"window", {0.0, number(highest)}}};
  for (const Eigenvalue& one : eigenvalues) object["residuals"].push_back(number(one.residual));
  if (explain) {
    const std::size_t num_real = num_real_of(eigenvalues);
    // The one to explain is among those over which the verdict is.
    std::vector<Eigenvalue> choice = eigenvalues;
    if (!mode) std::erase_if(choice, [&](const auto& one) { return one.frequency() > highest; });
    const std::size_t chosen = chosen_mode(choice, num_real, mode);
    const Eigenvalue& one = eigenvalues[chosen];
    object["explanation"] = {
        {"mode", chosen - num_real + 1}, {"frequency", one.frequency()}, {"growth", one.growth()}};
    object["explanation"].update(found.explain(chosen));
  }
  if (options.common.json) {
    print_json(object);
    return ExitCode::done;
  }
  print_equilibrium(model);
  print_eigenvalues(eigenvalues, model.highest_frequency);
  if (!std::isfinite(highest)) {
    fmt::print("{} at all frequencies\n", is_stable ? "stable" : "unstable");
  } else {
    fmt::print("{} between 0 and {:.6g} Hz\n", is_stable ? "stable" : "unstable", highest);
  }
  if (explain) print_whole_explanation(object["explanation"]);
  return ExitCode::done;
}

}  // namespace stridor
