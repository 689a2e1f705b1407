// From a running simulation to the channels of its run file.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "analysis/low_pass.hpp"
#include "io/run_file/contact_intervals.hpp"
#include "io/run_file/run_file.hpp"
#include "io/scene/channels.hpp"
#include "solvers/transient/displacement_sink.hpp"

namespace stridor {

/// Number of steps between the looks of a recorder at a simulation.
///
/// The low-pass in front of the thinning takes what lies above 0.6 of the recording rate, but what
/// lies near its own input rate folds below that. So the rate of looking is at least the highest
/// frequency with a damping ratio below 5 % (stiffer damped modes do not ring) plus 0.6 of the
/// recording rate, and at least five looks per recorded sample where there are as many steps.
/// Within that the fewest. A quantity that changes from step to step, such as the friction
/// force in a start-up that violates persistent sliding, is not band-limited and does fold.
///
/// @param ratio steps per recorded sample
/// @return a divisor of `ratio`
int sampling_stride(const System& system, double step, int ratio);

/// Low-passes, thins and writes the channels of a scene.
///
/// Motions are low-passed with linear phase, so that sample k is the value at k·interval; contact
/// forces, states and energies are taken at that instant as they are. Beside a contact force stand
/// its extremes over every step since the row before and its low-passed series, beside a state the
/// shares of those steps (ContactIntervals).
class Recorder : public DisplacementSink {
 public:
  /// @param rows receives the rows; must live longer
  Recorder(const Model& model, std::vector<Channel> channels, double step, double interval,
           RowSink& rows);

  /// Series that the run file must hold for these channels, in the order of the columns.
  static std::vector<SeriesSpec> series(const Model& model, const std::vector<Channel>& channels,
                                        double step, double interval);

  std::int64_t next_step() const override { return next_step_; }
  /// @throws FileError if a row cannot be written
  /// @throws std::invalid_argument if an energy is to be recorded that the simulation does not keep
  void sample(const Simulation& simulation) override;
  std::optional<Row> sole_row() const override;
  void sample_displacement(double displacement) override;

  /// Steps that must follow the last wanted sample before it is written.
  std::int64_t latency() const;
  /// Writes at most this many samples; later ones are dropped.
  void limit_samples(std::int64_t count) { max_samples_ = count; }

  void save(State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if the state is of other channels
  void load(const State& state, const std::string& prefix);

 private:
  /// One sampled quantity and its filter.
  struct Stream {
    std::optional<Model::Point> point;  ///< of a motion
    int direction = 0;
    int drive = -1;  ///< of which the displacement is added; −1: of none
    int contact = 0;
    ContactQuantity quantity = ContactQuantity::force;
    const EnergyEntry* energy = nullptr;
    Decimator decimator;

    double value(const Simulation& simulation) const;
  };
  /// One column of the run file.
  struct Column {
    std::size_t stream = 0;
    std::optional<Derivative> derivative{};  ///< of the low-passed stream; none: the sample itself
    /// Instead of a stream: a number of the contact's interval.
    double (*of_interval)(const ContactStatistics&) = nullptr;
    std::size_t contact = 0;
  };

  void write_row();
  double value(const Column& column) const;
  void add_motion(const Model& model, const Channel& channel,
                  const std::shared_ptr<const DecimationFilter>& filter);
  void add_contact(const Channel& channel, int contact,
                   const std::shared_ptr<const DecimationFilter>& filter);

  int stride_;
  double interval_;
  std::int64_t next_step_ = 0;
  std::int64_t max_samples_;
  std::vector<Stream> streams_;
  std::vector<Column> columns_;
  std::optional<ContactIntervals> intervals_;      ///< where a column shows them
  std::vector<ContactStatistics> since_last_look_;  ///< of every contact
  std::vector<double> row_;
  RowSink* rows_;
};

}  // namespace stridor
