#include "solvers/integrators/contact_path.hpp"

#include <algorithm>

namespace stridor {

Eigen::MatrixXd rows_of(const Eigen::MatrixXd& matrix, const WeightedRows& point) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(2, matrix.cols());
  for (std::size_t k = 0; k < point.rows.size(); ++k) {
    sum.row(0) += point.weights[k] * matrix.row(point.rows[k].x);
    sum.row(1) += point.weights[k] * matrix.row(point.rows[k].y);
  }
  return sum;
}

DriveRange drive_range(const Drive& drive, double end) {
  DriveRange range;
  constexpr int num_instants = 1000;
  for (int i = 0; i <= num_instants; ++i) {
    const double moved = drive.displacement(end * i / num_instants);
    range.least = std::min(range.least, moved);
    range.most = std::max(range.most, moved);
  }
  return range;
}

std::vector<WeightedRows> path_of(const System& system, const ContactPoint& contact, double end) {
  const MasterSurface& surface = system.surface_of(contact);
  const double share = system.path_share(contact);
  const DriveRange range = drive_range(system.leading_drive(), end);
  const double least = std::min(share * range.least, share * range.most);
  const double most = std::max(share * range.least, share * range.most);
  double longest = 0.0;
  for (std::size_t k = 1; k < surface.arc_length.size(); ++k)
    longest = std::max(longest, surface.arc_length[k] - surface.arc_length[k - 1]);
  const double spare = 0.01 * (most - least) + longest;

  std::vector<WeightedRows> path;
  for (int segment = 0; segment < surface.num_segments(); ++segment) {
    const Segment ends = surface.undeformed_segment(segment);
    const double first = ends.first.x() - contact.slave_position.x();
    const double last = ends.second.x() - contact.slave_position.x();
    if (std::max(first, last) < least - spare || std::min(first, last) > most + spare) continue;
    const Stencil stencil = surface.stencil(segment);
    const auto node = surface.rows.begin() + stencil.first;
    for (const double xi : {0.0, 0.5, 1.0}) {
      const auto& weights = weights_at(stencil, xi).value;
      path.push_back(
          {{node, node + stencil.count}, {weights.begin(), weights.begin() + stencil.count}});
    }
  }
  return path;
}

}  // namespace stridor
