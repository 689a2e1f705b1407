#include "solvers/half_space/sliding_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace stridor {
namespace {

/// Coarse grids only predict; accuracy beyond this tolerance is left to the fine grid.
constexpr double coarse_tolerance = 1e-5;
constexpr std::int64_t coarsest_grid = 32;

const SlidingContactParameters& checked(const SlidingContactParameters& parameters) {
  if (parameters.grid < 16 || parameters.grid > 4096 || parameters.grid % 2 != 0) {
    throw std::invalid_argument(
        fmt::format("SlidingContact: grid {} is not even, 16 to 4096", parameters.grid));
  }
  if (!(parameters.window > 1.0) || !(parameters.window <= 10.0)) {
    throw std::invalid_argument(
        fmt::format("SlidingContact: window {:g} is not in (1, 10]", parameters.window));
  }
  if (!(parameters.tolerance > 0.0) || !(parameters.tolerance < 0.1)) {
    throw std::invalid_argument(
        fmt::format("SlidingContact: tolerance {:g} is not in (0, 0.1)", parameters.tolerance));
  }
  if (parameters.max_rounds < 1)
    throw std::invalid_argument("SlidingContact: max_rounds is not positive");
  return parameters;
}

}  // namespace

CreepLengths creep_lengths(const ViscoelasticMaterial& material, double radius, double speed) {
  CreepLengths lengths;
  for (std::size_t k = 0; k < material.creep_times.size(); ++k) {
    const double ratio = material.creep_times[k] / material.creep_times.front();
    lengths.push_back({material.creep_weight(k), speed * radius * ratio});
  }
  return lengths;
}

std::vector<std::string> SlidingContactResult::remarks() const {
  std::vector<std::string> list;
  if (!converged) {
    list.push_back(fmt::format("not converged: residual {:.1e} after {} sets of contact cells",
                               residual, rounds));
  }
  if (touches_window) list.emplace_back("the contact reaches the border of the window: enlarge it");
  if (!has_resolved_memory()) {
    list.push_back(
        fmt::format("the layer of length v tau at the edge is {:.2g} cells wide and not "
                    "resolved: the friction is too low",
                    memory_in_cells));
  }
  if (!has_resolved_edge)
    list.emplace_back("the edge is not one smooth curve on this grid: the area is counted in cells");
  return list;
}

SlidingContact::SlidingContact(const SlidingContactParameters& parameters,
                               const IndenterProfile& profile)
    : parameters_(checked(parameters)),
      profile_(profile),
      half_space_(static_cast<std::size_t>(parameters.grid)),
      complementarity_(half_space_),
      target_(half_space_.num_values()),
      pressure_(half_space_.num_values()) {
  if (parameters.grid % 4 == 0 && parameters.grid / 2 >= coarsest_grid) {
    SlidingContactParameters coarse = parameters;
    coarse.grid /= 2;
    coarse.tolerance = std::max(parameters.tolerance, coarse_tolerance);
    coarse_ = std::make_unique<SlidingContact>(coarse, profile);
  }
}

void SlidingContact::restart() {
  has_solution_ = false;
  if (coarse_) coarse_->restart();
}

void SlidingContact::predict(double scale, std::span<const double> coarse_before) {
  const std::size_t n = half_space_.num_cells();
  const bool has_coarse = coarse_ && coarse_->has_solution_;
  for (std::size_t j = 0; j < n / 2; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      double& p = pressure_[j * n + i];
      const std::size_t k = (j / 2) * (n / 2) + i / 2;
      if (has_solution_ && !coarse_before.empty()) {
        const double coarse = coarse_->pressure_[k];
        p = std::max(0.0, scale * (p - coarse_before[k]) + coarse);
        if (coarse == 0.0 && coarse_before[k] > 0.0) p = 0.0;
      } else if (has_solution_) {
        p *= scale;
      } else if (has_coarse) {
        p = coarse_->pressure_[k];
      } else {
        // A pressure of about the right size wherever the indenter is below the undeformed surface.
        p = std::max(0.0, target_[j * n + i]) / (2.0 * static_cast<double>(n));
      }
    }
  }
}

ComplementarityOutcome SlidingContact::solve_pressure(double indentation, double half_width,
                                                      const CreepLengths& creep) {
  const std::size_t n = half_space_.num_cells();
  const double side = 2.0 * half_width / static_cast<double>(n);
  half_space_.set_creep(creep, side);
  std::vector<double> coarse_before;
  if (coarse_) {
    if (coarse_->has_solution_) coarse_before = coarse_->pressure_;
    // Its failure only makes the prediction worse.
    if (!coarse_->solve_pressure(indentation, half_width, creep).converged) coarse_before.clear();
  }
  for (std::size_t j = 0; j < n / 2; ++j) {
    const double y = (static_cast<double>(j) + 0.5) * side;
    for (std::size_t i = 0; i < n; ++i) {
      const double x = (static_cast<double>(i) + 0.5) * side - half_width;
      target_[j * n + i] =
          std::numbers::pi / side * (indentation - profile_.height(std::hypot(x, y)));
    }
  }
  const double scale = has_solution_ ? (indentation / side) / (indentation_ / cell_side_) : 1.0;
  predict(scale, coarse_before);
  cell_side_ = side;
  indentation_ = indentation;

  ComplementarityLimits limits;
  limits.tolerance = parameters_.tolerance;
  limits.max_rounds = static_cast<std::size_t>(parameters_.max_rounds);
  const ComplementarityOutcome outcome = complementarity_.solve(target_, limits, pressure_);
  has_solution_ = outcome.converged;
  return outcome;
}

SlidingContactResult SlidingContact::indent(double indentation, const CreepLengths& creep) {
  const std::optional<double> radius = profile_.elastic_contact_radius(indentation);
  if (!radius) {
    throw std::invalid_argument(fmt::format(
        "SlidingContact: at an indentation of {:g} m the indenter is in contact up to its end",
        indentation));
  }
  SlidingContactResult result;
  result.indentation = indentation;
  const double half_width = parameters_.window * *radius;
  const bool has_start = has_solution_;
  ComplementarityOutcome outcome = solve_pressure(indentation, half_width, creep);
  if (!outcome.converged && has_start) {
    restart();
    outcome = solve_pressure(indentation, half_width, creep);
  }
  result.converged = outcome.converged;
  result.rounds = outcome.rounds;
  result.products = outcome.products;
  result.residual = outcome.residual;

  result.memory_in_cells = std::numeric_limits<double>::infinity();
  for (const SlidingCreep& one : creep) {
    if (one.length != 0.0)
      result.memory_in_cells = std::min(result.memory_in_cells, std::abs(one.length) / cell_side_);
  }
  if (!(outcome.residual < 1.0)) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    result.force = result.area = result.friction = none;
    result.has_resolved_edge = false;
    edge_ = {};
    return result;
  }

  const std::size_t n = half_space_.num_cells();
  const double cell_area = cell_side_ * cell_side_;
  const double middle = 0.5 * static_cast<double>(n);
  double force = 0.0;
  double sideways = 0.0;
  for (std::size_t j = 0; j < n / 2; ++j) {
    const double y = (static_cast<double>(j) + 0.5) * cell_side_;
    for (std::size_t i = 0; i < n; ++i) {
      const double p = pressure_[j * n + i];
      if (p == 0.0) continue;
      const double x = (static_cast<double>(i) + 0.5 - middle) * cell_side_;
      const double r = std::hypot(x, y);
      force += 2.0 * p * cell_area;
      sideways += 2.0 * p * cell_area * profile_.slope(r) * x / r;
      result.touches_window |= i == 0 || i + 1 == n || j + 1 == n / 2;
    }
  }
  result.force = force;
  result.friction = force > 0.0 ? sideways / force : 0.0;
  edge_ = find_contact_edge(pressure_, gap(), n);
  result.area = edge_.area * cell_area;
  result.has_resolved_edge = edge_.is_resolved;
  return result;
}

SlidingContactResult SlidingContact::load(double force, const CreepLengths& creep,
                                          double tolerance) {
  if (!(force > 0.0) || !std::isfinite(force))
    throw std::invalid_argument(fmt::format("SlidingContact: the force {:g} m2 is not > 0", force));
  if (!(tolerance > 0.0))
    throw std::invalid_argument("SlidingContact: the tolerance of the force is not > 0");
  double softness = 1.0;  // e_0
  for (const SlidingCreep& one : creep) softness -= one.length != 0.0 ? one.share : 0.0;

  // Between the elastic contacts with E_0 and with E_∞, in the middle of their logarithms.
  double low = 0.0;
  double high = std::min(profile_.reach(), 1e6 * profile_.radius());
  const double elastic = force * std::sqrt(softness);
  if (profile_.elastic_force(high) <= elastic) {
    throw std::invalid_argument(fmt::format(
        "SlidingContact: under {:g} m2 the indenter is in contact up to its end", force));
  }
  for (int i = 0; i < 100; ++i) {
    const double radius = 0.5 * (low + high);
    (profile_.elastic_force(radius) < elastic ? low : high) = radius;
  }
  double at = std::log(profile_.elastic_indentation(0.5 * (low + high)));
  double slope = 1.5;  // d log F/d log δ of Hertz
  double before = at;
  double error_before = 0.0;
  SlidingContactResult result;
  for (int i = 0; i < 30; ++i) {
    result = indent(std::exp(at), creep);
    if (!result.converged) return result;
    const double error = std::log(result.force / force);
    if (std::abs(error) <= tolerance) return result;
    if (i > 0 && at != before) {
      // Contacts stiffen with depth; a slope far from Hertz's would only be noise.
      slope = std::clamp((error - error_before) / (at - before), 0.5, 4.0);
    }
    before = at;
    error_before = error;
    at -= std::clamp(error / slope, -2.0, 2.0);
  }
  result.converged = false;
  return result;
}

std::vector<double> SlidingContact::gap() const {
  const std::span<const double> displacement = complementarity_.displacement();
  std::vector<double> gap(target_.size());
  for (std::size_t i = 0; i < gap.size(); ++i)
    gap[i] = cell_side_ / std::numbers::pi * (displacement[i] - target_[i]);
  return gap;
}

}  // namespace stridor
