// Shapes of the bodies during a run, for ParaView.
#pragma once

#include <filesystem>
#include <vector>

#include "core/state.hpp"
#include "io/results/vtu_writer.hpp"
#include "models/mode_shape.hpp"

namespace stridor {

/// Writes files `frame_NNNNN.vtu` at equal times and `run.pvd`, which shows them one after the other.
/// Points stand where the bodies are, their displacement from rest is a vector of each.
class RunFrames {
 public:
  /// @param model  must outlive this
  /// @param folder made where it is missing
  /// @throws FileError if it cannot be made
  RunFrames(const Model& model, std::filesystem::path folder);

  /// @param number from 0
  /// @param motion RunDriver::present_motion()
  /// @throws FileError if a file cannot be written
  void write(int number, const State& motion);
  /// Takes up a frame that an earlier part of the run wrote, where it is there.
  void adopt(int number, double time);
  int num_frames() const { return static_cast<int>(written_.size()); }
  std::filesystem::path collection() const { return folder_ / "run.pvd"; }

 private:
  std::filesystem::path name_of(int number) const;

  const Model* model_;
  std::filesystem::path folder_;
  BodyCache cache_;
  ShapeRecovery recovery_;
  std::vector<TimedFile> written_;
};

}  // namespace stridor
