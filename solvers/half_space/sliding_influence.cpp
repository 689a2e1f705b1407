#include "solvers/half_space/sliding_influence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>

namespace stridor {
namespace {

/// Nodes and weights of Gauss and Legendre on [−1, 1].
struct GaussRule {
  std::vector<double> nodes;
  std::vector<double> weights;
};

/// P_0 … P_{count−1} at x.
std::vector<double> legendre(double x, std::size_t count) {
  std::vector<double> p(std::max<std::size_t>(count, 2), 1.0);
  p[1] = x;
  for (std::size_t m = 2; m < count; ++m) {
    const auto degree = static_cast<double>(m);
    p[m] = ((2.0 * degree - 1.0) * x * p[m - 1] - (degree - 1.0) * p[m - 2]) / degree;
  }
  return p;
}

GaussRule gauss_rule(std::size_t count) {
  GaussRule rule{std::vector<double>(count), std::vector<double>(count)};
  const auto n = static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) {
    double x = -std::cos(std::numbers::pi * (static_cast<double>(k) + 0.75) / (n + 0.5));
    double slope = 0.0;
    for (int i = 0; i < 8; ++i) {  // Newton's method; quadratic from this start
      const std::vector<double> p = legendre(x, count + 1);
      slope = n * (x * p[count] - p[count - 1]) / (x * x - 1.0);
      x -= p[count] / slope;
    }
    rule.nodes[k] = x;
    rule.weights[k] = 2.0 / ((1.0 - x * x) * slope * slope);
  }
  return rule;
}

/// Weights with which values at Gauss points of [a, b] give ∫_a^b κ exp(−κ t) f(t) dt, exact where
/// f is a polynomial of degree below the number of points, whatever κ.
std::vector<double> fading_weights(const GaussRule& rule, double a, double b, double kappa) {
  const std::size_t count = rule.nodes.size();
  // Moments ∫_{−1}^{1} exp(−c(s + 1)) P_m(s) ds on pieces in which the exponential is smooth.
  static const GaussRule fine = gauss_rule(24);
  const double half = 0.5 * (b - a);
  const double c = kappa * half;
  std::vector<double> moments(count, 0.0);
  double from = -1.0;
  double length = std::min(2.0, 4.0 / std::max(c, 1e-300));
  while (from < 1.0 && c * (from + 1.0) < 750.0) {
    const double to = std::min(1.0, from + length);
    for (std::size_t g = 0; g < fine.nodes.size(); ++g) {
      const double s = 0.5 * (from + to) + 0.5 * (to - from) * fine.nodes[g];
      const double weight = 0.5 * (to - from) * fine.weights[g] * std::exp(-c * (s + 1.0));
      const std::vector<double> p = legendre(s, count);
      for (std::size_t m = 0; m < count; ++m) moments[m] += weight * p[m];
    }
    from = to;
  }
  std::vector<double> weights(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<double> p = legendre(rule.nodes[k], count);
    double sum = 0.0;
    for (std::size_t m = 0; m < count; ++m)
      sum += (static_cast<double>(m) + 0.5) * p[m] * moments[m];
    weights[k] = kappa * std::exp(-kappa * a) * half * rule.weights[k] * sum;
  }
  return weights;
}

/// Love's closed form: ∫∫ dξ dη / r over [0, a] × [0, b], odd in a and in b.
double love_corner(double a, double b) {
  const double first = a != 0.0 ? a * std::asinh(b / std::abs(a)) : 0.0;
  const double second = b != 0.0 ? b * std::asinh(a / std::abs(b)) : 0.0;
  return first + second;
}

/// Panels that shrink towards t = 1/2, where the edge of the loaded square makes L ~ t log t.
std::vector<double> graded_panels() {
  std::vector<double> ends{0.0, 0.5, 1.0};
  for (int level = 0; level < 20; ++level) {
    const double distance = 0.5 * std::pow(0.2, level + 1);
    ends.push_back(0.5 - distance);
    ends.push_back(0.5 + distance);
  }
  std::sort(ends.begin(), ends.end());
  return ends;
}

enum MarchKind : std::size_t { edge, near, middle, far, num_march_kinds };

}  // namespace

double love_square(double x, double y) {
  // Beyond 24 sides the four corners cancel to 1e-12 of L, and 3 × 3 points are as good.
  if (x * x + y * y < 576.0) {
    return love_corner(x + 0.5, y + 0.5) - love_corner(x + 0.5, y - 0.5) -
           love_corner(x - 0.5, y + 0.5) + love_corner(x - 0.5, y - 0.5);
  }
  constexpr std::array<double, 3> offset{-0.3872983346207417, 0.0, 0.3872983346207417};
  constexpr std::array<double, 3> weight{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double dx = x - offset[i];
    for (std::size_t j = 0; j < 3; ++j) {
      const double dy = y - offset[j];
      sum += weight[i] * weight[j] / std::sqrt(dx * dx + dy * dy);
    }
  }
  return sum;
}

SlidingInfluence::SlidingInfluence(std::size_t num_cells) : num_cells_(num_cells) {
  if (num_cells < 2 || num_cells > 4096) {
    throw std::invalid_argument(
        fmt::format("SlidingInfluence: {} cells a side are not 2 to 4096", num_cells));
  }
  // The singularities of L are the corners of the loaded square (and its edges, on the row j = 0).
  // Interpolation in q points fails by (distance/half a step · 2)^−q.
  marches_.resize(num_march_kinds);
  marches_[edge] = {graded_panels(), 10};
  marches_[near] = {{0.0, 0.25, 0.5, 0.75, 1.0}, 10};
  marches_[middle] = {{0.0, 1.0}, 10};
  marches_[far] = {{0.0, 1.0}, 5};

  const int n = static_cast<int>(num_cells);
  const auto kind_of = [](int i, int j) {
    if (j == 0 && (i == -1 || i == 0)) return edge;
    const double distance = std::hypot(i + 0.5, j);
    return distance < 4.0 ? near : distance < 18.0 ? middle : far;
  };
  std::vector<std::vector<double>> places(num_march_kinds);
  for (std::size_t kind = 0; kind < num_march_kinds; ++kind) {
    const March& march = marches_[kind];
    const GaussRule rule = gauss_rule(march.num_nodes);
    for (std::size_t panel = 0; panel + 1 < march.panel_ends.size(); ++panel) {
      const double a = march.panel_ends[panel];
      const double b = march.panel_ends[panel + 1];
      for (const double node : rule.nodes)
        places[kind].push_back(0.5 * (a + b) + 0.5 * (b - a) * node);
    }
  }
  love_.resize((num_cells + 1) * 2 * num_cells);
  stretches_.resize(num_cells + 1);
  for (int j = 0; j <= n; ++j) {
    auto& row = stretches_[static_cast<std::size_t>(j)];
    for (int i = -n; i < n; ++i) {
      const auto column = static_cast<std::size_t>(i >= 0 ? i : i + 2 * n);
      love_[static_cast<std::size_t>(j) * 2 * num_cells + column] = love_square(i, j);
      const MarchKind kind = kind_of(i, j);
      if (row.empty() || row.back().march != kind) row.push_back({i, i, kind, samples_.size()});
      row.back().last = i;
      for (const double t : places[kind]) samples_.push_back(love_square(i + t, j));
    }
  }
}

void SlidingInfluence::add_memory(const SlidingCreep& creep, double cell_side,
                                  InfluenceTable& table) const {
  const int n = static_cast<int>(num_cells_);
  const double kappa = cell_side / std::abs(creep.length);
  const double fading = std::exp(-kappa);
  std::vector<std::vector<double>> weights(marches_.size());
  for (std::size_t kind = 0; kind < marches_.size(); ++kind) {
    const March& march = marches_[kind];
    const GaussRule rule = gauss_rule(march.num_nodes);
    for (std::size_t panel = 0; panel + 1 < march.panel_ends.size(); ++panel) {
      const std::vector<double> of_panel =
          fading_weights(rule, march.panel_ends[panel], march.panel_ends[panel + 1], kappa);
      weights[kind].insert(weights[kind].end(), of_panel.begin(), of_panel.end());
    }
  }
  // Beyond the table: panels as long as L and the exponential are smooth.
  static const GaussRule tail_rule = gauss_rule(12);
  std::vector<double> tail_places;
  std::vector<double> tail_weights;
  const double start = n;
  for (double t = 0.0; kappa * t < 45.0;) {
    const double length = std::min(0.5 * (start + t), 4.0 / kappa);
    for (std::size_t g = 0; g < tail_rule.nodes.size(); ++g) {
      const double place = t + 0.5 * length * (1.0 + tail_rule.nodes[g]);
      tail_places.push_back(start + place);
      tail_weights.push_back(kappa * std::exp(-kappa * place) * 0.5 * length *
                             tail_rule.weights[g]);
    }
    t += length;
  }

  for (int j = 0; j <= n; ++j) {
    double* const row = &table.values[static_cast<std::size_t>(j) * 2 * num_cells_];
    double memory = 0.0;
    for (std::size_t g = 0; g < tail_places.size(); ++g)
      memory += tail_weights[g] * love_square(tail_places[g], j);
    const auto& stretches = stretches_[static_cast<std::size_t>(j)];
    for (auto stretch = stretches.rbegin(); stretch != stretches.rend(); ++stretch) {
      const std::vector<double>& weight = weights[stretch->march];
      const std::size_t count = weight.size();
      for (int i = stretch->last; i >= stretch->first; --i) {
        const double* const sample =
            &samples_[stretch->samples + static_cast<std::size_t>(i - stretch->first) * count];
        double step = 0.0;
        for (std::size_t k = 0; k < count; ++k) step += weight[k] * sample[k];
        memory = fading * memory + step;
        row[i >= 0 ? i : i + 2 * n] += creep.share * memory;
      }
    }
  }
}

InfluenceTable SlidingInfluence::table(std::span<const SlidingCreep> creep,
                                       double cell_side) const {
  if (!(cell_side > 0.0)) {
    throw std::invalid_argument(
        fmt::format("SlidingInfluence: the side {:g} of a cell is not > 0", cell_side));
  }
  double instantaneous = 1.0;
  double direction = 0.0;
  for (const SlidingCreep& one : creep) {
    if (!(one.share > 0.0) || !std::isfinite(one.length))
      throw std::invalid_argument("SlidingInfluence: a share is not > 0 or a length not finite");
    if (one.length * direction < 0.0)
      throw std::invalid_argument("SlidingInfluence: lengths have different signs");
    instantaneous -= one.share;
    if (one.length != 0.0) direction = one.length;
  }
  if (!(instantaneous > 0.0))
    throw std::invalid_argument("SlidingInfluence: the shares do not sum to less than 1");

  InfluenceTable table{num_cells_, std::vector<double>(love_.size())};
  for (const SlidingCreep& one : creep) {
    // Without sliding, or where its square would underflow, the memory is that of a point at rest.
    if (std::abs(one.length) < 1e-12 * cell_side) {
      instantaneous += one.share;
    } else {
      add_memory(one, cell_side, table);
    }
  }
  for (std::size_t i = 0; i < love_.size(); ++i) table.values[i] += instantaneous * love_[i];
  if (direction < 0.0) {
    // Sliding towards −x is the mirror image; the column −N, whose image would be N, is not used
    // by offsets between cells and stays.
    for (std::size_t j = 0; j <= num_cells_; ++j) {
      double* const row = &table.values[j * 2 * num_cells_];
      std::reverse(row + 1, row + 2 * num_cells_);
    }
  }
  return table;
}

}  // namespace stridor
