#include "solvers/half_space/contact_edge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace stridor {
namespace {

/// A field over the whole window that runs straight into the edge from one side of it: p² in
/// contact or gap^⅔ out of it; 0 elsewhere.
class StraightField {
 public:
  explicit StraightField(std::size_t num_cells)
      : n_(static_cast<int>(num_cells)), values_(num_cells * num_cells / 2) {}

  int num_cells() const { return n_; }
  double& value(std::size_t cell) { return values_[cell]; }
  /// @param i 0 … N − 1; elsewhere 0
  /// @param j row, mirrored where it is negative
  double at(int i, int j) const {
    if (j < 0) j = -1 - j;
    if (i < 0 || i >= n_ || j >= n_ / 2) return 0.0;
    return values_[static_cast<std::size_t>(j * n_ + i)];
  }

 private:
  int n_;
  std::vector<double> values_;
};

/// First zero at s < 0 of the parabola through the values at s = 0, 1, 2.
double zero_before(double q0, double q1, double q2) {
  const double slope = 0.5 * (4.0 * q1 - 3.0 * q0 - q2);  // at s = 0
  const double bend = 0.5 * (q0 + q2) - q1;
  const double discriminant = slope * slope - 4.0 * bend * q0;
  if (!(slope > 0.0) || discriminant < 0.0) return std::numeric_limits<double>::quiet_NaN();
  return -2.0 * q0 / (slope + std::sqrt(discriminant));
}

/// A place of the edge on a line of cells, and its possible error.
struct EdgeGuess {
  double place = 0.0;
  double doubt = 0.0;
};

/// @param i, j    the last cell of the field's side
/// @param di, dj  from the edge into that side
/// @return place from (i, j) along (di, dj)
std::optional<EdgeGuess> guess(const StraightField& field, int i, int j, int di, int dj) {
  constexpr int skip = 2;  // cells disturbed by the steps of the contact area
  double q[4];
  for (int k = 0; k < 4; ++k) {
    q[k] = field.at(i + (skip + k) * di, j + (skip + k) * dj);
    if (!(q[k] > 0.0)) return {};
  }
  const int a = i + (skip + 1) * di;
  const int b = j + (skip + 1) * dj;
  const double along_x = field.at(a + 1, b) - field.at(a - 1, b);
  const double along_y = field.at(a, b + 1) - field.at(a, b - 1);
  const double inward = di * along_x + dj * along_y;
  const double across = dj * along_x + di * along_y;
  // With a bound below 1, diagonal parts of the edge are seen along both directions.
  if (!(inward > 0.6 * std::abs(across))) return {};
  const double near = skip + zero_before(q[0], q[1], q[2]);
  const double far = skip + 1 + zero_before(q[1], q[2], q[3]);
  // The contact cells say where the edge is to about a cell.
  if (!(std::abs(near) < 1.5) || !(std::abs(far) < 2.5)) return {};
  return EdgeGuess{near, std::abs(near - far) + 1e-3};
}

/// Whether contact cells follow one another without holes along every row and every column.
bool is_one_piece(const StraightField& p2) {
  const int n = p2.num_cells();
  for (int j = 0; j < n / 2; ++j) {
    int num_starts = 0;
    for (int i = 0; i < n; ++i) num_starts += p2.at(i, j) > 0.0 && p2.at(i - 1, j) == 0.0;
    if (num_starts > 1) return false;
  }
  for (int i = 0; i < n; ++i)
    for (int j = 1; j < n / 2; ++j)
      if (p2.at(i, j) > 0.0 && p2.at(i, j - 1) == 0.0) return false;
  return true;
}

/// Where the edge crosses the lines of cells, seen from both sides.
std::vector<std::array<double, 2>> edge_points(const StraightField& p2,
                                               const StraightField& opening) {
  const int n = p2.num_cells();
  std::vector<std::array<double, 2>> points;
  for (int j = 0; j < n / 2; ++j) {
    for (int i = 0; i < n; ++i) {
      if (p2.at(i, j) == 0.0) continue;
      for (const auto& [di, dj] : {std::array{1, 0}, std::array{-1, 0}, std::array{0, 1}}) {
        if (p2.at(i + di, j + dj) > 0.0) continue;
        const std::optional<EdgeGuess> inside = guess(p2, i, j, -di, -dj);
        const std::optional<EdgeGuess> outside = guess(opening, i + di, j + dj, di, dj);
        if (!inside && !outside) continue;
        const double trust_inside = inside ? 1.0 / (inside->doubt * inside->doubt) : 0.0;
        const double trust_outside = outside ? 1.0 / (outside->doubt * outside->doubt) : 0.0;
        const double place = ((inside ? -inside->place : 0.0) * trust_inside +
                              (outside ? 1.0 + outside->place : 0.0) * trust_outside) /
                             (trust_inside + trust_outside);
        points.push_back({i + 0.5 - 0.5 * n + di * place, j + 0.5 + dj * place});
      }
    }
  }
  return points;
}

/// Sorts the points by their angle about the centre. @returns the area within, nothing where a
/// piece of the edge is unseen
std::optional<double> area_within(ContactEdge& edge) {
  const auto angle = [&](const std::array<double, 2>& point) {
    return std::atan2(point[1], point[0] - edge.centre);
  };
  std::sort(edge.points.begin(), edge.points.end(),
            [&](const auto& a, const auto& b) { return angle(a) < angle(b); });
  // Steps of more than a few cells along the edge would leave a piece of it unseen.
  double seen = 0.0;
  double widest = edge.points.empty() ? std::numbers::pi : 0.0;
  double sum = 0.0;
  for (std::size_t k = 0; k <= edge.points.size() && !edge.points.empty(); ++k) {
    const double to = k < edge.points.size() ? angle(edge.points[k]) : std::numbers::pi;
    const auto squared = [&](std::size_t m) {
      const auto& point = edge.points[std::min(m, edge.points.size() - 1)];
      const double dx = point[0] - edge.centre;
      return dx * dx + point[1] * point[1];
    };
    // The first and the last point have their mirror images beyond the axis.
    const double before = squared(k == 0 ? 0 : k - 1);
    sum += 0.5 * (before + squared(k)) * (to - seen);
    widest = std::max(widest, to - seen);
    seen = to;
  }
  const double radius = std::sqrt(edge.area / std::numbers::pi);
  if (edge.points.size() < 8 || widest * radius > 5.0) return std::nullopt;
  return sum;
}

}  // namespace

ContactEdge find_contact_edge(std::span<const double> pressure, std::span<const double> gap,
                              std::size_t num_cells) {
  const std::size_t size = num_cells * num_cells / 2;
  if (pressure.size() != size || gap.size() != size) {
    throw std::invalid_argument(
        fmt::format("find_contact_edge: {} pressures and {} gaps are not half of {} x {}",
                    pressure.size(), gap.size(), num_cells, num_cells));
  }
  StraightField p2(num_cells);
  StraightField opening(num_cells);
  for (std::size_t cell = 0; cell < size; ++cell) {
    if (pressure[cell] > 0.0) {
      p2.value(cell) = pressure[cell] * pressure[cell];
    } else if (gap[cell] > 0.0 && std::isfinite(gap[cell])) {
      opening.value(cell) = std::cbrt(gap[cell] * gap[cell]);
    }
  }
  const int n = p2.num_cells();
  ContactEdge edge;
  int first = n;
  int last = -1;
  for (int j = 0; j < n / 2; ++j) {
    for (int i = 0; i < n; ++i) {
      if (p2.at(i, j) == 0.0) continue;
      edge.area += 2.0;
      first = std::min(first, i);
      last = std::max(last, i);
    }
  }
  if (last < 0) return edge;
  edge.centre = 0.5 * (first + last + 1 - n);
  if (!is_one_piece(p2)) return edge;

  edge.points = edge_points(p2, opening);
  const std::optional<double> area = area_within(edge);
  if (!area) {
    edge.points.clear();
    return edge;
  }
  edge.area = *area;
  edge.is_resolved = true;
  return edge;
}

}  // namespace stridor
