#include "app/stability/response_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "io/figures/axes.hpp"

namespace stridor {
namespace {

double largest_of(const ResponseCurve& curve) {
  double largest = 0.0;
  for (const std::complex<double>& value : curve.values)
    largest = std::max(largest, std::abs(value));
  return largest;
}

/// Frequencies between neighbours from which any of the responses moves too far to the next.
std::vector<double> frequencies_between(const std::vector<double>& frequencies,
                                        const std::vector<ResponseCurve>& curves, double closest) {
  constexpr double share = 0.03;  // of the largest response: what still looks like a curve
  std::vector<double> steps;
  for (const ResponseCurve& curve : curves) steps.push_back(share * largest_of(curve));
  std::vector<double> between;
  for (std::size_t i = 1; i < frequencies.size(); ++i) {
    const double gap = frequencies[i] - frequencies[i - 1];
    double most = 0.0;
    for (std::size_t c = 0; c < curves.size(); ++c)
      if (steps[c] > 0.0)
        most = std::max(most, std::abs(curves[c].values[i] - curves[c].values[i - 1]) / steps[c]);
    if (most <= 1.0 || gap < closest) continue;
    const int pieces = std::clamp(static_cast<int>(std::ceil(most)), 2, 8);
    for (int k = 1; k < pieces; ++k) between.push_back(frequencies[i - 1] + gap * k / pieces);
  }
  return between;
}

/// Puts responses at frequencies between the others in their places.
void merge(std::vector<double>& frequencies, std::vector<ResponseCurve>& curves,
           const std::vector<double>& more, const std::vector<ResponseCurve>& there) {
  std::vector<double> all;
  std::vector<ResponseCurve> merged = curves;
  for (ResponseCurve& curve : merged) curve.values.clear();
  for (std::size_t i = 0, k = 0; i < frequencies.size() || k < more.size();) {
    const bool is_old = k == more.size() || (i < frequencies.size() && frequencies[i] <= more[k]);
    all.push_back(is_old ? frequencies[i] : more[k]);
    for (std::size_t c = 0; c < curves.size(); ++c)
      merged[c].values.push_back(is_old ? curves[c].values[i] : there[c].values[k]);
    ++(is_old ? i : k);
  }
  frequencies = std::move(all);
  curves = std::move(merged);
}

/// Least magnitude that is worth an axis: troughs but the deepest hundredth, within six decades.
double least_magnitude(const std::vector<DiagramPanel>& panels) {
  std::vector<double> sizes;
  for (const PanelCurve& curve : panels.front().curves)
    for (const double value : curve.y)
      if (value > 0.0) sizes.push_back(value);
  if (sizes.empty()) return 0.0;
  std::sort(sizes.begin(), sizes.end());
  return std::max(sizes[sizes.size() / 100], 1e-6 * sizes.back());
}

}  // namespace

std::pair<std::vector<double>, std::vector<ResponseCurve>> resolved_curves(
    std::vector<double> frequencies, std::vector<ResponseCurve> curves,
    const std::function<std::vector<ResponseCurve>(const std::vector<double>&)>& at) {
  if (frequencies.size() < 2) return {std::move(frequencies), std::move(curves)};
  constexpr int most_passes = 20;
  const std::size_t most_frequencies = frequencies.size() + 20000;
  const double closest = 1e-6 * (frequencies[1] - frequencies[0]);
  for (int pass = 0; pass < most_passes; ++pass) {
    const std::vector<double> more = frequencies_between(frequencies, curves, closest);
    if (more.empty() || frequencies.size() + more.size() > most_frequencies) break;
    merge(frequencies, curves, more, at(more));
  }
  return {std::move(frequencies), std::move(curves)};
}

void ResponsePicture::add(const std::vector<double>& frequencies, const ResponseCurve& curve,
                          const std::string& label, Mark mark, int colour) {
  added_.push_back({frequencies, curve, label, mark, colour});
}

void ResponsePicture::add_error(const std::vector<double>& frequencies, const ResponseCurve& curve,
                                int colour) {
  errors_.push_back({frequencies, curve, "", Mark::dashed_line, colour});
}

std::vector<DiagramPanel> ResponsePicture::panels_of(const std::vector<const Added*>& row) const {
  const AxisKind x_kind = is_log_ ? AxisKind::logarithmic : AxisKind::linear;
  const std::string& units = row.front()->curve.units;
  const std::string in = fmt::format("({})", typeset_units(units));
  std::vector<DiagramPanel> panels{
      {"frequency (Hz)",
       response_quantity(units) + " " + in,
       x_kind,
       AxisKind::logarithmic,
       false,
       {}},
      {"frequency (Hz)", "phase (deg)", x_kind, AxisKind::linear, false, {}},
      {"real part " + in, "imaginary part " + in, AxisKind::linear, AxisKind::linear, true, {}}};
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  constexpr double rounding = 1e-12;  // of the largest response, which has no phase
  double most = 0.0;
  for (const Added* one : row) most = std::max(most, largest_of(one->curve));
  for (const Added* one : row) {
    PanelCurve magnitude{one->label, one->frequencies, {}, one->mark, one->colour};
    PanelCurve phase{"", {}, {}, one->mark, one->colour};
    PanelCurve locus{"", {}, {}, one->mark, one->colour};
    for (std::size_t i = 0; i < one->curve.values.size(); ++i) {
      const std::complex<double> value = one->curve.values[i];
      const double angle = std::arg(value) * 180.0 / std::numbers::pi;
      // Beside none there is no difference.
      if (!phase.y.empty() && std::abs(angle - phase.y.back()) > 180.0) {
        phase.x.push_back(none);
        phase.y.push_back(none);
      }
      if (i > 0 && std::abs(value - one->curve.values[i - 1]) > 0.1 * most) {
        locus.x.push_back(none);
        locus.y.push_back(none);
      }
      magnitude.y.push_back(std::abs(value));
      phase.x.push_back(one->frequencies[i]);
      phase.y.push_back(std::abs(value) > rounding * most ? angle : none);
      locus.x.push_back(value.real());
      locus.y.push_back(value.imag());
    }
    panels[0].curves.push_back(std::move(magnitude));
    panels[1].curves.push_back(std::move(phase));
    panels[2].curves.push_back(std::move(locus));
  }
  panels[0].y_least = least_magnitude(panels);
  for (const Added& error : errors_)
    if (error.curve.units == units)
      panels[0].curves.push_back(
          {"", error.frequencies, error.curve.truncation_error, error.mark, error.colour});
  return panels;
}

DiagramPanel ResponsePicture::panel_of(const ComparedShapes& shapes) const {
  DiagramPanel panel{"frequency (Hz)",
                     "MAC, force at " + shapes.input,
                     is_log_ ? AxisKind::logarithmic : AxisKind::linear,
                     AxisKind::linear,
                     false,
                     {{"", shapes.frequencies, shapes.assurance, Mark::line, 0}}};
  panel.is_share = true;
  PanelCurve peaks{"", {}, {}, Mark::points, 1};
  for (const PeakPair& pair : peak_pairs(shapes)) {
    peaks.x.push_back(shapes.measured_peaks[pair.measured]);
    peaks.y.push_back(pair.assurance);
  }
  if (!peaks.x.empty()) panel.curves.push_back(std::move(peaks));
  return panel;
}

void ResponsePicture::draw(const std::string& caption, const std::filesystem::path& figure) const {
  std::vector<std::vector<const Added*>> rows;
  for (const Added& one : added_) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const auto& known) {
      return known.front()->curve.units == one.curve.units;
    });
    if (row == rows.end())
      rows.push_back({&one});
    else
      row->push_back(&one);
  }
  std::vector<DiagramPanel> panels;
  for (const auto& row : rows)
    for (DiagramPanel& panel : panels_of(row)) panels.push_back(std::move(panel));
  // One legend, above the first diagram.
  for (std::size_t p = 3; p < panels.size(); ++p) {
    for (PanelCurve& curve : panels[p].curves) {
      if (curve.label.empty()) continue;
      panels.front().curves.push_back({curve.label, {}, {}, curve.mark, curve.colour});
      curve.label.clear();
    }
  }
  for (const ComparedShapes& shapes : shapes_) panels.push_back(panel_of(shapes));
  plot_panels(panels, caption, figure);
}

}  // namespace stridor
