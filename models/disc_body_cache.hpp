// Plates and pads, kept for the next disc that has the same ones.
#pragma once

#include <string>
#include <vector>

#include "models/disc_parameters.hpp"

namespace stridor {

/// Makes plates and pads from their parameters, each once: along a key of friction, contact or
/// speed they stay the same, and a mesh is reduced only once. What has not been used for longest is
/// forgotten first. For one thread.
class DiscBodyCache {
 public:
  /// @throws as AnnularPlate
  const AnnularPlate& plate(const AnnularPlateParameters& parameters, double prestress_speed);
  /// @throws as make_elastic_pad() and make_rigid_pad()
  const PadBody& pad(const PadsParameters& parameters, const std::vector<double>& offsets);

  /// Pads made so far, those forgotten included.
  int num_pads() const { return num_pads_; }

 private:
  template <class Body>
  struct Entry {
    std::string key;
    Body body;
  };
  std::vector<Entry<AnnularPlate>> plates_;  ///< last used at the end
  std::vector<Entry<PadBody>> pads_;
  int num_pads_ = 0;
};

}  // namespace stridor
