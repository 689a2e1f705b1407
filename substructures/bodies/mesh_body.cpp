#include "substructures/bodies/mesh_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/units.hpp"
#include "substructures/bodies/meshed_body.hpp"

namespace stridor {
namespace {

/// Nodes of a name as contacts count them.
std::size_t count_nodes(const Mesh& mesh, const std::string& name) {
  const auto surface = mesh.surfaces.find(name);
  return surface == mesh.surfaces.end() ? 0 : nodes_of(mesh, surface->second).size();
}

}  // namespace

// Long because it is a table: one entry for each key.
const Schema& MeshBodyParameters::schema() {
  using P = MeshBodyParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_body")
          .text("file", &P::file,
                {.doc = "The mesh, from the folder of the scene: Gmsh (.msh of version 4.1 or 2.2) "
                        "or Abaqus and CalculiX (.inp); or a geometry (.geo, .step, .stp, .brep, "
                        ".iges, .igs), which the program gmsh meshes."})
          .text("length_unit", &P::length_unit,
                {.doc = "Unit of the coordinates in the file.", .optional = true})
          .real("mesh_size", &P::mesh_size,
                {.doc = "Of a geometry: the largest size of its elements.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true})
          .integer("mesh_order", &P::mesh_order,
                   {.doc = "Of a geometry: 1 for linear elements, 2 for those with nodes in the "
                           "middle of their edges.",
                    .optional = true,
                    .range = Range::between(1, 2)})
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
          .section("material", &P::material, {.doc = "Linear elastic material."})
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
          .section("spin", &P::spin,
                   {.doc = "Of a body that spins about its axis.", .optional = true})
          .named_sections("points", &P::points,
                          {.doc = "Points that touch others or are recorded.", .optional = true})
          .named_sections(
              "rigid_regions", &P::rigid_regions,
              {.doc = "Sets of nodes that move as one rigid body, by name.", .optional = true})
          .named_sections("ties", &P::ties,
                          {.doc = "Surfaces that are bonded though their meshes do not match, by "
                                  "name.",
                           .optional = true})
          .named_sections(
              "masses", &P::masses,
              {.doc = "Rigid masses at points and rigid regions, by name.", .optional = true})
          .named_sections(
              "loads", &P::loads,
              {.doc = "Pressures and tractions on surfaces, by name.", .optional = true})
          .named_sections("springs", &P::springs,
                          {.doc = "Springs and dampers to the ground, by name; the damping of the "
                                  "body includes the springs.",
                           .optional = true})
          .section("interface", &P::interface,
                   {.doc = "Surface nodes kept for contact.", .optional = true})
          .section(
              "reduction", &P::reduction,
              {.doc = "Craig-Bampton reduction; default: every unknown is kept.", .optional = true})
          .check([](const P& body, std::vector<Problem>& problems) {
            if (!body.spin || body.spin->sliding == SpinSliding::frozen) return;
            if (body.springs.empty() || body.damping.beta == 0.0) return;
            problems.push_back(
                {Refusal::contradiction, "damping.beta",
                 "damps the springs too, which rest while the body spins; damp its materials "
                 "(material.damping.beta) and leave it at 0"});
          });
  return keys;
}

bool MeshBodyParameters::is_spatial() const {
  // Elements of fewer dimensions are groups in a mesh with volumes.
  return mesh && std::any_of(mesh->shapes.begin(), mesh->shapes.end(), [](ElementShape shape) {
           return facts_of(shape).dimension == 3;
         });
}

double MeshBodyParameters::metres_per_unit() const {
  try {
    return parse_quantity("1 " + length_unit, "m");
  } catch (const std::invalid_argument& error) {
    throw ConfigError(Refusal::wrong_unit, "length_unit", error.what());
  }
}

std::vector<NamedFile> MeshBodyParameters::files() {
  std::vector<NamedFile> named{{"file", &file}};
  if (!kept_mesh.empty()) named.push_back({"mesh", &kept_mesh});
  return named;
}

void MeshBodyParameters::read(const BodyFiles& files) {
  if (!is_geometry(file)) {
    if (mesh_size)
      throw ConfigError(Refusal::contradiction, "mesh_size",
                        "is not used: the file is a mesh, not a geometry");
    mesh = std::make_shared<const Mesh>(files.mesh("file", file));
    return;
  }
  if (!mesh_size)
    throw ConfigError(Refusal::missing, "mesh_size",
                      "is missing: the file is a geometry, which is divided into elements of it");
  kept_mesh = files.mesh_of_geometry("file", file, {*mesh_size / metres_per_unit(), mesh_order});
  mesh = std::make_shared<const Mesh>(files.mesh("mesh", kept_mesh));
}

bool MeshBodyParameters::take_contents(const BodyParameters& other) {
  const auto* given = dynamic_cast<const MeshBodyParameters*>(&other);
  if (given == nullptr || !given->mesh || given->file != file ||
      given->mesh_size != mesh_size || given->mesh_order != mesh_order ||
      (mesh_size && given->length_unit != length_unit))
    return false;
  mesh = given->mesh;
  kept_mesh = given->kept_mesh;
  return true;
}

BodyMatrices MeshBodyParameters::make() const {
  return make_meshed_body(*this);
}

std::optional<int> MeshBodyParameters::num_modes() const {
  if (!reduction) return std::nullopt;
  return reduction->fixed_interface_modes;
}

std::vector<Problem> MeshBodyParameters::warnings() const {
  std::vector<Problem> warnings;
  warn_of_sectors(*this, warnings);
  return warnings;
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
