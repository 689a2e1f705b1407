// The places of a master that a slave point passes.
#pragma once

#include <vector>

#include "coupling/system/system.hpp"

namespace stridor {

/// A point of a body: the rows that its displacement is made of, with their weights.
struct WeightedRows {
  std::vector<PointRows> rows;
  std::vector<double> weights;
};

/// Weighted sum of the rows of a matrix, x and y.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& matrix, const WeightedRows& point);

/// Smallest and largest displacement of a drive until `end`, 0 included, m.
struct DriveRange {
  double least = 0.0;
  double most = 0.0;
};
DriveRange drive_range(const Drive& drive, double end);

/// Places on the master that the slave passes until `end`, with some to spare for its deformation:
/// a hundredth of the path and the length of a segment. The ends of every segment and its middle,
/// where the contribution of stiff modes to the flexibility is least.
std::vector<WeightedRows> path_of(const System& system, const ContactPoint& contact, double end);

}  // namespace stridor
