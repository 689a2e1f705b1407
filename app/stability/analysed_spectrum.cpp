#include "app/stability/analysed_spectrum.hpp"

#include <algorithm>
#include <complex>
#include <memory>
#include <numbers>
#include <optional>

#include "analysis/explanation.hpp"
#include "app/stability/eigenvalue_report.hpp"
#include "app/stability/lowest_eigenvalues.hpp"
#include "app/stability/verdict.hpp"
#include "core/activity.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/integrators/retained_modes.hpp"

namespace stridor {
namespace {

/// Of a mode found by the problem on the ports of contacts.
Json explanation_json(const Pencil& pencil, const Eigenvalue& eigenvalue) {
  const Eigenvector vector = eigenvector(pencil, eigenvalue.s);
  const ModeQuotients seen = mode_quotients(pencil, eigenvalue.s, vector.right);
  const ModeEnergy energy = mode_energy(pencil, eigenvalue.s, vector);
  const double frequency = eigenvalue.frequency();
  // Modes far above take no part; those a little above may.
  const std::vector<Eigenvalue> modes = lowest_eigenvalues(
      frictionless(pencil), EigenvalueMethod::secular, SpectrumWindow::below(1.5 * frequency));
  std::vector<Eigenvalue> vibrating;
  std::copy_if(modes.begin(), modes.end(), std::back_inserter(vibrating),
               [](const Eigenvalue& one) { return one.s.imag() > 0.0; });
  const std::vector<Participation> shares = participations(pencil, vibrating, vector.right);
  Json frictionless_modes = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(2, shares.size()); ++i)
    frictionless_modes.push_back({{"frequency", shares[i].frequency}, {"share", shares[i].share}});
  return {{"quotients", quotients_json(seen)},
          {"energy", energy_json(energy, frequency)},
          {"frictionless_modes", frictionless_modes}};
}

/// By the problem on the ports of contacts, where it can be solved.
/// @param whole with all modes, for shapes
FoundSpectrum find_on_ports(const Pencil& of, const Pencil& whole, const StabilityOptions& options,
                            double trusted) {
  const auto pencil = std::make_shared<const Pencil>(of);
  const LowestEigenvalues lowest = find_lowest(of, options.eigenvalue_method(), options.window());
  FoundSpectrum found{lowest.method_name(), lowest.eigenvalues};
  std::vector<std::complex<double>> roots;
  for (const Eigenvalue& one : found.eigenvalues) roots.push_back(one.s);
  found.highest = verdict_limit(roots, options.window(), trusted);
  found.explain = [pencil, all = found.eigenvalues](std::size_t chosen) {
    return explanation_json(*pencil, all[chosen]);
  };
  found.shape = [whole, rows = std::optional<ModalRows>(),
                 all = found.eigenvalues](std::size_t chosen) mutable {
    if (!rows) rows = modal_rows(whole);
    return eigenvector(whole, *rows, all[chosen].s).right;
  };
  if (!lowest.remark.empty()) found.more["remark"] = lowest.remark;
  return found;
}

}  // namespace

Analysis analyse(const StabilityOptions& options, const LoadedScene& loaded,
                 const SceneFamily::Member& member) {
  const Activity solving("equilibrium and eigenvalues");
  Analysis analysis;
  analysis.member = member;
  if (analysis.is_sparse()) {
    analysis.found = find_sparse(*member.model->sparse, options.window());
    return analysis;
  }
  const System& system = member.model->system;
  analysis.state = sliding_state_of(member, options.geometry(),
                                    kept_terms(loaded.scene), "");
  analysis.trusted =
      std::min(trusted_frequency(system),
               asked_frequency(system, loaded.scene.time) / (2.0 * std::numbers::pi));
  const Pencil& whole = analysis.state.pencil;
  analysis.found = has_contacts(whole)
                       ? find_on_ports(retained(whole, system, loaded.scene.time), whole,
                                       options, analysis.trusted)
                       : find_dense(whole, options.window(), analysis.trusted);
  return analysis;
}

}  // namespace stridor
