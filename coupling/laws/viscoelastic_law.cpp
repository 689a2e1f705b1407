#include "coupling/laws/viscoelastic_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "coupling/kinematics/monotone_cubic.hpp"

namespace stridor {
namespace {

/// Above this the small slopes behind half-space theory, and the fits, end (PPH, Fig. 3).
constexpr double deepest = 0.3;
/// Cells that the edge layer needs before the noise of the grid no longer shows in the derivatives.
constexpr double resolved_cells = 8.0;

ViscoelasticContact no_contact() {
  ViscoelasticContact contact;
  contact.range = LawRange::no_contact;
  return contact;
}

/// Cubic weights of values and slopes at both ends of an interval, and their derivatives; outside
/// the table those of the line through the end.
struct IntervalWeights {
  std::size_t i = 0;  ///< knot at which the interval begins
  double value[2]{};
  double slope[2]{};
  double value_by[2]{};
  double slope_by[2]{};
};

IntervalWeights weights_at(const std::vector<double>& knots, double at) {
  IntervalWeights w;
  const auto after = std::upper_bound(knots.begin() + 1, knots.end() - 1, at);
  w.i = static_cast<std::size_t>(after - knots.begin()) - 1;
  const double h = knots[w.i + 1] - knots[w.i];
  if (at < knots.front() || at > knots.back()) {
    const std::size_t end = at < knots.front() ? 0 : 1;
    w.value[end] = 1.0;
    w.slope[end] = at - knots[w.i + end];
    w.slope_by[end] = 1.0;
    return w;
  }
  const double t = (at - knots[w.i]) / h;
  w.value[1] = t * t * (3.0 - 2.0 * t);
  w.value[0] = 1.0 - w.value[1];
  w.slope[0] = h * t * (1.0 - t) * (1.0 - t);
  w.slope[1] = -h * t * t * (1.0 - t);
  w.value_by[1] = 6.0 * t * (1.0 - t) / h;
  w.value_by[0] = -w.value_by[1];
  w.slope_by[0] = (1.0 - t) * (1.0 - 3.0 * t);
  w.slope_by[1] = t * (3.0 * t - 2.0);
  return w;
}

}  // namespace

FitCoefficients published_coefficients() {
  return {{11.890, 1.199, 0.873, -0.449, 0.412},
          {1.440, 2.118, 0.493, -1.328, 0.826},
          {0.450, 0.489, -1.682, 0.766}};
}

ViscoelasticContact FittedLaw::at(double indentation, double speed) const {
  const double y = indentation;
  if (!(y > 0.0)) return no_contact();
  const double v = std::abs(speed);
  ViscoelasticContact contact;
  contact.range = y > deepest ? LawRange::too_deep : LawRange::inside;

  const auto& [a1, a2, a3, a4, a5] = c_.force;
  const auto& [b1, b2, b3, b4, b5] = c_.area;
  const auto& [c1, c2, c3, c4] = c_.friction;
  const double root = std::sqrt(y);
  if (v == 0.0) {
    // erf → −1 and the bells vanish, faster than any power of v.
    const double force = 0.5 * a1 * y * root * (a2 - 1.0);
    contact.force = {force, 1.5 * force / y, 0.0};
    contact.area = {b1 * y * b2, b1 * b2, 0.0};
    return contact;
  }
  const double lg_y = std::log10(y);
  const double lg_v = std::log10(v);
  const double lg_by_y = 1.0 / (y * std::numbers::ln10);
  const double lg_by_v = 1.0 / (v * std::numbers::ln10);

  const double z = a3 * lg_v + a4 * lg_y + a5;
  const double scale = 0.5 * a1 * y * root;
  const double bell = scale * 2.0 * std::numbers::inv_sqrtpi * std::exp(-z * z);
  const double force = scale * (a2 + std::erf(z));
  contact.force = {force, 1.5 * force / y + bell * a4 * lg_by_y, bell * a3 * lg_by_v};

  const double s = (lg_v - b3 * lg_y - b4) / b5;
  const double dip = b1 * std::exp(-0.5 * s * s);
  contact.area = {y * (b1 * b2 - dip), b1 * b2 - dip - y * dip * s * b3 / b5 * lg_by_y,
                  y * dip * s / b5 * lg_by_v};

  const double t = (lg_v - c2 * lg_y - c3) / c4;
  const double friction = c1 * root * std::exp(-0.5 * t * t);
  contact.friction = {friction, friction * (0.5 / y + t * c2 / c4 * lg_by_y),
                      -friction * t / c4 * lg_by_v};
  return contact;
}

const MasterCurve& shipped_master_curve() {
  static const MasterCurve curve{0.1,
                                 {
#include "coupling/kinematics/paraboloid_master_curve.inc"
                                 }};
  return curve;
}

LimitedSpline::LimitedSpline(const std::vector<double>& beta, std::vector<double> q,
                             double lower_limit, int power, double upper_limit)
    : q_(std::move(q)), lower_limit_(lower_limit), power_(power), upper_limit_(upper_limit) {
  const std::size_t n = beta.size();
  if (n < 3 || q_.size() != n || !(beta.front() > 0.0))
    throw std::invalid_argument("LimitedSpline: needs three positive beta or more, as many values");
  if (power != 1 && power != 2)
    throw std::invalid_argument(fmt::format("LimitedSpline: power {} is not 1 or 2", power));
  for (const double value : beta) {
    if (!x_.empty() && !(std::log(value) > x_.back()))
      throw std::invalid_argument("LimitedSpline: beta does not ascend");
    x_.push_back(std::log(value));
  }
  // Continuous second derivatives with given slopes at both ends: a tridiagonal system.
  slopes_.resize(n);
  slopes_.front() = power * (q_.front() - lower_limit);
  slopes_.back() = -(q_.back() - upper_limit);
  std::vector<double> upper(n);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = 1.0 / (x_[i] - x_[i - 1]);
    const double after = 1.0 / (x_[i + 1] - x_[i]);
    const double right =
        3.0 * ((q_[i] - q_[i - 1]) * before * before + (q_[i + 1] - q_[i]) * after * after);
    const double known = i == 1 ? slopes_.front() : slopes_[i - 1];
    const double coupling = i == 1 ? 0.0 : upper[i - 1];
    const double diagonal = 2.0 * (before + after) - before * coupling;
    upper[i] = after / diagonal;
    slopes_[i] = (right - before * known) / diagonal;
  }
  for (std::size_t i = n - 2; i >= 1; --i) slopes_[i] -= upper[i] * slopes_[i + 1];
}

LimitedSpline::Value LimitedSpline::at(double beta) const {
  const double first = std::exp(x_.front());
  if (beta <= first) {
    const double part = beta / first;
    const double rise = q_.front() - lower_limit_;
    return power_ == 1 ? Value{lower_limit_ + rise * part, rise / first}
                       : Value{lower_limit_ + rise * part * part, 2.0 * rise * part / first};
  }
  const double x = std::log(beta);
  if (x >= x_.back()) {
    const double rise = (q_.back() - upper_limit_) * std::exp(x_.back() - x);
    return {upper_limit_ + rise, -rise / beta};
  }
  const auto after = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
  const auto i = static_cast<std::size_t>(after - x_.begin()) - 1;
  const double h = x_[i + 1] - x_[i];
  const double t = (x - x_[i]) / h;
  const double a = h * slopes_[i];
  const double rise = q_[i + 1] - q_[i];
  const double c2 = 3.0 * rise - 2.0 * a - h * slopes_[i + 1];
  const double c3 = a + h * slopes_[i + 1] - 2.0 * rise;
  return {q_[i] + t * (a + t * (c2 + t * c3)), (a + t * (2.0 * c2 + 3.0 * t * c3)) / (h * beta)};
}

BoundaryElementLaw::BoundaryElementLaw(const MasterCurve& curve) {
  const double e0 = curve.modulus_ratio;
  if (!(e0 > 0.0) || !(e0 < 1.0)) {
    throw std::invalid_argument(
        fmt::format("BoundaryElementLaw: the modulus ratio {:g} is not in (0, 1)", e0));
  }
  slow_slope_ = 1.0 - e0;
  fast_slope_ = 0.8 * (1.0 / e0 - 1.0);
  std::vector<double> beta;
  std::vector<double> force;
  std::vector<double> area;
  std::vector<double> ratio;
  for (const MasterPoint& point : curve.points) {
    if (point.memory_in_cells < resolved_cells) continue;
    beta.push_back(point.beta);
    force.push_back(point.force);
    area.push_back(point.area);
    ratio.push_back(point.friction / friction_scale(point.beta).value);
  }
  if (beta.size() < 3)
    throw std::invalid_argument("BoundaryElementLaw: fewer than three points are resolved");
  first_beta_ = beta.front();
  last_beta_ = beta.back();
  force_ = std::make_unique<LimitedSpline>(beta, force, 4.0 / 3.0, 2, 4.0 / (3.0 * e0));
  area_ = std::make_unique<LimitedSpline>(beta, area, std::numbers::pi, 1, std::numbers::pi);
  friction_ratio_ = std::make_unique<LimitedSpline>(beta, ratio, 1.0, 1, 1.0);
}

LimitedSpline::Value BoundaryElementLaw::friction_scale(double beta) const {
  const double square = slow_slope_ / fast_slope_ * beta * beta;
  const double sum = 1.0 + square;
  return {slow_slope_ * beta / sum, slow_slope_ * (1.0 - square) / (sum * sum)};
}

ViscoelasticContact BoundaryElementLaw::at(double indentation, double speed) const {
  const double y = indentation;
  if (!(y > 0.0)) return no_contact();
  const double root = std::sqrt(y);
  const double beta = std::abs(speed) / root;
  ViscoelasticContact contact;
  if (y > deepest) {
    contact.range = LawRange::too_deep;
  } else if (beta < first_beta_ || beta > last_beta_) {
    contact.range = LawRange::beyond_data;
  }
  // ∂β/∂ŷ = −β/(2ŷ), ∂β/∂v̂ = 1/ŷ^½.
  const LimitedSpline::Value f = force_->at(beta);
  contact.force = {y * root * f.value, root * (1.5 * f.value - 0.5 * beta * f.slope), y * f.slope};
  const LimitedSpline::Value g = area_->at(beta);
  contact.area = {y * g.value, g.value - 0.5 * beta * g.slope, root * g.slope};
  const LimitedSpline::Value scale = friction_scale(beta);
  const LimitedSpline::Value ratio = friction_ratio_->at(beta);
  const double m = scale.value * ratio.value;
  const double m_slope = scale.slope * ratio.value + scale.value * ratio.slope;
  contact.friction = {root * m, 0.5 * (m - beta * m_slope) / root, m_slope};
  return contact;
}

TabulatedLaw::TabulatedLaw(const ContactTable& table) {
  const auto logarithms = [](const std::vector<double>& values, const char* name) {
    std::vector<double> logs;
    for (const double value : values) {
      if (!(value > 0.0) || !std::isfinite(value) ||
          (!logs.empty() && !(std::log(value) > logs.back()))) {
        throw std::invalid_argument(
            fmt::format("TabulatedLaw: {} are not positive and ascending", name));
      }
      logs.push_back(std::log(value));
    }
    if (logs.size() < 2)
      throw std::invalid_argument(fmt::format("TabulatedLaw: fewer than two {}", name));
    return logs;
  };
  x_ = logarithms(table.speeds, "speeds");
  y_ = logarithms(table.indentations, "indentations");
  force_ = make_surface(table.force, "forces");
  area_ = make_surface(table.area, "areas");
  friction_ = make_surface(table.friction, "frictions");
}

TabulatedLaw::Surface TabulatedLaw::make_surface(const std::vector<double>& values,
                                                 const char* name) const {
  const std::size_t nx = x_.size();
  const std::size_t ny = y_.size();
  if (values.size() != nx * ny) {
    throw std::invalid_argument(
        fmt::format("TabulatedLaw: {} {} for {} x {} points", values.size(), name, ny, nx));
  }
  Surface surface;
  for (const double value : values) {
    if (!(value > 0.0) || !std::isfinite(value))
      throw std::invalid_argument(fmt::format("TabulatedLaw: {} are not all positive", name));
    surface.value.push_back(std::log(value));
  }
  surface.by_x.resize(values.size());
  surface.by_y.resize(values.size());
  for (std::size_t j = 0; j < ny; ++j) {
    const auto row = surface.value.begin() + static_cast<std::ptrdiff_t>(j * nx);
    const std::vector<double> slopes =
        monotone_slopes(x_, {row, row + static_cast<std::ptrdiff_t>(nx)});
    std::copy(slopes.begin(), slopes.end(),
              surface.by_x.begin() + static_cast<std::ptrdiff_t>(j * nx));
  }
  for (std::size_t i = 0; i < nx; ++i) {
    std::vector<double> column(ny);
    for (std::size_t j = 0; j < ny; ++j) column[j] = surface.value[j * nx + i];
    const std::vector<double> slopes = monotone_slopes(y_, column);
    for (std::size_t j = 0; j < ny; ++j) surface.by_y[j * nx + i] = slopes[j];
  }
  return surface;
}

LawValue TabulatedLaw::at(const Surface& surface, double x, double y) const {
  IntervalWeights wx = weights_at(x_, x);
  if (x < x_.front()) {
    // Linear in the speed itself, which has a limit at rest.
    wx.slope_by[0] = std::exp(x - x_.front());
    wx.slope[0] = std::expm1(x - x_.front());
  }
  const IntervalWeights wy = weights_at(y_, y);
  double value = 0.0;
  double by_x = 0.0;
  double by_y = 0.0;
  for (std::size_t b = 0; b < 2; ++b) {
    for (std::size_t a = 0; a < 2; ++a) {
      const std::size_t k = (wy.i + b) * x_.size() + wx.i + a;
      // Without mixed derivatives at the points.
      value += surface.value[k] * wx.value[a] * wy.value[b] +
               surface.by_x[k] * wx.slope[a] * wy.value[b] +
               surface.by_y[k] * wx.value[a] * wy.slope[b];
      by_x += surface.value[k] * wx.value_by[a] * wy.value[b] +
              surface.by_x[k] * wx.slope_by[a] * wy.value[b] +
              surface.by_y[k] * wx.value_by[a] * wy.slope[b];
      by_y += surface.value[k] * wx.value[a] * wy.value_by[b] +
              surface.by_x[k] * wx.slope[a] * wy.value_by[b] +
              surface.by_y[k] * wx.value[a] * wy.slope_by[b];
    }
  }
  const double result = std::exp(value);
  return {result, result * by_y, result * by_x};
}

ViscoelasticContact TabulatedLaw::at(double indentation, double speed) const {
  if (!(indentation > 0.0)) return no_contact();
  // At rest as close to it: only quotients by the speed matter there.
  const double slowest = std::exp(x_.front());
  const double v = std::max(std::abs(speed), 1e-100 * slowest);
  const double y = std::log(indentation);
  const double x = std::log(v);
  ViscoelasticContact contact;
  if (x < x_.front() || x > x_.back() || y < y_.front() || y > y_.back())
    contact.range = LawRange::beyond_data;
  contact.force = at(force_, x, y);
  contact.area = at(area_, x, y);
  contact.friction = at(friction_, x, y);
  for (LawValue* quantity : {&contact.force, &contact.area, &contact.friction}) {
    quantity->by_indentation /= indentation;
    quantity->by_speed /= v;
  }
  if (x < x_.front()) {
    // Friction begins in proportion to the speed: by r exp(1 − r), which has slope 0 at r = 1.
    const double r = v / slowest;
    LawValue& friction = contact.friction;
    const double factor = r * std::exp(1.0 - r);
    friction.by_indentation *= factor;
    friction.by_speed = friction.by_speed * factor + friction.value * factor * (1.0 - r) / v;
    friction.value = speed != 0.0 ? friction.value * factor : 0.0;
  }
  return contact;
}

}  // namespace stridor
