#include "substructures/bodies/mesh_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "substructures/bodies/meshed_body.hpp"

namespace stridor {
namespace {

/// Nodes of a name as contacts count them.
std::size_t count_nodes(const Mesh& mesh, const std::string& name) {
  const auto surface = mesh.surfaces.find(name);
  return surface == mesh.surfaces.end() ? 0 : nodes_of(mesh, surface->second).size();
}

}  // namespace

const Schema& MeshSupportParameters::schema() {
  using P = MeshSupportParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_support")
          .text_list("on", &P::on, {.doc = "Surfaces or node sets that are held."})
          .text_list(
              "held", &P::held,
              {.doc = "Directions in which they are: x, y, z; default: all.", .optional = true})
          .check([](const P& support, std::vector<Problem>& problems) {
            for (const std::string& direction : support.held) {
              if (direction == "x" || direction == "y" || direction == "z") continue;
              problems.push_back(
                  {"held", fmt::format("'{}' is no direction: x, y or z", direction), {}, 0, 0});
            }
            if (support.on.empty())
              problems.push_back({"on", "must name a surface or node set", {}, 0, 0});
          });
  return keys;
}

const Schema& MeshGuideParameters::schema() {
  using P = MeshGuideParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_guide")
          .text_list(
              "on", &P::on,
              {.doc = "Surfaces or node sets that follow the drive along x, are held across, "
                      "and share one displacement along y, on which its load acts."})
          .check([](const P& guide, std::vector<Problem>& problems) {
            if (guide.on.empty())
              problems.push_back({"on", "must name a surface or node set", {}, 0, 0});
          });
  return keys;
}

const Schema& MeshPointParameters::schema() {
  using P = MeshPointParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_point")
          .real_list("at", &P::at,
                     {.doc = "Place in the frame of the mesh; within an element the point moves as "
                             "its shape functions have it.",
                      .unit = "m",
                      .optional = true})
          .integer("node", &P::node,
                   {.doc = "Number of a node in the file, in the place of `at`.", .optional = true})
          .text("mean_of", &P::mean_of,
                {.doc = "In the place of `at`: a surface, of which the point has the mean "
                        "displacement, or a node set, of which it has that of the nodes.",
                 .optional = true})
          .check([](const P& point, std::vector<Problem>& problems) {
            const auto superfluous = [&](const char* key) {
              problems.push_back({key,
                                  "is not used: the point is given already; leave one of them out",
                                  {},
                                  0,
                                  0});
            };
            const bool is_placed = !point.at.empty();
            if (point.node && is_placed) superfluous("node");
            if (!point.mean_of.empty() && (point.node || is_placed)) superfluous("mean_of");
            if (!is_placed && !point.node && point.mean_of.empty())
              problems.push_back({"at", "is missing; give it, `node` or `mean_of`", {}, 0, 0});
            expect_components(point.at, "at", true, problems);
          });
  return keys;
}

const Schema& MeshBodyParameters::schema() {
  using P = MeshBodyParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_body")
          .text("file", &P::file,
                {.doc = "The mesh, from the folder of the scene: Gmsh (.msh of version 4.1 or 2.2) "
                        "or Abaqus and CalculiX (.inp)."})
          .text("length_unit", &P::length_unit,
                {.doc = "Unit of the coordinates in the file.", .optional = true})
          .real("thickness", &P::thickness,
                {.doc = "Of a planar mesh, across its plane.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true})
          .choice("plane", &P::plane,
                  {{"stress", PlaneState::stress}, {"strain", PlaneState::strain}},
                  {.doc = "What a planar mesh has none of across its plane.", .optional = true})
          .real("angle", &P::angle,
                {.doc = "By which the mesh is turned about z.",
                 .unit = "rad",
                 .range = Range::between(-7.0, 7.0),
                 .optional = true})
          .section("material", &P::material, {.doc = "Isotropic linear elastic material."})
          .named_sections(
              "materials", &P::materials,
              {.doc = "Other materials of element sets, by name of the set.", .optional = true})
          .section("damping", &P::damping,
                   {.doc = "Rayleigh damping and its schedule.", .optional = true})
          .named_sections(
              "surfaces", &P::surfaces,
              {.doc = "Surfaces by where they are, besides those of the file.", .optional = true})
          .named_sections("supports", &P::supports,
                          {.doc = "What is held, by name.", .optional = true})
          .section("guided", &P::guided, {.doc = "What follows the drive.", .optional = true})
          .named_sections("points", &P::points,
                          {.doc = "Points that touch others or are recorded.", .optional = true})
          .named_sections("springs", &P::springs,
                          {.doc = "Springs to the ground, by name; the damping of the body "
                                  "includes them.",
                           .optional = true})
          .section("interface", &P::interface,
                   {.doc = "Surface nodes kept for contact.", .optional = true})
          .section("reduction", &P::reduction,
                   {.doc = "Craig-Bampton reduction; default: every unknown is kept.",
                    .optional = true});
  return keys;
}

bool MeshBodyParameters::is_spatial() const {
  // Elements of fewer dimensions are groups in a mesh with volumes.
  return mesh && std::any_of(mesh->shapes.begin(), mesh->shapes.end(), [](ElementShape shape) {
           return facts_of(shape).dimension == 3;
         });
}

void MeshBodyParameters::read(const BodyFiles& files) {
  mesh = std::make_shared<const Mesh>(files.mesh("file", file));
}

bool MeshBodyParameters::take_contents(const BodyParameters& other) {
  const auto* given = dynamic_cast<const MeshBodyParameters*>(&other);
  if (given == nullptr || !given->mesh || given->file != file) return false;
  mesh = given->mesh;
  return true;
}

BodyMatrices MeshBodyParameters::make() const {
  return make_meshed_body(*this);
}

std::optional<int> MeshBodyParameters::num_modes() const {
  if (!reduction) return std::nullopt;
  return reduction->fixed_interface_modes;
}

bool MeshBodyParameters::is_filled() const {
  return mesh && facts_of(mesh->shapes.front()).dimension == 2;
}

std::vector<DrawnElement> drawn_elements(const Mesh& mesh) {
  std::vector<DrawnElement> drawn;
  drawn.reserve(mesh.num_elements());
  for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
    const std::span<const int> nodes = mesh.nodes_of(e);
    drawn.push_back({mesh.shapes[e], {nodes.begin(), nodes.end()}});
  }
  return drawn;
}

std::vector<DrawnElement> MeshBodyParameters::elements() const {
  return mesh ? drawn_elements(*mesh) : std::vector<DrawnElement>();
}

double MeshBodyParameters::num_slave_nodes(const std::string& name) const {
  if (!mesh) return 1.0;
  if (surfaces.contains(name)) return static_cast<double>(count_nodes(named_mesh(*this), name));
  const auto num_nodes = static_cast<double>(count_nodes(*mesh, name));
  // A point within an element keeps all of its nodes.
  return num_nodes > 0.0 ? num_nodes : 20.0;
}

ReductionSize MeshBodyParameters::reduction_size(double interface_nodes) const {
  ReductionSize size;
  if (!mesh || !reduction) return size;
  const double d = facts_of(mesh->shapes.front()).dimension;
  double pairs = 0.0;
  for (const ElementShape shape : mesh->shapes) pairs += std::pow(facts_of(shape).num_nodes, 2);
  const double n = d * static_cast<double>(mesh->num_nodes());
  size.interface = size.watched = std::min(d * interface_nodes, n);
  size.unknowns = n - size.interface;
  size.modes = reduction->fixed_interface_modes;
  // Neighbouring elements share a good half of the pairs of their nodes.
  size.matrix_entries = 0.6 * (d * d + d) * pairs;
  // Under nested dissection.
  size.factor_entries = d == 2.0 ? 12.0 * n * std::log2(n + 2.0) : 4.0 * std::pow(n, 4.0 / 3.0);
  return size;
}

SizeKey MeshBodyParameters::size_key() const {
  return {".file", "take a coarser mesh, or keep fewer nodes"};
}

std::optional<ImportFacts> MeshBodyParameters::import_facts() const {
  if (!mesh) return std::nullopt;
  return ImportFacts{mesh_facts(named_mesh(*this), thickness.value_or(1.0)), std::nullopt};
}

}  // namespace stridor
