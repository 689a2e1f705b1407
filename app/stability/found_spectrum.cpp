#include "app/stability/found_spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <memory>
#include <numbers>

#include "analysis/counted_spectra.hpp"
#include "app/stability/eigenvalue_report.hpp"
#include "app/stability/lowest_eigenvalues.hpp"
#include "app/stability/verdict.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"

namespace stridor {
namespace {

/// The modes without friction, damping and rotation that a motion is made of.
Json frictionless_modes_json(const Pencil& pencil, const Eigen::VectorXcd& right) {
  std::vector<Eigenvalue> modes = dense_eigenvalues(frictionless(pencil));
  std::erase_if(modes, [](const Eigenvalue& one) { return !(one.s.imag() > 0.0); });
  const std::vector<Participation> shares = participations(pencil, modes, right);
  Json list = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(2, shares.size()); ++i)
    list.push_back({{"frequency", shares[i].frequency}, {"share", shares[i].share}});
  return list;
}

}  // namespace

bool has_contacts(const Pencil& pencil) {
  return pencil.num_ports() > pencil.num_body_ports;
}

Json energy_json(const ModeEnergy& energy, double frequency) {
  return {{"growth_from_contact", energy.from_contact},
          {"growth_by_damping", energy.by_damping},
          {"growth_by_coupled_terms", energy.by_coupled},
          {"contact_per_cycle", ModeEnergy::per_cycle(energy.from_contact, frequency)},
          {"damping_per_cycle", ModeEnergy::per_cycle(energy.by_damping, frequency)},
          {"residual", energy.residual}};
}

FoundSpectrum find_dense(const Pencil& of, const SpectrumWindow& window, double trusted) {
  const auto pencil = std::make_shared<const Pencil>(of);
  const auto spectrum = std::make_shared<const DenseSpectrum>(dense_spectrum(*pencil));
  FoundSpectrum found{"dense", spectrum->eigenvalues};
  found.shape = [=](std::size_t chosen) -> Eigen::VectorXcd {
    return spectrum->right.col(static_cast<Eigen::Index>(chosen));
  };
  keep_window(found.eigenvalues, window);
  std::vector<std::complex<double>> roots;
  for (const Eigenvalue& one : found.eigenvalues) roots.push_back(one.s);
  const bool is_all = roots.size() == spectrum->eigenvalues.size();
  found.highest =
      is_all ? std::min(window.frequency, trusted) : verdict_limit(roots, window, trusted);
  found.explain = [=](std::size_t chosen) -> Json {
    const Eigen::VectorXcd right = spectrum->right.col(static_cast<Eigen::Index>(chosen));
    const std::complex<double> s = spectrum->eigenvalues[chosen].s;
    Json explanation = {{"quotients", quotients_json(mode_quotients(*pencil, s, right))},
                        {"frictionless_modes", frictionless_modes_json(*pencil, right)}};
    if (!has_contacts(*pencil))
      explanation["energy"] = energy_json(mode_energy(*pencil, s, {right, {}, Eigen::VectorXcd()}),
                                          spectrum->eigenvalues[chosen].frequency());
    return explanation;
  };
  return found;
}

FoundSpectrum find_sparse(const SparseSystem& system, const SpectrumWindow& asked) {
  const auto spectrum = std::make_shared<const SparseSpectrum>(whole_spectrum(system, asked));
  const double height = spectrum->rectangle.height / (2.0 * std::numbers::pi);
  FoundSpectrum found{"sparse", spectrum->eigenvalues};
  keep_window(found.eigenvalues, asked);
  std::vector<std::complex<double>> roots;
  for (const Eigenvalue& one : found.eigenvalues) roots.push_back(one.s);
  found.highest = verdict_limit(roots, asked, height);
  found.more["backward_errors"] = Json::array();
  for (std::size_t i = 0; i < roots.size(); ++i)
    found.more["backward_errors"].push_back(number(spectrum->backward_errors[i]));
  found.more["window_growth"] = {number(spectrum->rectangle.left()),
                                 number(spectrum->rectangle.right())};
  found.more["counted"] = spectrum->num_counted;
  found.explain = [=](std::size_t chosen) -> Json {
    const Eigen::VectorXcd right = spectrum->right.col(static_cast<Eigen::Index>(chosen));
    const ModeQuotients seen = mode_quotients(system, spectrum->eigenvalues[chosen].s, right);
    Json modes = Json::array();
    for (const Participation& one :
         participations(system, spectrum->omega, spectrum->modes, right)) {
      if (modes.size() < 2) modes.push_back({{"frequency", one.frequency}, {"share", one.share}});
    }
    return {{"quotients", quotients_json(seen)}, {"frictionless_modes", modes}};
  };
  return found;
}

void print_whole_explanation(const Json& explanation) {
  fmt::print("\nmode {} at {:.6g} Hz, growth {:.6g} 1/s\n", explanation["mode"].get<int>(),
             explanation["frequency"].get<double>(), explanation["growth"].get<double>());
  print_quotients(explanation["quotients"]);
  if (explanation.contains("energy")) {
    const Json& energy = explanation["energy"];
    fmt::print("  growth: {:+.6g} 1/s by damping, {:+.6g} 1/s by coupled terms of bodies\n",
               energy["growth_by_damping"].get<double>() + 0.0,
               energy["growth_by_coupled_terms"].get<double>() + 0.0);
  }
  for (const Json& one : explanation["frictionless_modes"]) {
    fmt::print("  {:.1f} % of it is the mode of {:.6g} Hz of the symmetric system\n",
               100.0 * one["share"].get<double>(), one["frequency"].get<double>());
  }
}

}  // namespace stridor
