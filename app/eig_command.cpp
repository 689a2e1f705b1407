// stridor eig: sliding equilibrium of a scene and its eigenvalues.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>

#include "analysis/explanation.hpp"
#include "app/eigenvalue_report.hpp"
#include "app/linear_stability.hpp"
#include "app/sphere_stability.hpp"
#include "app/stability.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/shape_plot.hpp"
#include "models/mode_shape.hpp"
#include "solvers/retained_modes.hpp"
#include "solvers/secular_eigenvalues.hpp"

namespace stridor {
namespace {

struct EigOptions {
  StabilityOptions stability;
  std::optional<std::string> at;
  bool explain = false;
  std::optional<int> mode;
  std::optional<std::string> shapes;
};

constexpr int num_frames = 24;

/// The scene at the position asked for.
SceneFamily make_family(const LoadedScene& loaded, const EigOptions& options,
                        std::vector<double>& values) {
  if (!options.at) return SceneFamily(loaded, {});
  const auto path = start_key(loaded.scene.model);
  if (!path) {
    throw ConfigError("--at",
                      "the scene has several contact pairs; set the `start` of one of them "
                      "with --set");
  }
  const NumericKey key = find_stability_key(loaded.scene, *path, "--at");
  values.push_back(parse_value(key, *options.at, "--at"));
  return SceneFamily(loaded, {key});
}

Json explanation_json(const Pencil& pencil, const Eigenvalue& eigenvalue, std::size_t number) {
  const Eigenvector vector = eigenvector(pencil, eigenvalue.s);
  const ModeQuotients seen = mode_quotients(pencil, eigenvalue.s, vector.right);
  const ModeEnergy energy = mode_energy(pencil, eigenvalue.s, vector);
  const double frequency = eigenvalue.frequency();
  // Modes far above take no part; those a little above may.
  const std::vector<Eigenvalue> modes =
      secular_eigenvalues(frictionless(pencil), SpectrumWindow::below(1.5 * frequency));
  std::vector<Eigenvalue> vibrating;
  std::copy_if(modes.begin(), modes.end(), std::back_inserter(vibrating),
               [](const Eigenvalue& one) { return one.s.imag() > 0.0; });
  const std::vector<Participation> shares = participations(pencil, vibrating, vector.right);
  Json frictionless_modes = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(2, shares.size()); ++i)
    frictionless_modes.push_back({{"frequency", shares[i].frequency}, {"share", shares[i].share}});
  return {{"mode", number},
          {"frequency", frequency},
          {"growth", eigenvalue.growth()},
          {"quotients", quotients_json(seen)},
          {"energy",
           {{"growth_from_contact", energy.from_contact},
            {"growth_by_damping", energy.by_damping},
            {"growth_by_coupled_terms", energy.by_coupled},
            {"contact_per_cycle", ModeEnergy::per_cycle(energy.from_contact, frequency)},
            {"damping_per_cycle", ModeEnergy::per_cycle(energy.by_damping, frequency)},
            {"residual", energy.residual}}},
          {"frictionless_modes", frictionless_modes}};
}

/// Draws one mode and writes it for ParaView. @return the files
std::vector<std::string> write_shapes(const EigOptions& options, const LoadedScene& loaded,
                                      const SceneFamily::Member& member, const SlidingState& state,
                                      const Eigenvalue& eigenvalue, std::size_t number) {
  const std::filesystem::path folder = *options.shapes;
  const std::filesystem::path stem = folder / fmt::format("mode_{:02}", number);
  std::filesystem::path figure = stem;
  figure += ".png";
  check_figure(figure, options.stability.common);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError(folder.string(), "", "cannot be made: " + error.message());

  // The largest displacement at phase 0 is real.
  const Eigenvector vector = eigenvector(state.pencil, eigenvalue.s);
  BodyCache cache;
  ShapePicture picture;
  picture.bodies = mode_shape(*member.model, state.equilibrium, vector.right, cache);
  std::complex<double> largest = 0.0;
  for (const BodyShape& body : picture.bodies) {
    for (const std::complex<double>& u : body.displacement.reshaped())
      if (std::abs(u) > std::abs(largest)) largest = u;
  }
  for (BodyShape& body : picture.bodies) body.displacement /= largest;
  for (std::size_t i = 0; i < state.equilibrium.contacts.size(); ++i) {
    if (!state.equilibrium.contacts[i].is_closed) continue;
    // The positions of a contact are as seen from the undeformed first node of its segment.
    const ContactEquilibrium& contact = state.equilibrium.contacts[i];
    const MasterSurface& surface =
        member.model->system
            .surfaces[static_cast<std::size_t>(member.model->system.contacts[i].surface)];
    const SurfacePiece& seen = state.equilibrium.state.geometry == ContactGeometry::deformed
                                   ? contact.positions.master
                                   : contact.positions.undeformed;
    picture.contacts.push_back(surface.positions[static_cast<std::size_t>(contact.segment)] +
                               seen.combine(contact.projection.weights));
  }
  picture.caption = fmt::format(
      "Mode {} at {:.2f} Hz, growth rate {:.4g} 1/s, about the {} geometry; displacements "
      "enlarged, "
      "grey: at rest, circle: contact. {}, scene {}.",
      number, eigenvalue.frequency(), eigenvalue.growth(), options.stability.about,
      std::filesystem::path(options.stability.scene).filename().string(), loaded.hash());
  plot_shape(picture, figure);
  std::vector<std::string> files{figure.string()};
  for (const auto& file : write_shape_frames(picture, stem, num_frames))
    files.push_back(file.string());
  return files;
}

void print_equilibrium(const System& system, const Equilibrium& equilibrium) {
  for (std::size_t i = 0; i < system.contacts.size(); ++i) {
    const ContactEquilibrium& contact = equilibrium.contacts[i];
    if (!contact.is_closed) {
      fmt::print("{:<20}open, gap {:.4g} m\n", system.contacts[i].name, contact.gap);
      continue;
    }
    fmt::print(
        "{:<20}{:.6g} m along the master, force {:.6g} N, friction {:.6g} N, sliding at "
        "{:.4g} m/s{}\n",
        system.contacts[i].name, contact.position, contact.force, contact.friction_force,
        contact.slip_velocity,
        contact.force < 0.0 ? " (pulls: no equilibrium of real bodies)" : "");
  }
}

void print_explanation(const Json& explanation) {
  const auto value = [](const Json& object, const char* key) { return object[key].get<double>(); };
  const Json& energy = explanation["energy"];
  fmt::print("\nmode {} at {:.2f} Hz, growth {:.4f} 1/s\n", explanation["mode"].get<int>(),
             value(explanation, "frequency"), value(explanation, "growth"));
  print_quotients(explanation["quotients"]);
  fmt::print("  growth: {:+.4f} 1/s from the contact, {:+.4f} 1/s by damping\n",
             value(energy, "growth_from_contact"), value(energy, "growth_by_damping"));
  if (const double coupled = value(energy, "growth_by_coupled_terms"); coupled != 0.0)
    fmt::print("          {:+.4f} 1/s by coupled terms of bodies\n", coupled);
  fmt::print(
      "  of its energy {:+.4f} % enters at the contact in each cycle, {:+.4f} % by damping\n",
      100.0 * value(energy, "contact_per_cycle"), 100.0 * value(energy, "damping_per_cycle"));
  for (const Json& mode : explanation["frictionless_modes"]) {
    fmt::print("  {:.1f} % of it is the mode of {:.2f} Hz without friction\n",
               100.0 * value(mode, "share"), value(mode, "frequency"));
  }
}

ExitCode eig(EigOptions options) {
  if (options.mode && !options.explain && !options.shapes)
    throw ConfigError("--mode", "names the mode to explain or draw; add --explain or --shapes");
  if (is_linear_scene_file(options.stability.scene)) {
    if (options.at) throw ConfigError("--at", "needs a contact that moves along a master");
    if (options.shapes) throw ConfigError("--shapes", "needs bodies with meshes");
    choose_method(options.stability);
    return eig_of_linear_scene(options.stability, options.explain, options.mode);
  }
  if (is_sphere_scene_file(options.stability.scene)) {
    if (options.at || options.shapes || options.explain) {
      throw ConfigError(options.at       ? "--at"
                        : options.shapes ? "--shapes"
                                         : "--explain",
                        "is for scenes of bodies");
    }
    choose_method(options.stability);
    return eig_of_sphere(options.stability);
  }
  const LoadedScene loaded = load_scene(options.stability.scene, options.stability.common.sets);
  choose_method(options.stability);
  std::vector<double> values;
  SceneFamily family = make_family(loaded, options, values);
  const SceneFamily::Member member = family.at(values);
  const System& system = member.model->system;
  std::optional<Activity> solving(std::in_place, "equilibrium and eigenvalues");
  const SlidingState state = sliding_state_of(member, options.stability.geometry(), "");
  const Pencil pencil = retained(state.pencil, system, loaded.scene.time);
  const LowestEigenvalues lowest =
      find_lowest(pencil, options.stability.eigenvalue_method(), options.stability.window());
  const std::vector<Eigenvalue>& eigenvalues = lowest.eigenvalues;

  solving.reset();

  const std::size_t num_real = num_real_of(eigenvalues);
  const double trusted =
      std::min(trusted_frequency(system),
               asked_frequency(system, loaded.scene.time) / (2.0 * std::numbers::pi));
  std::vector<std::complex<double>> roots;
  roots.reserve(eigenvalues.size());
  for (const Eigenvalue& one : eigenvalues) roots.push_back(one.s);
  const double highest = verdict_limit(roots, options.stability.window(), trusted);
  const bool is_stable = std::none_of(
      eigenvalues.begin(), eigenvalues.end(),
      [&](const Eigenvalue& one) { return one.frequency() <= highest && is_growing(one); });
  Json object = {{"about", options.stability.about},
                 {"method", lowest.method_name()},
                 {"equilibrium", equilibrium_json(*member.model, state.equilibrium)},
                 {"eigenvalues", eigenvalues_json(eigenvalues)},
                 {"residuals", Json::array()},
                 {"doubtful", doubtful_json(eigenvalues)},
                 {"stable", is_stable},
                 {"window", {0.0, number(highest)}}};
  if (!lowest.remark.empty()) object["remark"] = lowest.remark;
  for (const Eigenvalue& one : eigenvalues) object["residuals"].push_back(number(one.residual));
  if (options.explain || options.shapes) {
    const std::size_t chosen = chosen_mode(eigenvalues, num_real, options.mode);
    const std::size_t number_of_mode = chosen - num_real + 1;
    if (options.explain)
      object["explanation"] = explanation_json(pencil, eigenvalues[chosen], number_of_mode);
    if (options.shapes) {
      object["files"] =
          write_shapes(options, loaded, member, state, eigenvalues[chosen], number_of_mode);
    }
  }

  if (options.stability.common.json) {
    print_json(object);
    return ExitCode::done;
  }
  print_equilibrium(system, state.equilibrium);
  if (!lowest.remark.empty()) fmt::print("{}\n", lowest.remark);
  print_eigenvalues(eigenvalues, trusted);
  fmt::print("{} between 0 and {:.6g} Hz{}, about the {} geometry\n",
             is_stable ? "stable" : "unstable", highest, limit_text(highest, trusted),
             options.stability.about);
  if (options.explain) print_explanation(object["explanation"]);
  if (options.shapes) {
    fmt::print("{} and {} files for ParaView\n", object["files"][0].get<std::string>(),
               object["files"].size() - 1);
  }
  return ExitCode::done;
}

}  // namespace

void add_eig_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<EigOptions>();
  CLI::App* verb =
      program.add_subcommand("eig", "Sliding equilibrium and its eigenvalues at one position");
  add_stability_options(*verb, options->stability);
  verb->add_option("--at", options->at,
                   "Position of the contact along the master, about the deformed geometry on the "
                   "deformed one, m "
                   "or with a unit; default: contact.start");
  verb->add_flag("--explain", options->explain,
                 "Say why a mode grows: what it sees of damping, stiffness and friction, where its "
                 "energy comes from, which modes without friction it is made of");
  verb->add_option("--mode", options->mode,
                   "Number of the mode to explain or draw; default: the one that grows fastest")
      ->check(CLI::Range(1, 100000));
  verb->add_option("--shapes", options->shapes,
                   "Folder for a picture of the mode and its motion for ParaView (VTK)");
  add_force_option(*verb, options->stability.common);
  verb->callback([options, &action] { action = [options] { return eig(*options); }; });
}

}  // namespace stridor
