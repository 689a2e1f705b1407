// Scenes of small motion in the verbs: discs with pads, bodies given by matrices.
#pragma once

#include <optional>

#include "app/stability.hpp"
#include "io/linear_scene.hpp"

namespace stridor {

class LinearStabilityScene : public StabilityScene {
 public:
  explicit LinearStabilityScene(LoadedLinearScene loaded) : loaded_(std::move(loaded)) {}

  NumericKey find_key(const std::string& path, const std::string& option) const override {
    return find_numeric_key(schema_of(loaded_.scene), object_of(loaded_.scene), path, option);
  }
  /// The geometry is always the undeformed one.
  std::unique_ptr<StabilityFamily> family(std::vector<NumericKey> keys,
                                          ContactGeometry geometry) const override;
  bool needs_one_thread() const override { return true; }
  std::string hash() const override { return loaded_.hash(); }
  std::string resolved() const override { return loaded_.resolved(); }

 private:
  LoadedLinearScene loaded_;
};

/// The verb `eig` on such a scene: its eigenvalues, all by the dense method or those in a window by
/// the sparse one, and why one of them grows or decays.
/// @param mode as chosen_mode()
ExitCode eig_of_linear_scene(const StabilityOptions& options, bool explain,
                             const std::optional<int>& mode);

}  // namespace stridor
