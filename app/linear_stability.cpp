#include "app/linear_stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/eigenvalue_report.hpp"
#include "core/errors.hpp"
#include "solvers/dense_eigenvalues.hpp"
#include "solvers/linear_pencil.hpp"

namespace stridor {
namespace {

class LinearFamily : public StabilityFamily {
 public:
  LinearFamily(LoadedLinearScene loaded, std::vector<NumericKey> keys)
      : loaded_(std::move(loaded)), keys_(std::move(keys)) {}

  Pencil pencil(std::span<const double> values) override {
    return make_pencil(loaded_.model(keys_, values).dense);
  }
  bool is_sampled() const override { return true; }

 private:
  LoadedLinearScene loaded_;
  std::vector<NumericKey> keys_;
};

/// The contacts of the sliding state, with the forces about which the system is linearised.
Json equilibrium_json(const LinearModel& model, const DiscScene& scene) {
  Json contacts = Json::array();
  const double friction =
      disc_terms(scene.model.terms).friction ? scene.model.contact.friction.coefficient : 0.0;
  for (const FaceContact& contact : model.disc->contacts) {
    contacts.push_back({{"side", contact.side},
                        {"force", number(model.disc->contact_preload)},
                        {"friction_force", number(friction * model.disc->contact_preload)},
                        {"slip_velocity", number(scene.model.disc.speed * contact.radius)}});
  }
  return {{"contacts", contacts}};
}

/// Up to where a verdict holds: what was computed, and what the model answers for.
double window_of(const std::vector<Eigenvalue>& shown, bool is_all, double trusted) {
  if (is_all) return trusted;
  return std::min(trusted, shown.empty() ? 0.0 : shown.back().frequency());
}

/// The modes without friction, damping and rotation that a motion is made of.
Json frictionless_modes_json(const Pencil& pencil, const Eigen::VectorXcd& right) {
  std::vector<Eigenvalue> modes = dense_eigenvalues(frictionless(pencil));
  std::erase_if(modes, [](const Eigenvalue& one) { return !(one.s.imag() > 0.0); });
  const std::vector<Participation> shares = participations(pencil, modes, right);
  Json list = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(2, shares.size()); ++i)
    list.push_back({{"frequency", shares[i].frequency}, {"share", shares[i].share}});
  return list;
}

void print_explanation(const Json& explanation) {
  fmt::print("\nmode {} at {:.6g} Hz, growth {:.6g} 1/s\n", explanation["mode"].get<int>(),
             explanation["frequency"].get<double>(), explanation["growth"].get<double>());
  print_quotients(explanation["quotients"]);
  for (const Json& one : explanation["frictionless_modes"]) {
    fmt::print("  {:.1f} % of it is the mode of {:.6g} Hz of the symmetric system\n",
               100.0 * one["share"].get<double>(), one["frequency"].get<double>());
  }
}

}  // namespace

std::unique_ptr<StabilityFamily> LinearStabilityScene::family(std::vector<NumericKey> keys,
                                                              ContactGeometry) const {
  return std::make_unique<LinearFamily>(loaded_, std::move(keys));
}

ExitCode eig_of_linear_scene(const StabilityOptions& options, bool explain,
                             const std::optional<int>& mode) {
  const LoadedLinearScene loaded = load_linear_scene(options.scene, options.common.sets);
  const LinearModel model = loaded.model();
  const Pencil pencil = make_pencil(model.dense);
  const DenseSpectrum spectrum = dense_spectrum(pencil);
  std::vector<Eigenvalue> eigenvalues = spectrum.eigenvalues;
  const std::size_t num_real = num_real_of(eigenvalues);
  const std::size_t num_shown =
      std::min(eigenvalues.size(), num_real + static_cast<std::size_t>(options.count));
  const bool is_all = num_shown == eigenvalues.size();
  eigenvalues.resize(num_shown);
  const double highest = window_of(eigenvalues, is_all, model.highest_frequency);
  const bool is_stable = std::none_of(
      eigenvalues.begin(), eigenvalues.end(),
      [&](const Eigenvalue& one) { return one.frequency() <= highest && is_growing(one); });

  Json object = {{"about", options.about},          {"method", options.method},
                 {"equilibrium", Json::object()},   {"eigenvalues", eigenvalues_json(eigenvalues)},
                 {"residuals", Json::array()},      {"stable", is_stable},
                 {"window", {0.0, number(highest)}}};
  if (const DiscScene* disc = std::get_if<DiscScene>(&loaded.scene))
    object["equilibrium"] = equilibrium_json(model, *disc);
  for (const Eigenvalue& one : eigenvalues) object["residuals"].push_back(number(one.residual));
  if (explain) {
    const std::size_t chosen = chosen_mode(eigenvalues, num_real, mode);
    const Eigen::VectorXcd right = spectrum.right.col(static_cast<Eigen::Index>(chosen));
    const Eigenvalue& one = eigenvalues[chosen];
    object["explanation"] = {{"mode", chosen - num_real + 1},
                             {"frequency", one.frequency()},
                             {"growth", one.growth()},
                             {"quotients", quotients_json(mode_quotients(pencil, one.s, right))},
                             {"frictionless_modes", frictionless_modes_json(pencil, right)}};
  }
  if (options.common.json) {
    fmt::print("{}\n", object.dump(2));
    return ExitCode::done;
  }
  print_eigenvalues(eigenvalues, model.highest_frequency);
  if (is_all && highest == model.highest_frequency && !std::isfinite(highest)) {
    fmt::print("{} at all frequencies\n", is_stable ? "stable" : "unstable");
  } else {
    fmt::print("{} between 0 and {:.6g} Hz\n", is_stable ? "stable" : "unstable", highest);
  }
  if (explain) print_explanation(object["explanation"]);
  return ExitCode::done;
}

}  // namespace stridor
