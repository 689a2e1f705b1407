#include "app/stability/mode_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/errors.hpp"
#include "io/figures/shape_plot.hpp"
#include "models/mode_shape.hpp"

namespace stridor {
namespace {

constexpr int num_frames = 24;

/// The largest displacement of any node, 0 where nothing moves.
std::complex<double> largest_displacement(const std::vector<BodyShape>& bodies) {
  std::complex<double> largest = 0.0;
  for (const BodyShape& body : bodies) {
    for (const std::complex<double>& u : body.displacement.reshaped())
      if (std::abs(u) > std::abs(largest)) largest = u;
  }
  return largest;
}

/// Where bodies touch that slide on lines, m.
std::vector<Eigen::Vector2d> contact_places(const SceneFamily::Member& member,
                                            const SlidingState& state) {
  std::vector<Eigen::Vector2d> places;
  for (std::size_t i = 0; i < state.equilibrium.contacts.size(); ++i) {
    if (!state.equilibrium.contacts[i].is_closed) continue;
    // The positions of a contact are as seen from the undeformed first node of its segment.
    const ContactEquilibrium& contact = state.equilibrium.contacts[i];
    const ContactPoint& point = member.model->system.contacts[i];
    if (point.has_two_tangents()) continue;  // the picture shows no face
    const MasterSurface& surface = member.model->system.surface_of(point);
    const SurfacePiece& seen = state.equilibrium.state.geometry == ContactGeometry::deformed
                                   ? contact.positions.master
                                   : contact.positions.undeformed;
    places.push_back(surface.positions[static_cast<std::size_t>(contact.segment)] +
                     seen.combine(contact.projection.weights));
  }
  return places;
}

}  // namespace

std::vector<std::string> write_mode_pictures(
    const std::filesystem::path& folder, const StabilityOptions& options, const LoadedScene& loaded,
    const SceneFamily::Member& member, const SlidingState& state, const Eigenvalue& eigenvalue,
    const Eigen::VectorXcd& right, std::size_t number) {
  const std::filesystem::path stem = folder / fmt::format("mode_{:02}", number);
  std::filesystem::path figure = stem;
  figure += ".png";
  check_figure(figure, options.common);
  // The largest displacement at phase 0 is real.
  BodyCache cache;
  ShapePicture picture;
  picture.bodies = mode_shape(*member.model, state.equilibrium, right, cache);
  const double of_all = std::abs(largest_displacement(picture.bodies));
  std::erase_if(picture.bodies, [](const BodyShape& body) { return body.nodes.rows() == 0; });
  if (picture.bodies.empty())
    throw ConfigError(
        Refusal::missing, "--shapes",
        "no body has nodes to draw; matrices take them from their keys mesh or nodes");
  const std::complex<double> largest = largest_displacement(picture.bodies);
  constexpr double rounding = 1e-9;
  if (!(std::abs(largest) > rounding * of_all))
    throw ConfigError(Refusal::motion_is_held, "--mode",
                      "moves none of the bodies that can be drawn");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw FileError(Refusal::cannot_write, folder.string(), "",
                    "cannot be made: " + error.message());
  for (BodyShape& body : picture.bodies) body.displacement /= largest;
  picture.contacts = contact_places(member, state);
  // In grey are outlines, and nodes of bodies that have nothing else.
  const bool shows_rest = std::any_of(
      picture.bodies.begin(), picture.bodies.end(),
      [](const BodyShape& body) { return !body.outlines.empty() || body.elements.empty(); });
  picture.caption = fmt::format(
      "Mode {} at {:.2f} Hz, growth rate {:.4g} 1/s, about the {} geometry; displacements "
      "enlarged{}{}. {}, scene {}.",
      number, eigenvalue.frequency(), eigenvalue.growth(), options.about,
      shows_rest ? ", grey: at rest" : "", picture.contacts.empty() ? "" : ", circle: contact",
      std::filesystem::path(options.scene).filename().string(), loaded.hash());
  plot_shape(picture, figure);
  const double period = eigenvalue.frequency() > 0.0 ? 1.0 / eigenvalue.frequency() : 1.0;
  std::vector<std::string> files{figure.string()};
  for (const auto& file : write_shape_frames(picture, stem, num_frames, period))
    files.push_back(file.string());
  return files;
}

}  // namespace stridor
