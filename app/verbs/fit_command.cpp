// stridor fit: the published forms against the boundary elements.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <memory>
#include <optional>

#include "analysis/law_fit.hpp"
#include "app/results/output_folder.hpp"
#include "app/terminal/command.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/figures/panel_plot.hpp"
#include "substructures/elements/viscoelastic_material.hpp"

namespace stridor {
namespace {

struct FitOptions {
  CommonOptions common;
  std::vector<double> speeds{1e-3, 1e3, 49};        ///< first, last, number
  std::vector<double> indentations{1e-4, 0.3, 15};  ///< likewise
  std::optional<std::string> figures;
};

/// Quantities compared.
struct Comparison {
  std::vector<LawSample> samples;
  PerQuantity shift;  ///< decades, of the published coefficients
  LawFit refit;
  FitCoefficients moved;  ///< the published ones, by two decades
};

Comparison compare(const std::vector<double>& speeds, const std::vector<double>& indentations) {
  Comparison comparison;
  const BoundaryElementLaw law(shipped_master_curve());
  comparison.samples = law_samples(law, speeds, indentations);
  const FitCoefficients published = published_coefficients();
  comparison.shift = best_shift(published, comparison.samples, 4.0);
  comparison.moved = shifted(published, {2.0, 2.0, 2.0});
  comparison.refit = fit_law(comparison.moved, comparison.samples);
  return comparison;
}

using LawMember = LawValue ViscoelasticContact::*;
struct QuantityText {
  LawMember member;
  const char* label;
  double exponent;  ///< of ŷ in Hertz's contact
};
const std::array<QuantityText, 3> quantities{{
    {&ViscoelasticContact::friction, "friction coefficient", 0.5},
    {&ViscoelasticContact::area, "area A/R²", 1.0},
    {&ViscoelasticContact::force, "force F/(E₀* R²)", 1.5},
}};

/// PPH Fig. 13: complex modulus and loss tangent over frequency.
void draw_modulus(const std::filesystem::path& figure) {
  ViscoelasticMaterial material;
  material.rubbery_modulus = 1.0;
  material.glassy_modulus = 1.0 / shipped_master_curve().modulus_ratio;
  material.creep_times = {1.0};
  PanelCurve storage{"E₁/E₀", {}, {}, Mark::line, 0};
  PanelCurve loss{"E₂/E₀", {}, {}, Mark::line, 1};
  PanelCurve tangent{"", {}, {}, Mark::line, 0};
  for (double lg = -3.0; lg <= 4.001; lg += 0.05) {
    const double omega = std::pow(10.0, lg);
    const std::complex<double> modulus = material.modulus(omega);
    for (PanelCurve* curve : {&storage, &loss, &tangent}) curve->x.push_back(omega);
    storage.y.push_back(modulus.real());
    loss.y.push_back(modulus.imag());
    tangent.y.push_back(modulus.imag() / modulus.real());
  }
  DiagramPanel moduli{"ω τ", "modulus",      AxisKind::logarithmic, AxisKind::logarithmic,
                      false, {storage, loss}};
  DiagramPanel tangents{
      "ω τ", "loss tangent E₂/E₁", AxisKind::logarithmic, AxisKind::linear, false, {tangent}};
  plot_panels({moduli, tangents},
              "Complex modulus of a material with one creep time τ and E∞/E₀ = 10 (PPH, Fig. "
              "13).",
              figure);
}

/// PPH Fig. 3, cut along the speed: points of the boundary elements against the forms.
void draw_cuts(const Comparison& comparison, const std::filesystem::path& figure) {
  const BoundaryElementLaw law(shipped_master_curve());
  const FittedLaw refit(comparison.refit.coefficients);
  const FittedLaw published(published_coefficients());
  std::vector<DiagramPanel> panels;
  for (const QuantityText& quantity : quantities) {
    DiagramPanel panel;
    panel.x_label = "v τ/R";
    panel.y_label = quantity.label;
    panel.x_kind = AxisKind::logarithmic;
    panel.y_kind = AxisKind::logarithmic;
    int colour = 0;
    for (const double y : {1e-3, 1e-2, 1e-1}) {
      PanelCurve points{fmt::format("y/R = {:g}", y), {}, {}, Mark::points, colour};
      PanelCurve fit{"", {}, {}, Mark::line, colour};
      PanelCurve printed{"", {}, {}, Mark::dashed_line, colour};
      ++colour;
      for (double lg = -4.0; lg <= 3.001; lg += 0.05) {
        const double v = std::pow(10.0, lg);
        const auto add = [&](PanelCurve& curve, const ViscoelasticContactLaw& from) {
          const double value = (from.at(y, v).*quantity.member).value;
          if (value < 1e-3 * std::pow(y, quantity.exponent)) return;
          curve.x.push_back(v);
          curve.y.push_back(value);
        };
        add(fit, refit);
        add(printed, published);
        if (std::abs(std::remainder(lg, 0.25)) < 1e-9) add(points, law);
      }
      panel.curves.push_back(std::move(points));
      panel.curves.push_back(std::move(fit));
      panel.curves.push_back(std::move(printed));
    }
    panels.push_back(std::move(panel));
  }
  plot_panels(panels,
              "Boundary elements (points), the functional forms refitted to them (lines) and with "
              "the published coefficients (dashed): the same curves about two decades of speed "
              "apart (PPH, Fig. 3).",
              figure);
}

/// PPH Fig. 14: every sample against the value of the forms.
void draw_scatter(const Comparison& comparison, const std::filesystem::path& figure) {
  const FittedLaw refit(comparison.refit.coefficients);
  const FittedLaw moved(comparison.moved);
  std::vector<DiagramPanel> panels;
  const std::array<double LawSample::*, 3> members{&LawSample::friction, &LawSample::area,
                                                   &LawSample::force};
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    DiagramPanel panel;
    panel.x_label = std::string("boundary elements: ") + quantities[q].label;
    panel.y_label = "functional form";
    PanelCurve fitted{"refitted", {}, {}, Mark::points, 0};
    PanelCurve printed{"published, at v/100", {}, {}, Mark::points, 1};
    double largest = 0.0;
    for (const LawSample& sample : comparison.samples) {
      const double x = sample.*members[q];
      largest = std::max(largest, x);
      for (PanelCurve* curve : {&fitted, &printed}) {
        const FittedLaw& law = curve == &fitted ? refit : moved;
        curve->x.push_back(x);
        curve->y.push_back((law.at(sample.indentation, sample.speed).*quantities[q].member).value);
      }
    }
    panel.curves = {printed, fitted, {"", {0.0, largest}, {0.0, largest}, Mark::line, 5}};
    panels.push_back(std::move(panel));
  }
  plot_panels(panels,
              "The functional forms against the boundary elements, over all speeds and "
              "indentations of the fit (PPH, Fig. 14).",
              figure);
}

Json coefficients_json(const FitCoefficients& coefficients) {
  return {{"force", coefficients.force},
          {"area", coefficients.area},
          {"friction", coefficients.friction}};
}

Json quantities_json(const PerQuantity& values) {
  return {{"force", values.force}, {"area", values.area}, {"friction", values.friction}};
}

ExitCode fit(const FitOptions& options) {
  const std::vector<double> speeds = spaced_values("--speeds", options.speeds);
  const std::vector<double> indentations = spaced_values("--indentations", options.indentations);
  const std::array<const char*, 3> names{"modulus.png", "cuts.png", "scatter.png"};
  if (options.figures)
    prepare_folder(*options.figures, {names.begin(), names.end()}, options.common.overwrite());
  std::optional<Activity> fitting(std::in_place, "fitting the forms");
  const Comparison comparison = compare(speeds, indentations);
  fitting.reset();
  if (options.figures) {
    const std::filesystem::path folder = *options.figures;
    draw_modulus(folder / names[0]);
    draw_cuts(comparison, folder / names[1]);
    draw_scatter(comparison, folder / names[2]);
  }

  const FitCoefficients published = published_coefficients();
  const PerQuantity printed = determination(FittedLaw(published), comparison.samples);
  const PerQuantity moved = determination(FittedLaw(comparison.moved), comparison.samples);
  const PerQuantity refitted =
      determination(FittedLaw(comparison.refit.coefficients), comparison.samples);
  if (options.common.json) {
    const Json object = {{"samples", comparison.samples.size()},
                         {"converged", comparison.refit.converged},
                         {"published", coefficients_json(published)},
                         {"refit", coefficients_json(comparison.refit.coefficients)},
                         {"shift", quantities_json(comparison.shift)},
                         {"r2",
                          {{"published", quantities_json(printed)},
                           {"published_at_v_over_100", quantities_json(moved)},
                           {"refit", quantities_json(refitted)}}}};
    print_json(object);
  } else {
    fmt::print("{:<36}{:>10}{:>10}{:>10}\n", "", "force", "area", "friction");
    const auto print_row = [](const char* name, const PerQuantity& values) {
      fmt::print("{:<36}{:>10.4f}{:>10.4f}{:>10.4f}\n", name, values.force, values.area,
                 values.friction);
    };
    print_row("r^2 of the published fits", printed);
    print_row("r^2 of them at v/100", moved);
    print_row("r^2 of the refit", refitted);
    print_row("shift of the speed axis, decades", comparison.shift);
    const auto print_coefficients = [](const char* name, const auto& was, const auto& is,
                                       const auto& at_100) {
      for (std::size_t k = 0; k < was.size(); ++k) {
        fmt::print("{}{}  published {:>8.3f}, at v/100 {:>8.3f}, refit {:>8.4f}\n", name, k + 1,
                   was[k], at_100[k], is[k]);
      }
    };
    const FitCoefficients& is = comparison.refit.coefficients;
    print_coefficients("a", published.force, is.force, comparison.moved.force);
    print_coefficients("b", published.area, is.area, comparison.moved.area);
    print_coefficients("c", published.friction, is.friction, comparison.moved.friction);
    if (options.figures) fmt::print("{}\n", *options.figures);
  }
  if (!comparison.refit.converged)
    throw NumericalError(Refusal::no_convergence, "the refit did not converge");
  return ExitCode::done;
}

}  // namespace

void add_fit_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<FitOptions>();
  CLI::App* verb = program.add_subcommand(
      "fit", "Refit of the published contact laws to the boundary elements, and comparison");
  verb->add_option("--speeds", options->speeds,
                   "Speeds v tau/R: first, last, number; default 1e-3 1e3 49")
      ->expected(3);
  verb->add_option("--indentations", options->indentations,
                   "Indentations y/R likewise; default 1e-4 0.3 15")
      ->expected(3);
  verb->add_option("--figures", options->figures, "Folder for the pictures modulus, cuts, scatter");
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return fit(*options); }; });
}

}  // namespace stridor
