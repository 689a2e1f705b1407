// From a disc in motion between its pads to the channels of its run file.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/low_pass.hpp"
#include "core/errors.hpp"
#include "io/contact_intervals.hpp"
#include "io/run_file.hpp"
#include "models/disc_model.hpp"
#include "solvers/face_contact_motion.hpp"

namespace stridor {

/// "upper" and "lower", with an index where a pad has several contact points.
/// @param contact    number, those of the upper pad first
/// @param per_pad    contact points of a pad
std::string disc_contact_name(std::size_t contact, std::size_t per_pad);

/// All channels that a disc has, by the names that a scene gives them:
/// pad.<contact>.<r|phi|z>.<displacement|velocity|acceleration>, disc.<contact>.z.<...>,
/// <contact>.<force|friction_force|gap|slip_velocity|state>.
std::vector<std::string> disc_channels(std::size_t per_pad);

/// What is wrong with the names of channels: they must be among those, each once.
std::vector<Problem> channel_problems(const std::vector<std::string>& channels,
                                      std::size_t per_pad);

/// Low-passes, thins and writes the channels of a disc, as Recorder does for beams: contact forces
/// and states as they are, with what their contacts do between the rows.
class DiscRecorder {
 public:
  /// @param channels by name; empty: all
  /// @throws ConfigError with channel_problems()
  DiscRecorder(const DiscModel& model, const std::vector<std::string>& channels, double step,
               double interval);

  const std::vector<SeriesSpec>& series() const { return series_; }
  /// Steps that must follow the last wanted sample before it is written.
  std::int64_t latency() const { return filter_->half_length(); }
  /// To be called at every step, t = 0 included.
  /// @param last number of the last sample that is wanted
  void sample(const FaceContactMotion& motion, RunFileWriter& writer, std::int64_t last);

  void save(State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if the state is of other channels
  void load(const State& state, const std::string& prefix);

 private:
  /// What one step gives: a displacement, a quantity of a contact, or its state.
  struct Stream {
    std::string name;
    std::optional<FacePort> port;  ///< of a displacement; none: of a contact
    int contact = 0;
    double FaceContactState::*member = nullptr;  ///< null: the state
    Decimator decimator;
  };
  struct Column {
    std::size_t stream = 0;
    std::optional<Derivative> derivative{};
    double (*of_interval)(const ContactStatistics&) = nullptr;
    std::size_t contact = 0;
  };

  static double value(const Stream& stream, const FaceContactMotion& motion);
  double value(const Column& column) const;

  double interval_;
  std::shared_ptr<const DecimationFilter> filter_;
  std::vector<Stream> streams_;
  std::vector<Column> columns_;
  std::vector<SeriesSpec> series_;
  ContactIntervals intervals_;
  std::vector<ContactStatistics> of_step_;  ///< of every contact
  std::vector<double> row_;
};

}  // namespace stridor
