#include "io/scene/former_keys.hpp"
#include "io/scene/scene_problems.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stridor {
namespace {

struct FormerKey {
  const char* path;
  const char* now;  ///< key and, where it has another unit or is computed, value
};

/// docs/format_2.md, "Sphere on a substrate". F, tau0, v, Omega, eta, alpha, xi_x and xi_y are the
/// numbers of the paper, k_x, omega_x, R, E and tau what they are measured in.
constexpr FormerKey former_keys[] = {
    {"sphere.stiffness_x", "substructures.NAME.springs.horizontal.stiffness"},
    {"sphere.natural_frequency", "substructures.NAME.masses.center.mass: =k_x/omega_x^2"},
    {"sphere.radius", "contact.normal.radius"},
    {"sphere.modulus", "contact.normal.modulus"},
    {"sphere.creep_time", "contact.normal.creep_time"},
    {"sphere.normal_load", "drive.load: =-F*E*R^2"},
    {"sphere.normal_force", "drive.load, with a minus"},
    {"sphere.shear_strength", "contact.friction.strength: =tau0*E"},
    {"sphere.shear_stress", "contact.friction.strength"},
    {"sphere.speed", "drive.velocity: =v*R/tau"},
    {"sphere.substrate_speed", "drive.velocity"},
    {"sphere.frequency_ratio", "substructures.NAME.springs.vertical.stiffness: =Omega^2*k_x"},
    {"sphere.stiffness_y", "substructures.NAME.springs.vertical.stiffness"},
    {"sphere.coupling_ratio", "substructures.NAME.springs.inclined.stiffness: =eta^2*k_x"},
    {"sphere.coupling_stiffness", "substructures.NAME.springs.inclined.stiffness"},
    {"sphere.angle", "substructures.NAME.springs.inclined.direction: =-alpha"},
    {"sphere.damping_x", "substructures.NAME.springs.horizontal.damping: =2*xi_x*k_x/omega_x"},
    {"sphere.damper_x", "substructures.NAME.springs.horizontal.damping"},
    {"sphere.damping_y", "substructures.NAME.springs.vertical.damping: =2*xi_y*k_x/omega_x"},
    {"sphere.damper_y", "substructures.NAME.springs.vertical.damping"},
    {"contact_law", "contact.normal.form"},
    {"friction_normal_force", "contact.friction.viscoelastic"},
    {"regularisation.law", "contact.friction.regularisation.law"},
    {"regularisation.speed", "contact.friction.regularisation.speed, in m/s"},
    {"small_motion", "terms: [gyroscopic, friction, geometric] for undamped"},
    {"time.step", "time.step, in s"},
    {"time.end", "time.end, in s: =500/omega_x for 500"},
    {"time.record_interval", "record.interval, in s"},
    {"time.settle", "cycle.settle, in s"},
    {"time.initial_indentation", "initial.indentation, with initial.state: equilibrium"}};

/// Key paths of all values, `expect` apart.
void collect_paths(const SceneNode& node, const std::string& path,
                   std::vector<std::string>& paths) {
  if (node.kind != SceneNode::Kind::map || node.entries.empty()) {
    paths.push_back(path);
    return;
  }
  for (const SceneEntry& entry : node.entries) {
    if (path.empty() && (entry.key == "expect" || entry.key == "parameters")) continue;
    collect_paths(entry.value, join_path(path, entry.key), paths);
  }
}

using Problems = std::vector<Problem>;

void add_sphere(const SceneNode& tree, Problems& problems) {
  std::vector<std::string> paths;
  collect_paths(tree, "", paths);
  for (const std::string& path : paths) {
    const auto* const former = std::find_if(std::begin(former_keys), std::end(former_keys),
                                            [&](const FormerKey& one) { return path == one.path; });
    if (former != std::end(former_keys)) {
      problems.push_back({Refusal::former_format, path, fmt::format("is now {}", former->now)});
    } else if (path.starts_with("sphere")) {
      problems.push_back({Refusal::former_format, path, "is no longer read"});
    }
  }
  problems.push_back({Refusal::former_format, "sphere",
                      "is no longer a kind of scene of its own: a sphere on a substrate is a "
                      "`lumped` body on the master `half_space` (docs/format_2.md; "
                      "scenes/viscoelastic_sphere.yaml)"});
}

/// docs/format_2.md, "Disc and pads". UPPER stands for each of the two pads and its contact.
constexpr FormerKey former_keys_of_discs[] = {
    {"disc", "substructures.disc, of type annular_plate, with the same keys"},
    {"disc.speed", "substructures.disc.spin"},
    {"pads.mass",
     "substructures.UPPER: {type: lumped, directions: [x, y, z], masses: {block: {mass}}}"},
    {"pads.stiffness", "substructures.UPPER.springs.backing: {at: block, stiffness: {xx, yy, zz, "
                       "xy}}; of an elastic pad {on: top, stiffness: ...}"},
    {"pads.stiffness.circumferential", "substructures.UPPER.springs.backing.stiffness.xx"},
    {"pads.stiffness.normal", "substructures.UPPER.springs.backing.stiffness.yy"},
    {"pads.stiffness.radial", "substructures.UPPER.springs.backing.stiffness.zz"},
    {"pads.stiffness.coupling", "substructures.UPPER.springs.backing.stiffness.xy"},
    {"pads.elastic",
     "substructures.UPPER: {type: beam, angle: 0, across: rigid, ...}, with the same keys"},
    {"pads.damping", "substructures.UPPER.damping"},
    {"pads.radius", "contacts.UPPER.start.radius"},
    {"pads.angle", "contacts.UPPER.start.angle"},
    {"pads.piston.force", "a drive with load, on UPPER.top or UPPER.block, with a minus"},
    {"pads.piston.displacement", "a drive with displacement, of UPPER.backing, with a minus"},
    {"contact.preload", "contacts.UPPER.normal.preload, of each of its points"},
    {"contact.friction", "contacts.UPPER.friction"},
    {"contact.formulation",
     "contacts.UPPER.normal.law: multiplier for lagrange, penalty for penalty"},
    {"contact.penalty", "contacts.UPPER.normal.stiffness, of law: penalty"},
    {"contact.offsets", "substructures.UPPER.points, on the surface bottom, and a list of them as "
                        "contacts.UPPER.slave"}};

/// The longest former key that a path begins with.
const FormerKey* former_key_of(const std::string& path) {
  const FormerKey* best = nullptr;
  std::size_t longest = 0;
  for (const FormerKey& one : former_keys_of_discs) {
    const std::string_view key = one.path;
    const bool is_prefix =
        path.starts_with(key) && (path.size() == key.size() || path[key.size()] == '.');
    if (!is_prefix || key.size() <= longest) continue;
    longest = key.size();
    best = &one;
  }
  return best;
}

void add_disc(const SceneNode& tree, Problems& problems) {
  std::vector<std::string> paths;
  collect_paths(tree, "", paths);
  for (const std::string& path : paths) {
    const FormerKey* const former = former_key_of(path);
    if (former == nullptr) continue;
    const std::string rest = path.substr(std::string_view(former->path).size());
    problems.push_back({Refusal::former_format, path,
                        rest.empty()
                            ? fmt::format("is now {}", former->now)
                            : fmt::format("is now `{}` of {}", rest.substr(1), former->now)});
  }
  problems.push_back({Refusal::former_format, "disc",
                      "is no longer a kind of scene of its own: a disc is a body of type "
                      "annular_plate, and pads are bodies in contact with its faces "
                      "(docs/format_2.md; scenes/disc_and_pads.yaml)"});
}

/// docs/format_2.md, "Sliding contact on rubber".
constexpr std::pair<const char*, const char*> former_sections[] = {
    {"material", "contacts.NAME.normal.material"},
    {"profile", "contacts.NAME.normal.profile"},
    {"contact_solver", "contacts.NAME.normal.solver"}};

void add_sliding_contact(const SceneNode& tree, Problems& problems) {
  std::string first;
  for (const auto& [section, now] : former_sections) {
    const SceneEntry* const entry = tree.entry(section);
    if (entry == nullptr) continue;
    if (first.empty()) first = section;
    std::vector<std::string> paths;
    collect_paths(entry->value, section, paths);
    for (const std::string& path : paths) {
      problems.push_back(
          {Refusal::former_format, path,
           fmt::format("is now {}{}", now, path.substr(std::string(section).size()))});
    }
  }
  if (first.empty()) return;
  problems.push_back({Refusal::former_format, first,
                      "is no longer of a kind of scene of its own: NAME is a contact with `master: "
                      "half_space` and `normal: {law: viscoelastic, form: solve}` "
                      "(docs/format_2.md; scenes/viscoelastic_contact.yaml)"});
}

/// Keys of a body of type `matrices`; docs/format_2.md, "Matrices with factors".
constexpr FormerKey former_keys_of_matrices[] = {
    {"factors.damping", "terms: [{role: damping, matrix: ..., factor: ...}], for `damping`"},
    {"factors.gyroscopic",
     "terms: [{role: gyroscopic, matrix: ..., factor: ...}], for `gyroscopic`"},
    {"factors.stiffness", "terms: [{role: stiffness, matrix: ..., factor: ...}], for `stiffness`"},
    {"factors.circulatory",
     "terms: [{role: circulatory, matrix: ..., factor: ...}], for `circulatory`"},
    {"load",
     "a parameter of the scene, `parameters: {load: ...}`, of which factors are expressions"},
    {"load_damping", "terms: [{role: velocity, matrix: ..., factor: =load}]"},
    {"load_stiffness", "terms: [{role: position, matrix: ..., factor: =load}]"}};

void add_matrices(const SceneNode& bodies, Problems& problems) {
  for (const SceneEntry& body : bodies.entries) {
    const SceneEntry* const type = body.value.entry("type");
    if (type == nullptr || type->value.text != "matrices") continue;
    for (const char* const section : {"factors", "load", "load_damping", "load_stiffness"}) {
      const SceneEntry* const entry = body.value.entry(section);
      if (entry == nullptr) continue;
      std::vector<std::string> paths;
      collect_paths(entry->value, section, paths);
      for (const std::string& path : paths) {
        const auto* const former =
            std::find_if(std::begin(former_keys_of_matrices), std::end(former_keys_of_matrices),
                         [&](const FormerKey& one) { return path == one.path; });
        const bool is_known = former != std::end(former_keys_of_matrices);
        problems.push_back(
            {Refusal::former_format, join_path("substructures." + body.key, path),
             is_known ? fmt::format("is now {}", former->now) : std::string("is no longer read")});
      }
    }
  }
}

}  // namespace

void refuse_former_keys(const SceneNode& tree) {
  Problems problems;
  if (const SceneEntry* const bodies = tree.entry("substructures")) {
    add_matrices(bodies->value, problems);
  } else {
    if (tree.entry("sphere") != nullptr) add_sphere(tree, problems);
    if (tree.entry("disc") != nullptr) add_disc(tree, problems);
    add_sliding_contact(tree, problems);
  }
  const SceneEntry* const format = tree.entry("format");
  if (format != nullptr && format->value.text == "1") {
    problems.push_back(
        {Refusal::former_format, "format",
         fmt::format("1 is no longer read; {}, and write `format: 2` "
                     "(docs/format_2.md lists every key that has moved)",
                     problems.empty() ? "all keys of this scene stand where they did: try it"
                                      : "move the keys that are named")});
  }
  if (problems.empty()) return;
  locate(problems, tree);
  sort_by_place(problems);
  throw ConfigError(std::move(problems));
}

}  // namespace stridor
