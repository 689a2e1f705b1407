#include "coupling/laws/indenter_profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

/// ∫_{r0}^{r1} (c0 + c1 r + c2 r²)/(a² − r²)^½ dr.
double abel_integral(double c0, double c1, double c2, double r0, double r1, double a) {
  const auto antiderivative = [&](double r) {
    const double root = std::sqrt(std::max(0.0, (a - r) * (a + r)));
    const double angle = std::asin(std::min(1.0, r / a));
    return c0 * angle - c1 * root + 0.5 * c2 * (a * a * angle - r * root);
  };
  return antiderivative(r1) - antiderivative(r0);
}

}  // namespace

const Schema& ProfileParameters::schema() {
  static const Schema keys =
      SchemaOf<ProfileParameters>("profile")
          .choice("shape", &ProfileParameters::shape,
                  {{"paraboloid", ProfileShape::paraboloid},
                   {"sphere", ProfileShape::sphere},
                   {"table", ProfileShape::table}},
                  {.doc = "Height above the tip: `paraboloid` r²/(2R), `sphere` R − (R² − r²)^½, "
                          "`table` a monotone cubic through `radii` and `heights`."})
          .real("radius", &ProfileParameters::radius,
                {.doc = "Radius R of curvature at the tip; also the length in which results are "
                        "made dimensionless.",
                 .unit = "m",
                 .range = Range::positive()})
          .real_list("radii", &ProfileParameters::radii,
                     {.doc = "Table: distances from the axis, ascending from 0.",
                      .unit = "m",
                      .range = Range::non_negative(),
                      .optional = true})
          .real_list("heights", &ProfileParameters::heights,
                     {.doc = "Table: heights above the tip at these distances, ascending from 0.",
                      .unit = "m",
                      .range = Range::non_negative(),
                      .optional = true})
          .check([](const ProfileParameters& profile, std::vector<Problem>& problems) {
            const bool has_table = !profile.radii.empty() || !profile.heights.empty();
            if (profile.shape != ProfileShape::table) {
              if (has_table) {
                problems.push_back({Refusal::wrong_value,
                                    profile.radii.empty() ? "heights" : "radii",
                                    "needs `shape: table`"});
              }
              return;
            }
            const auto check_column = [&](const char* key, const std::vector<double>& column) {
              const bool ascends =
                  std::adjacent_find(column.begin(), column.end(),
                                     [](double a, double b) { return !(b > a); }) == column.end();
              if (column.size() < 3 || column.front() != 0.0 || !ascends) {
                problems.push_back(
                    {Refusal::wrong_size, key, "must be three numbers or more, ascending from 0"});
              }
            };
            check_column("radii", profile.radii);
            check_column("heights", profile.heights);
            if (profile.radii.size() != profile.heights.size()) {
              problems.push_back({Refusal::wrong_size, "heights",
                                  fmt::format("has {} entries, `radii` {}", profile.heights.size(),
                                              profile.radii.size())});
            }
          });
  return keys;
}

IndenterProfile::IndenterProfile(const ProfileParameters& parameters) : parameters_(parameters) {
  if (!(parameters.radius > 0.0) || !std::isfinite(parameters.radius)) {
    throw std::invalid_argument(
        fmt::format("IndenterProfile: the radius {:g} m is not > 0", parameters.radius));
  }
  if (parameters.shape != ProfileShape::table) return;
  table_.emplace(parameters.radii, parameters.heights);
  if (parameters.radii.front() != 0.0 || parameters.heights.front() != 0.0)
    throw std::invalid_argument("IndenterProfile: the table does not start at (0, 0)");
  if (!std::is_sorted(parameters.heights.begin(), parameters.heights.end()))
    throw std::invalid_argument("IndenterProfile: the heights descend");
}

double IndenterProfile::reach() const {
  switch (parameters_.shape) {
    case ProfileShape::paraboloid:
      return std::numeric_limits<double>::infinity();
    case ProfileShape::sphere:
      return parameters_.radius;
    case ProfileShape::table:
      return parameters_.radii.back();
  }
  return 0.0;
}

double IndenterProfile::height(double r) const {
  if (r > reach()) return std::numeric_limits<double>::infinity();
  const double radius = parameters_.radius;
  switch (parameters_.shape) {
    case ProfileShape::paraboloid:
      return r * r / (2.0 * radius);
    case ProfileShape::sphere:
      // R − (R² − r²)^½ without the difference of near numbers.
      return r * r / (radius + std::sqrt((radius - r) * (radius + r)));
    case ProfileShape::table:
      return table_->at(r).value;
  }
  return 0.0;
}

double IndenterProfile::slope(double r) const {
  const double radius = parameters_.radius;
  switch (parameters_.shape) {
    case ProfileShape::paraboloid:
      return r / radius;
    case ProfileShape::sphere:
      return r / std::sqrt((radius - r) * (radius + r));
    case ProfileShape::table:
      return table_->at(r).slope;
  }
  return 0.0;
}

double IndenterProfile::elastic_indentation(double contact_radius) const {
  const double a = contact_radius;
  const double radius = parameters_.radius;
  switch (parameters_.shape) {
    case ProfileShape::paraboloid:
      return a * a / radius;
    case ProfileShape::sphere:
      return a * std::atanh(a / radius);
    case ProfileShape::table:
      break;
  }
  // f' is a parabola between the points of the table.
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < parameters_.radii.size() && parameters_.radii[i] < a; ++i) {
    const double r0 = parameters_.radii[i];
    const double r1 = parameters_.radii[i + 1];
    const double curvature = table_->at(r0).curvature;
    const double slope = table_->at(r0).slope;
    const double middle = table_->at(0.5 * (r0 + r1)).slope;
    const double half = 0.5 * (r1 - r0);
    const double second = (middle - slope - curvature * half) / (half * half);
    const double c0 = slope - curvature * r0 + second * r0 * r0;
    const double c1 = curvature - 2.0 * second * r0;
    sum += abel_integral(c0, c1, second, r0, std::min(r1, a), a);
  }
  return a * sum;
}

std::optional<double> IndenterProfile::elastic_contact_radius(double indentation) const {
  if (!(indentation > 0.0) || !std::isfinite(indentation)) {
    throw std::invalid_argument(
        fmt::format("IndenterProfile: the indentation {:g} m is not > 0", indentation));
  }
  if (parameters_.shape == ProfileShape::paraboloid)
    return std::sqrt(parameters_.radius * indentation);
  double low = 0.0;
  double high = reach();
  if (!(elastic_indentation(high) > indentation)) return {};
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (elastic_indentation(middle) < indentation ? low : high) = middle;
  }
  return high;
}

double IndenterProfile::elastic_force(double contact_radius) const {
  constexpr int num_intervals = 400;  // Simpson's rule
  const double h = contact_radius / num_intervals;
  double integral = 0.0;
  for (int i = 1; i <= num_intervals; ++i) {
    const double weight = i == num_intervals ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    integral += weight * elastic_indentation(i * h);
  }
  integral *= h / 3.0;
  return 2.0 * (contact_radius * elastic_indentation(contact_radius) - integral);
}

}  // namespace stridor
