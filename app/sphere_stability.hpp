// Small motions of a sphere on a viscoelastic substrate, for the verbs about eigenvalues.
#pragma once

#include "app/stability.hpp"
#include "io/sphere_scene.hpp"

namespace stridor {

/// A number of such a scene that changes how the sphere moves.
/// @throws ConfigError as find_stability_key()
NumericKey find_sphere_key(const SphereScene& scene, const std::string& path,
                           const std::string& option);

class SphereStabilityScene : public StabilityScene {
 public:
  explicit SphereStabilityScene(LoadedSphereScene loaded) : loaded_(std::move(loaded)) {}

  NumericKey find_key(const std::string& path, const std::string& option) const override {
    return find_sphere_key(loaded_.scene, path, option);
  }
  std::unique_ptr<StabilityFamily> family(std::vector<NumericKey> keys,
                                          ContactGeometry geometry) const override;
  std::unique_ptr<GrowthField> growth_field(const std::vector<NumericKey>& keys) const override;
  /// ω_nx.
  double rate_unit(const std::vector<NumericKey>& keys,
                   std::span<const double> values) const override {
    return with_values(loaded_, keys, values).model.sphere.natural_frequency;
  }
  std::string hash() const override { return loaded_.hash(); }
  std::string resolved() const override { return loaded_.resolved(); }

 private:
  LoadedSphereScene loaded_;
};

/// The steady sliding of a sphere.
/// @throws NumericalError if there is none
SubstrateEquilibrium sphere_equilibrium(const SubstrateOscillator& oscillator);

/// Dimensionless and dimensional numbers of a state of sliding, and remarks on the law's range.
Json sphere_equilibrium_json(const SphereNumbers& numbers, const SubstrateOscillator& oscillator,
                             const SubstrateEquilibrium& equilibrium);

/// The verb `eig` on such a scene.
ExitCode eig_of_sphere(const StabilityOptions& options);

}  // namespace stridor
