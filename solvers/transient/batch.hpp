// Several simulations stepped simultaneously.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "solvers/transient/displacement_sink.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {

/// Steps independent simulations together, each in a lane of the processor's vectors.
///
/// In lanes are those with one contact that slides for good on a polyline between two bodies in
/// modal form, under a friction that does not depend on the speed and without roughness; lanes step
/// together where their bodies have as many modes each. While its load, drive, friction or damping
/// change, for a step that takes a contact to another segment, and for everything that ends a run,
/// a simulation steps by itself, as others do all the time.
///
/// A simulation ends bit-identically, whatever the others in its batch are and in whatever order;
/// it differs by rounding from one that is stepped without a batch.
class Batch {
 public:
  /// @param runs not null; must live longer. They must not be stepped or loaded meanwhile.
  explicit Batch(std::vector<Simulation*> runs);
  ~Batch();
  Batch(Batch&&) noexcept;
  Batch& operator=(Batch&&) noexcept;

  /// From now on hands the displacement of its sole row to a sink, after every step that it asks
  /// for; stepping on need not be interrupted for that.
  /// @param run  one that steps in lanes
  /// @param sink with a sole row; must live longer
  /// @throws std::invalid_argument if `run` or `sink` is another, or a sample is due already
  void watch(std::size_t run, DisplacementSink& sink);

  /// Steps every simulation that has not failed until it is at `target`, as
  /// Simulation::step_until(). They then provide displacements, contacts and
  /// statistics, which may be reset; for all else, `synchronise` first.
  void step_until(std::int64_t target);
  /// Gives the simulations their whole state.
  void synchronise();
  /// Of the last step of a simulation; any outcome but `done` is final.
  StepOutcome outcome(std::size_t run) const;
  /// Whether it is one that steps in lanes.
  bool steps_in_lanes(std::size_t run) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace stridor
