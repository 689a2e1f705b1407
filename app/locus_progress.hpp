// Progress of the computations that follow eigenvalues along a key.
#pragma once

#include "app/progress.hpp"
#include "app/stability.hpp"

namespace stridor {

/// Reports the progress of a family along its range and then, as windows are refined, the number of
/// values computed: the total is not known beforehand.
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
