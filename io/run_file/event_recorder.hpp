// From a motion that is followed from event to event to the channels of its run file.
#pragma once

#include <vector>

#include "io/run_file/run_file.hpp"
#include "io/scene/channels.hpp"
#include "solvers/transient/sliding_oscillator.hpp"
#include "solvers/transient/substrate_motion.hpp"

namespace stridor {

/// Writes the channels of a scene at instants, in SI units, as the integrator has them: nothing is
/// filtered, and nothing is said of what lies between two rows.
class EventRecorder {
 public:
  /// Every argument but the channels must live longer.
  EventRecorder(const Model& model, std::vector<Channel> channels,
                const SlidingOscillator& oscillator)
      : model_(&model), channels_(std::move(channels)), oscillator_(&oscillator) {}

  /// Series that the run file must hold for these channels, in the order of the columns.
  static std::vector<SeriesSpec> series(const Model& model, const std::vector<Channel>& channels);

  /// Adds a row.
  /// @param time   s
  /// @param motion there
  /// @throws FileError if the row cannot be written
  void write(double time, const SubstrateMotion& motion, RowSink& rows);

 private:
  double value(const Channel& channel, double time, const SubstrateMotion& motion) const;
  double value_at_point(const Channel& channel, double time, const SubstrateMotion& motion) const;
  double value_of_contact(ContactQuantity quantity, double time,
                          const SubstrateMotion& motion) const;

  const Model* model_;
  std::vector<Channel> channels_;
  const SlidingOscillator* oscillator_;
  std::vector<double> row_;
};

}  // namespace stridor
