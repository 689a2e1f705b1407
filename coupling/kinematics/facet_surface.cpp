#include "coupling/kinematics/facet_surface.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

namespace stridor {
namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// By how much a place is beyond each edge; negative within.
std::array<double, 4> beyond_edges(int count, double xi, double eta) {
  if (count == 3) return {-eta, xi + eta - 1.0, -xi, -1.0};
  return {-eta, xi - 1.0, eta - 1.0, -xi};
}

/// c of an edge along d between places with normals, so that the quadratic x₀ + (d − c) ξ + c ξ² is
/// at right angles to both at its ends; of these the shortest. 0 where the normals are alike.
Eigen::Vector3d bulge_of(const Eigen::Vector3d& d, const Eigen::Vector3d& first,
                         const Eigen::Vector3d& second) {
  const double cosine = first.dot(second);
  const double square = 1.0 - cosine * cosine;
  constexpr double parallel = 1e-12;
  if (square < parallel) return Eigen::Vector3d::Zero();
  const double p = first.dot(d);
  const double q = -second.dot(d);
  return ((p - cosine * q) * first + (q - cosine * p) * second) / square;
}

Eigen::Vector3d area_vector(const FacetSurface& surface, const Facet& facet) {
  const auto corner = [&](int k) -> const Eigen::Vector3d& {
    return surface.positions[at(facet.nodes[at(k)])];
  };
  return 0.5 * (corner(2) - corner(0)).cross(corner(facet.count - 1) - corner(1));
}

}  // namespace

FacetWeights facet_weights(int count, double xi, double eta) {
  FacetWeights w;
  if (count == 3) {
    w.value = {1.0 - xi - eta, xi, eta, 0.0};
    w.slope = {{{-1.0, 1.0, 0.0, 0.0}, {-1.0, 0.0, 1.0, 0.0}}};
    return w;
  }
  w.value = {(1.0 - xi) * (1.0 - eta), xi * (1.0 - eta), xi * eta, (1.0 - xi) * eta};
  w.slope = {{{eta - 1.0, 1.0 - eta, eta, -eta}, {xi - 1.0, -xi, xi, 1.0 - xi}}};
  w.mixed = {1.0, -1.0, 1.0, -1.0};
  return w;
}

PatchPoint FacetPatch::at(double xi, double eta) const {
  PatchPoint point;
  point.weights = facet_weights(count, xi, eta);
  point.place.setZero();
  for (Eigen::Vector3d& slope : point.slopes) slope.setZero();
  for (Eigen::Vector3d& curvature : point.curvatures) curvature.setZero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    point.place += point.weights.value[k] * nodes[k];
    point.slopes[0] += point.weights.slope[0][k] * nodes[k];
    point.slopes[1] += point.weights.slope[1][k] * nodes[k];
    point.curvatures[1] += point.weights.mixed[k] * nodes[k];
  }
  if (!is_bulged) return point;
  // Factor of each c, its first derivatives by ξ and η and the second ones.
  const auto take = [&](std::size_t edge, double value, double by_xi, double by_eta, double xi_xi,
                        double xi_eta, double eta_eta) {
    const Eigen::Vector3d& c = bulges[edge];
    point.place -= value * c;
    point.slopes[0] -= by_xi * c;
    point.slopes[1] -= by_eta * c;
    point.curvatures[0] -= xi_xi * c;
    point.curvatures[1] -= xi_eta * c;
    point.curvatures[2] -= eta_eta * c;
  };
  if (count == 3) {
    const double rest = 1.0 - xi - eta;
    take(0, rest * xi, rest - xi, -xi, -2.0, -1.0, 0.0);
    take(1, xi * eta, eta, xi, 0.0, 1.0, 0.0);
    take(2, eta * rest, -eta, rest - eta, 0.0, -1.0, -2.0);
  } else {
    const double a = xi * (1.0 - xi), b = eta * (1.0 - eta);
    const double da = 1.0 - 2.0 * xi, db = 1.0 - 2.0 * eta;
    take(0, a * (1.0 - eta), da * (1.0 - eta), -a, -2.0 * (1.0 - eta), -da, 0.0);
    take(1, b * xi, b, db * xi, 0.0, db, -2.0 * xi);
    take(2, a * eta, da * eta, a, -2.0 * eta, da, 0.0);
    take(3, b * (1.0 - xi), -b, db * (1.0 - xi), 0.0, -db, -2.0 * (1.0 - xi));
  }
  return point;
}

Eigen::Vector2d closest_on(const FacetPatch& patch, const Eigen::Vector3d& point,
                           const Eigen::Vector2d& guess) {
  constexpr int max_iterations = 50;
  // The next step of Newton's method is then below rounding.
  constexpr double last_step = 1e-9;
  Eigen::Vector2d place = guess.cwiseMax(0.0).cwiseMin(1.0);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const PatchPoint on = patch.at(place.x(), place.y());
    const Eigen::Vector3d arm = point - on.place;
    const auto& [a, b] = on.slopes;
    const Eigen::Vector2d ahead(a.dot(arm), b.dot(arm));
    Eigen::Matrix2d metric;
    metric << a.dot(a), a.dot(b), a.dot(b), b.dot(b);
    Eigen::Matrix2d curved = metric;
    curved(0, 0) -= on.curvatures[0].dot(arm);
    curved(0, 1) -= on.curvatures[1].dot(arm);
    curved(1, 0) = curved(0, 1);
    curved(1, 1) -= on.curvatures[2].dot(arm);
    // Further away than the centre of curvature the distance has no minimum.
    const bool has_minimum = curved(0, 0) > 0.0 && curved.determinant() > 0.0;
    const Eigen::Vector2d step = (has_minimum ? curved : metric).inverse() * ahead;
    const Eigen::Vector2d next =
        (place + step).cwiseMax(-1.0).cwiseMin(2.0);
    const double moved = (next - place).cwiseAbs().maxCoeff();
    place = next;
    if (moved <= last_step) break;
  }
  return place;
}

int FacetSurface::max_nodes() const {
  return std::any_of(facets.begin(), facets.end(),
                     [](const Facet& facet) { return facet.count == 4; })
             ? 4
             : 3;
}

FacetPatch FacetSurface::patch(int facet) const {
  const Facet& of = facets[at(facet)];
  FacetPatch patch;
  patch.count = of.count;
  for (int k = 0; k < of.count; ++k)
    patch.nodes[at(k)] = positions[at(of.nodes[at(k)])] - origin(facet);
  patch.is_bulged = !bulges.empty();
  if (patch.is_bulged) patch.bulges = bulges[at(facet)];
  return patch;
}

double FacetSurface::extent() const {
  Eigen::Vector3d low = positions.front();
  Eigen::Vector3d high = low;
  for (const Eigen::Vector3d& position : positions) {
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  return (high - low).norm();
}

void connect_facets(FacetSurface& surface, SurfaceKind kind) {
  std::map<std::pair<int, int>, std::pair<int, int>> open;  // edge: facet and number in it
  constexpr std::array<int, 4> none{-1, -1, -1, -1};
  surface.neighbours.assign(surface.facets.size(), none);
  surface.bulges.clear();
  std::vector<Eigen::Vector3d> normals(surface.positions.size(), Eigen::Vector3d::Zero());
  const double extent = surface.extent();
  for (int f = 0; f < static_cast<int>(surface.facets.size()); ++f) {
    const Facet& facet = surface.facets[at(f)];
    const Eigen::Vector3d area = area_vector(surface, facet);
    if (!(area.norm() > 1e-14 * extent * extent))
      throw std::invalid_argument("has a facet without area");
    for (int k = 0; k < facet.count; ++k) {
      const int from = facet.nodes[at(k)];
      const int to = facet.nodes[at((k + 1) % facet.count)];
      normals[at(from)] += area;
      // Two facets that face the same way pass a common edge in opposite directions.
      const auto other = open.find({to, from});
      if (other != open.end()) {
        surface.neighbours[at(f)][at(k)] = other->second.first;
        surface.neighbours[at(other->second.first)][at(other->second.second)] = f;
        open.erase(other);
      } else if (!open.emplace(std::pair(from, to), std::pair(f, k)).second) {
        throw std::invalid_argument("has an edge at which facets face different ways or more than "
                                    "two of them meet");
      }
    }
  }
  if (kind == SurfaceKind::polyline) return;
  for (Eigen::Vector3d& normal : normals) normal.normalize();
  for (const Facet& facet : surface.facets) {
    auto& bulges = surface.bulges.emplace_back();
    for (int k = 0; k < facet.count; ++k) {
      const auto from = at(facet.nodes[at(k)]);
      const auto to = at(facet.nodes[at((k + 1) % facet.count)]);
      bulges[at(k)] = bulge_of(surface.positions[to] - surface.positions[from], normals[from],
                               normals[to]);
    }
  }
}

bool FacetSearch::has_visited(int facet) const {
  const auto last = visited_.begin() + std::min<int>(num_visited_, static_cast<int>(visited_.size()));
  return std::find(visited_.begin(), last, facet) != last;
}

FacetSearch::Step FacetSearch::look(const FacetSurface& surface, FacetPlace& place) {
  constexpr double rounding = 1e-9;
  constexpr int most_moves = 10000;
  const Facet& facet = surface.facets[at(place.facet)];
  std::array<double, 4> beyond = beyond_edges(facet.count, place.xi, place.eta);
  bool is_off = false;
  bool may_stay = false;
  for (int attempt = 0; attempt < facet.count; ++attempt) {
    const auto edge = static_cast<std::size_t>(
        std::max_element(beyond.begin(), beyond.begin() + facet.count) - beyond.begin());
    if (beyond[edge] <= 0.0) break;
    const int next = surface.neighbours[at(place.facet)][edge];
    if (next < 0) {
      is_off = is_off || beyond[edge] > rounding;
    } else if (has_visited(next) || num_visited_ >= most_moves) {
      may_stay = true;
    } else {
      visited_[at(num_visited_ % static_cast<int>(visited_.size()))] = place.facet;
      ++num_visited_;
      place.facet = next;
      return Step::moved;
    }
    beyond[edge] = 0.0;
  }
  return is_off && !may_stay ? Step::lost : Step::stay;
}

FacetPlace locate_on(const FacetSurface& surface, const Eigen::Vector3d& point) {
  constexpr double rounding = 1e-9;
  FacetPlace found{-1, 0.0, 0.0};
  double nearest = std::numeric_limits<double>::infinity();
  for (int f = 0; f < static_cast<int>(surface.facets.size()); ++f) {
    const FacetPatch patch = surface.patch(f);
    const Eigen::Vector3d seen = point - surface.origin(f);
    const Eigen::Vector2d place = closest_on(patch, seen, {0.4, 0.4});
    const std::array<double, 4> beyond = beyond_edges(patch.count, place.x(), place.y());
    if (*std::max_element(beyond.begin(), beyond.begin() + patch.count) > rounding) continue;
    const double distance = (seen - patch.at(place.x(), place.y()).place).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    found = {f, place.x(), place.y()};
  }
  return found;
}

}  // namespace stridor
