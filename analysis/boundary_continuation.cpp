#include "analysis/boundary_continuation.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "analysis/growth_field.hpp"

namespace stridor {
namespace {

using CellPoint = Eigen::Vector2d;  ///< in cells of the grid from its first corner

constexpr double degree = std::numbers::pi / 180.0;
constexpr double first_radius = 0.5;
constexpr double largest_radius = 1.0;
constexpr double least_radius = 1e-3;
constexpr double sharp_turn = 15.0 * degree;
constexpr double slight_turn = 5.0 * degree;
constexpr std::size_t most_points = 100000;

/// One axis: its values as cells.
class Axis {
 public:
  Axis(const std::vector<double>& values, GridSpacing spacing)
      : is_logarithmic_(spacing == GridSpacing::logarithmic) {
    const bool ascends = std::adjacent_find(values.begin(), values.end(), [](double a, double b) {
                           return !(a < b);
                         }) == values.end();
    if (values.size() < 2 || !ascends || (is_logarithmic_ && !(values.front() > 0.0)))
      throw std::invalid_argument("trace_boundary: a grid needs two ascending values or more");
    first_ = values.front();
    last_ = values.back();
    num_cells_ = static_cast<double>(values.size() - 1);
  }

  double cell_of(double value) const {
    const double share = is_logarithmic_ ? std::log(value / first_) / std::log(last_ / first_)
                                         : (value - first_) / (last_ - first_);
    return num_cells_ * share;
  }
  double value_at(double cell) const {
    if (cell <= 0.0) return first_;
    if (cell >= num_cells_) return last_;
    const double share = cell / num_cells_;
    return is_logarithmic_ ? first_ * std::pow(last_ / first_, share)
                           : first_ + share * (last_ - first_);
  }
  double num_cells() const { return num_cells_; }

 private:
  bool is_logarithmic_;
  double first_ = 0.0;
  double last_ = 0.0;
  double num_cells_ = 0.0;
};

class Tracer {
 public:
  Tracer(const std::function<double(double, double)>& margin, const MapGrid& grid)
      : margin_(margin), x_(grid.x, grid.spacing[0]), y_(grid.y, grid.spacing[1]) {}

  CellPoint to_cells(const std::array<double, 2>& place) const {
    return {x_.cell_of(place[0]), y_.cell_of(place[1])};
  }

  /// The whole line through a point of it; empty where the margin does not change its sign there.
  std::vector<CellPoint> line_through(const CellPoint& start) const {
    const std::optional<double> direction = direction_at(start, 1.0);
    if (!direction) return {};
    bool is_closed = false;
    std::vector<CellPoint> line = follow(start, *direction, 1.0, is_closed);
    if (is_closed) return line;
    // The other way the unstable side is on the right.
    const std::optional<double> back = direction_at(start, -1.0);
    if (!back) return line;
    std::vector<CellPoint> before = follow(start, *back, -1.0, is_closed);
    std::reverse(before.begin(), before.end());
    before.insert(before.end(), line.begin() + 1, line.end());
    return before;
  }

  BoundaryLine to_values(const std::vector<CellPoint>& line) const {
    BoundaryLine values;
    values.reserve(line.size());
    for (const CellPoint& point : line)
      values.push_back({x_.value_at(point.x()), y_.value_at(point.y())});
    return values;
  }

 private:
  /// Beyond the edge the margin keeps its value there, so that the line leaves at right angles.
  double margin_at(const CellPoint& at) const {
    return margin_(x_.value_at(at.x()), y_.value_at(at.y()));
  }
  bool is_inside(const CellPoint& at) const {
    return at.x() >= 0.0 && at.x() <= x_.num_cells() && at.y() >= 0.0 && at.y() <= y_.num_cells();
  }
  static CellPoint on_circle(const CellPoint& centre, double radius, double angle) {
    return centre + radius * CellPoint(std::cos(angle), std::sin(angle));
  }

  /// Direction of the line from a point.
  /// @param side 1: unstable on the left, −1: on the right
  std::optional<double> direction_at(const CellPoint& centre, double side) const {
    std::vector<double> angles;
    constexpr int num_angles = 36;
    for (int k = 0; k <= num_angles; ++k) angles.push_back((10.0 * k - 180.0) * degree);
    for (const double radius : {0.1, 0.02, 0.5 * least_radius}) {
      const auto along = [&](double angle) {
        return side * margin_at(on_circle(centre, radius, angle));
      };
      for (const double angle : sign_changes(along, angles))
        if (along(angle + 1e-3) > 0.0 && along(angle - 1e-3) <= 0.0) return angle;
    }
    return std::nullopt;
  }

  /// The angle at which the line cuts a circle, next to an expected one.
  std::optional<double> next_angle(const CellPoint& centre, double radius, double expected,
                                   double side) const {
    const auto along = [&](double angle) {
      return side * margin_at(on_circle(centre, radius, angle));
    };
    for (const double half : {4.0, 12.0, 30.0, 60.0, 100.0, 140.0}) {
      const double low = expected - half * degree;
      const double high = expected + half * degree;
      if (!(along(low) <= 0.0 && along(high) > 0.0)) continue;
      const std::vector<double> found = sign_changes(along, {low, high});
      if (!found.empty()) return found.front();
    }
    return std::nullopt;
  }

  std::vector<CellPoint> follow(const CellPoint& start, double direction, double side,
                                bool& is_closed) const {
    std::vector<CellPoint> line{start};
    double radius = first_radius;
    double farthest = 0.0;
    is_closed = false;
    while (line.size() < most_points) {
      const CellPoint& here = line.back();
      const std::optional<double> angle = next_angle(here, radius, direction, side);
      const double turn = angle ? std::abs(*angle - direction) : 180.0 * degree;
      if (turn > sharp_turn && radius > least_radius) {
        radius *= 0.5;
        continue;
      }
      if (!angle) break;
      const CellPoint next = on_circle(here, radius, *angle);
      if (!is_inside(next)) {
        line.push_back(
            {std::clamp(next.x(), 0.0, x_.num_cells()), std::clamp(next.y(), 0.0, y_.num_cells())});
        break;
      }
      farthest = std::max(farthest, (next - start).norm());
      if (line.size() > 3 && farthest > 2.0 * radius && (next - start).norm() < radius &&
          (next - start).dot(start - here) <= radius * radius) {
        line.push_back(start);
        is_closed = true;
        break;
      }
      line.push_back(next);
      direction = *angle;
      if (turn < slight_turn) radius = std::min(largest_radius, 1.5 * radius);
    }
    return line;
  }

  const std::function<double(double, double)>& margin_;
  Axis x_;
  Axis y_;
};

/// Nearest place on a line to a point.
struct Foot {
  double distance = 1e300;
  std::size_t segment = 0;
  double share = 0.0;  ///< of the segment, 0 to 1
};

Foot foot_on(const std::vector<CellPoint>& line, const CellPoint& point) {
  Foot least;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const CellPoint along = line[i + 1] - line[i];
    const double share = std::clamp(along.dot(point - line[i]) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (point - line[i] - share * along).norm();
    if (distance < least.distance) least = {distance, i, share};
  }
  return least;
}

/// A point known beforehand, on a line that was followed.
struct Insertion {
  Foot foot;
  std::array<double, 2> place{};
};

/// The line with known points in their places; its own points that coincide with them are dropped.
BoundaryLine joined(const BoundaryLine& line, std::vector<Insertion> known) {
  std::sort(known.begin(), known.end(), [](const Insertion& a, const Insertion& b) {
    return std::pair(a.foot.segment, a.foot.share) < std::pair(b.foot.segment, b.foot.share);
  });
  constexpr double same = 1e-6;
  BoundaryLine all;
  auto next = known.begin();
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool was_near_end = next != known.begin() && i > 0 && (next - 1)->foot.segment + 1 == i &&
                              (next - 1)->foot.share > 1.0 - same;
    const bool is_near_start =
        next != known.end() && next->foot.segment == i && next->foot.share < same;
    if (!was_near_end && !is_near_start) all.push_back(line[i]);
    for (; next != known.end() && next->foot.segment == i; ++next) all.push_back(next->place);
  }
  return all;
}

}  // namespace

std::vector<BoundaryLine> trace_boundary(const std::function<double(double, double)>& margin,
                                         const MapGrid& grid,
                                         const std::vector<BoundaryLine>& seeds) {
  const Tracer tracer(margin, grid);
  // A chord of the largest radius that turns by a sharp angle is this far from its arc.
  constexpr double near = 0.05;
  std::vector<std::vector<CellPoint>> lines;
  for (const BoundaryLine& seed : seeds) {
    for (const auto& place : seed) {
      const CellPoint start = tracer.to_cells(place);
      const bool is_known = std::any_of(lines.begin(), lines.end(), [&](const auto& line) {
        return foot_on(line, start).distance < near;
      });
      if (is_known) continue;
      std::vector<CellPoint> line = tracer.line_through(start);
      if (line.size() > 1) lines.push_back(std::move(line));
    }
  }
  std::vector<std::vector<Insertion>> known(lines.size());
  for (const BoundaryLine& seed : seeds) {
    const bool is_closed = seed.size() > 1 && seed.front() == seed.back();
    for (std::size_t i = is_closed ? 1 : 0; i < seed.size(); ++i) {
      Insertion best{{}, seed[i]};
      std::size_t of_line = 0;
      for (std::size_t k = 0; k < lines.size(); ++k) {
        const Foot foot = foot_on(lines[k], tracer.to_cells(seed[i]));
        if (foot.distance < best.foot.distance) {
          best.foot = foot;
          of_line = k;
        }
      }
      if (best.foot.distance < near) known[of_line].push_back(best);
    }
  }
  std::vector<BoundaryLine> traced;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const bool is_closed = lines[k].front() == lines[k].back();
    traced.push_back(joined(tracer.to_values(lines[k]), std::move(known[k])));
    if (is_closed && traced.back().front() != traced.back().back())
      traced.back().push_back(traced.back().front());
  }
  std::stable_sort(traced.begin(), traced.end(), [](const BoundaryLine& a, const BoundaryLine& b) {
    return a.size() > b.size();
  });
  return traced;
}

}  // namespace stridor
