// Progress of the computations that follow eigenvalues along a key.
#pragma once

#include "app/progress.hpp"
#include "app/stability.hpp"

namespace stridor {

/// Tells how far along its range a family is, and then, as windows are refined, how many values
/// have been looked at: how many it takes, nobody knows.
class LocusProgress {
 public:
  /// @param family, range must live longer
  LocusProgress(const std::string& verb, StabilityFamily& family, const KeyRange& range);
  ~LocusProgress();
  LocusProgress(const LocusProgress&) = delete;
  LocusProgress& operator=(const LocusProgress&) = delete;

  const Progress& progress() const { return progress_; }

 private:
  void look_at(double value);

  Progress progress_;
  StabilityFamily& family_;
  const KeyRange& range_;
  double reached_;
  int num_refined_ = 0;
};

}  // namespace stridor
