// When a run of a scene passes the places at which its vibrations grow, and how far they grow
// there.
#pragma once

#include <optional>
#include <vector>

#include "analysis/locus.hpp"
#include "app/stability/stability_family.hpp"
#include "io/results/locus_file.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// Time at which a run of the scene first comes to a sliding state; NaN where it never does.
class PassingTimes {
 public:
  PassingTimes(const Scene& scene, BodyStabilityFamily& family)
      : end_(scene.time->end), family_(&family) {}

  /// @param place position of the contact, or displacement of the drive
  double at(double place) const;

 private:
  double end_;
  BodyStabilityFamily* family_;
};

/// Windows with their times in the run of the scene, and the growth in them; NaN where it does not
/// pass them.
/// @param times none where no run of the scene passes any
std::vector<TimedWindow> timed_windows(const Locus& locus,
                                       const std::optional<PassingTimes>& times);

}  // namespace stridor
