// Progress of the computations that follow eigenvalues along a key.
#pragma once

#include "app/stability/key_range.hpp"
#include "app/stability/stability_family.hpp"
#include "app/terminal/progress.hpp"

namespace stridor {

/// Reports the progress of a family along its range and then, as windows are refined, which of the
/// parts known so far is at work (Activity: a branch, an interval). The time left is told where
/// their number stays, as that of branches; intervals are halved, so that more of them come. Where
/// no part is named, the number of values computed.
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
