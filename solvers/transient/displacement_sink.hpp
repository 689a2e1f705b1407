// A sink of samples of one displacement.
#pragma once

#include <optional>

#include "solvers/transient/simulation.hpp"

namespace stridor {

/// A sink that may read nothing but the displacement of one row of one body. It then takes the
/// value that a batch of simulations computes on the way.
class DisplacementSink : public SampleSink {
 public:
  struct Row {
    int body = 0;
    int row = 0;
  };

  /// The row, where `sample` reads nothing else.
  virtual std::optional<Row> sole_row() const = 0;
  /// In place of `sample`, where there is a sole row.
  /// @throws as sample()
  virtual void sample_displacement(double displacement) = 0;
};

}  // namespace stridor
