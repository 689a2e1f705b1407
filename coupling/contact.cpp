#include "coupling/contact.hpp"

namespace stridor {
namespace {

Eigen::Vector2d turned_left(const Eigen::Vector2d& vector) {
  return {-vector.y(), vector.x()};
}

}  // namespace

Projection project(const Segment& segment, const Eigen::Vector2d& slave) {
  const Eigen::Vector2d along = segment.second - segment.first;
  const double length = along.norm();
  Projection projection;
  projection.tangent = along / length;
  projection.normal = turned_left(projection.tangent);
  projection.xi = projection.tangent.dot(slave - segment.first) / length;
  return projection;
}

Projection project_along(const Segment& segment, const Eigen::Vector2d& slave,
                         const Eigen::Vector2d& tangent) {
  Projection projection;
  projection.tangent = tangent;
  projection.normal = turned_left(tangent);
  projection.xi = tangent.dot(slave - segment.first) / tangent.dot(segment.second - segment.first);
  return projection;
}

ContactRows make_rows(const Projection& projection, double friction, double direction) {
  const Eigen::Vector2d& n = projection.normal;
  const Eigen::Vector2d pull = n - (direction * friction) * projection.tangent;
  const double w1 = 1.0 - projection.xi;
  const double w2 = projection.xi;
  return {{{-n.x(), -n.y()}, {w1 * n.x(), w1 * n.y(), w2 * n.x(), w2 * n.y()}},
          {{-pull.x(), -pull.y()}, {w1 * pull.x(), w1 * pull.y(), w2 * pull.x(), w2 * pull.y()}}};
}

}  // namespace stridor
