// Discs with pads in the verbs of small motion.
#pragma once

#include <optional>

#include "app/stability.hpp"
#include "io/disc_scene.hpp"

namespace stridor {

class DiscStabilityScene : public StabilityScene {
 public:
  explicit DiscStabilityScene(LoadedDiscScene loaded) : loaded_(std::move(loaded)) {}

  NumericKey find_key(const std::string& path, const std::string& option) const override {
    return find_numeric_key(DiscScene::schema(), &loaded_.scene, path, option);
  }
  /// The geometry is always the undeformed one.
  std::unique_ptr<StabilityFamily> family(std::vector<NumericKey> keys,
                                          ContactGeometry geometry) const override;
  bool needs_one_thread() const override { return true; }
  std::string hash() const override { return loaded_.hash(); }
  std::string resolved() const override { return loaded_.resolved(); }

 private:
  LoadedDiscScene loaded_;
};

/// The verb `eig` on such a scene: all its eigenvalues, and why one of them grows or decays.
/// @param mode as chosen_mode()
ExitCode eig_of_disc(const StabilityOptions& options, bool explain, const std::optional<int>& mode);

}  // namespace stridor
