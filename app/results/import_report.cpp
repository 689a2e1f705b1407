#include "app/results/import_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "substructures/bodies/matrix_body.hpp"

namespace stridor {
namespace {

const char* word_of(StoredPart part) {
  switch (part) {
    case StoredPart::full: return "both triangles";
    case StoredPart::upper: return "upper triangle";
    case StoredPart::lower: return "lower triangle";
    case StoredPart::half: return "one entry of each pair";
    case StoredPart::diagonal: return "diagonal";
  }
  return "";
}

const char* word_of(Definiteness definiteness) {
  switch (definiteness) {
    case Definiteness::positive: return "positive definite";
    case Definiteness::semidefinite: return "positive semidefinite";
    case Definiteness::indefinite: return "indefinite";
  }
  return "";
}

Json vector_json(const Eigen::Vector3d& vector) {
  return {number(vector.x()), number(vector.y()), number(vector.z())};
}

Json mesh_json(const MeshFacts& facts) {
  Json object = {{"nodes", facts.num_nodes}, {"elements", Json::object()}};
  for (const auto& [shape, count] : facts.elements) object["elements"][facts_of(shape).name] = count;
  object["volume"] = number(facts.volume);
  object["centre"] = vector_json(facts.centre);
  object["lowest"] = vector_json(facts.lowest);
  object["highest"] = vector_json(facts.highest);
  object["surfaces"] = Json::object();
  for (const auto& [name, surface] : facts.surfaces) {
    object["surfaces"][name] = {{"sides", surface.num_sides},
                                {"area", number(surface.area)},
                                {"normal", vector_json(surface.normal)},
                                {"centre", vector_json(surface.centre)}};
  }
  object["node_sets"] = facts.node_sets;
  object["element_sets"] = facts.element_sets;
  return object;
}

Json matrices_json(const MatrixFacts& facts) {
  Json object = {{"unknowns", facts.num_unknowns}, {"files", Json::array()}};
  for (const MatrixFileFacts& file : facts.files) {
    object["files"].push_back({{"key", file.key},
                               {"format", file.format},
                               {"stored", word_of(file.stored)},
                               {"symmetry_error", number(file.symmetry_error)}});
  }
  object["mass_asymmetry"] = number(facts.mass_asymmetry);
  object["stiffness_asymmetry"] = number(facts.stiffness_asymmetry);
  object["mass"] = word_of(facts.mass);
  object["smallest_pivot"] = number(facts.smallest_pivot);
  object["stiffness"] = word_of(facts.stiffness);
  object["frequencies"] = Json::array();
  for (const double frequency : facts.frequencies) object["frequencies"].push_back(number(frequency));
  if (!facts.trouble.empty()) object["trouble"] = facts.trouble;
  object["rigid_motions"] = facts.num_rigid;
  if (facts.num_rigid_expected) object["rigid_motions_expected"] = *facts.num_rigid_expected;
  if (facts.masses.empty()) return object;
  object["nodes"] = facts.num_nodes;
  object["nodes_without_unknowns"] = facts.num_without;
  object["nodes_without_place"] = facts.missing.size();
  object["masses"] = Json::array();
  for (const DirectionMass& mass : facts.masses)
    object["masses"].push_back({{"mass", number(mass.mass)}, {"centre", vector_json(mass.centre)}});
  return object;
}

std::string text_of(const Eigen::Vector3d& vector) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", vector.x(), vector.y(), vector.z());
}

class Lines {
 public:
  explicit Lines(std::string indent) : indent_(std::move(indent)) {}
  void add(const std::string& name, const std::string& value) const {
    fmt::print("{}{:<26} {}\n", indent_, name, value);
  }

 private:
  std::string indent_;
};

void print_mesh(const MeshFacts& facts, const Lines& lines) {
  std::string elements;
  for (const auto& [shape, count] : facts.elements)
    elements += fmt::format("{}{} {}", elements.empty() ? "" : ", ", count, facts_of(shape).name);
  lines.add("mesh", fmt::format("{} nodes, {}", facts.num_nodes, elements));
  lines.add("  reaches", fmt::format("from {} to {} m", text_of(facts.lowest),
                                     text_of(facts.highest)));
  lines.add("  volume", fmt::format("{:.6g} m³, centre {} m", facts.volume, text_of(facts.centre)));
  for (const auto& [name, surface] : facts.surfaces) {
    lines.add("  surface " + name,
              fmt::format("{} sides, {:.6g} m², normal {}, centre {} m", surface.num_sides,
                          surface.area, text_of(surface.normal), text_of(surface.centre)));
  }
  for (const auto& [name, count] : facts.node_sets)
    lines.add("  node set " + name, fmt::format("{} nodes", count));
  for (const auto& [name, count] : facts.element_sets)
    lines.add("  element set " + name, fmt::format("{} elements", count));
}

std::string frequencies_text(const std::vector<double>& frequencies) {
  std::string text;
  for (const double frequency : frequencies)
    text += fmt::format("{}{:.6g}", text.empty() ? "" : ", ", frequency);
  return text;
}

void print_nodes(const MatrixFacts& facts, const Lines& lines) {
  constexpr const char* axes[] = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < facts.masses.size() && axis < 3; ++axis) {
    const DirectionMass& mass = facts.masses[axis];
    lines.add(fmt::format("  mass along {}", axes[axis]),
              fmt::format("{:.6g} kg of what moves, centre {} m", mass.mass, text_of(mass.centre)));
  }
  if (facts.num_without > 0) {
    lines.add("  nodes without unknowns",
              fmt::format("{} of {}: held or tied where the matrices were made", facts.num_without,
                          facts.num_nodes));
  }
  if (!facts.missing.empty()) {
    lines.add("  unknowns without a place",
              fmt::format("of {} nodes, which the mesh or table has not: {}{}", facts.missing.size(),
                          facts.missing.front(), facts.missing.size() > 1 ? ", ..." : ""));
  }
}

void print_matrices(const MatrixFacts& facts, const Lines& lines) {
  lines.add("matrices", fmt::format("{} unknowns", facts.num_unknowns));
  for (const MatrixFileFacts& file : facts.files) {
    lines.add("  " + file.key, fmt::format("{}, {}, symmetry error {:.1e}", file.format,
                                           word_of(file.stored), file.symmetry_error));
  }
  lines.add("  M", fmt::format("{}, smallest pivot {:.1e} of its diagonal", word_of(facts.mass),
                               facts.smallest_pivot));
  if (!facts.trouble.empty()) {
    lines.add("  K", facts.trouble);
  } else if (!facts.frequencies.empty()) {
    lines.add("  K", fmt::format("{}, asymmetry {:.1e}", word_of(facts.stiffness),
                                 facts.stiffness_asymmetry));
    std::string rigid = fmt::format("{} found", facts.num_rigid);
    if (facts.num_rigid_expected) {
      const int expected = *facts.num_rigid_expected;
      rigid += fmt::format(", {} expected from what is held{}", expected,
                           expected == facts.num_rigid ? "" : ": LOOK INTO IT");
    }
    lines.add("  rigid motions", rigid);
    lines.add("  frequencies (Hz)", frequencies_text(facts.frequencies));
  }
  print_nodes(facts, lines);
}

}  // namespace

Json import_json(const ImportFacts& facts) {
  Json object = Json::object();
  if (facts.matrices) object["matrices"] = matrices_json(*facts.matrices);
  if (facts.mesh) object["mesh"] = mesh_json(*facts.mesh);
  return object;
}

void print_import(const ImportFacts& facts, const std::string& indent) {
  const Lines lines(indent);
  if (facts.matrices) print_matrices(*facts.matrices, lines);
  if (facts.mesh) print_mesh(*facts.mesh, lines);
  if (!facts.matrices || !facts.mesh || facts.matrices->masses.empty()) return;
  const DirectionMass& mass = facts.matrices->masses.front();
  if (facts.matrices->num_without == 0 && facts.mesh->dimension == 3)
    lines.add("mass over volume", fmt::format("{:.6g} kg/m³", mass.mass / facts.mesh->volume));
}

}  // namespace stridor
