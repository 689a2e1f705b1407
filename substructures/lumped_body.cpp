#include "substructures/lumped_body.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/suggestion.hpp"
#include "substructures/proportional_damping.hpp"

namespace stridor {
namespace {

std::vector<std::string> names_of(const std::map<std::string, LumpedMassParameters>& masses) {
  std::vector<std::string> names;
  names.reserve(masses.size());
  for (const auto& entry : masses) names.push_back(entry.first);
  return names;
}

bool moves_along(const LumpedParameters& body, const char* direction) {
  return std::find(body.moves.begin(), body.moves.end(), direction) != body.moves.end();
}

Eigen::Vector2d place_of(const LumpedMassParameters& mass) {
  return mass.at.empty() ? Eigen::Vector2d(0.0, 0.0) : Eigen::Vector2d(mass.at[0], mass.at[1]);
}

/// Node of a mass, in the order of their names.
int node_of(const LumpedParameters& body, const std::string& name, const std::string& key) {
  const auto found = body.masses.find(name);
  if (found != body.masses.end())
    return static_cast<int>(std::distance(body.masses.begin(), found));
  const std::vector<std::string> names = names_of(body.masses);
  throw ConfigError(key, fmt::format("there is no mass '{}'{} (there are: {})", name,
                                     did_you_mean(name, names), fmt::join(names, ", ")));
}

/// Adds the spring and the damper to the matrices of a body.
class SpringAssembly {
 public:
  SpringAssembly(const LumpedParameters& parameters, const BodyMatrices& body)
      : parameters_(parameters), body_(body) {}

  void add(const std::string& name, const LumpedSpringParameters& spring) {
    const std::string key = "springs." + name;
    std::vector<int> nodes;
    for (const std::string& mass : spring.at)
      nodes.push_back(node_of(parameters_, mass, key + ".at"));
    if (nodes.size() == 2 && nodes[0] == nodes[1])
      throw ConfigError(key + ".at", "must be two different masses, or one to the ground");
    const Eigen::Vector2d along = direction(spring, nodes, key);
    std::vector<std::pair<int, double>> entries;
    for (std::size_t end = 0; end < nodes.size(); ++end) {
      const auto& dofs = body_.node_dofs[static_cast<std::size_t>(nodes[end])];
      for (std::size_t i = 0; i < 2; ++i) {
        const double entry = (end == 0 ? 1.0 : -1.0) * along[static_cast<Eigen::Index>(i)];
        if (dofs[i] != BodyMatrices::held) entries.emplace_back(dofs[i], entry);
      }
    }
    for (const auto& [row, a] : entries) {
      for (const auto& [column, b] : entries) {
        stiffness_.emplace_back(row, column, spring.stiffness * a * b);
        damping_.emplace_back(row, column, spring.damping * a * b);
      }
    }
  }

  SparseMatrix stiffness() const { return assembled(stiffness_); }
  SparseMatrix damping() const { return assembled(damping_); }

 private:
  using Triplets = std::vector<Eigen::Triplet<double>>;

  Eigen::Vector2d direction(const LumpedSpringParameters& spring, const std::vector<int>& nodes,
                            const std::string& key) const {
    if (spring.direction) return {std::cos(*spring.direction), std::sin(*spring.direction)};
    if (nodes.size() == 1) return {1.0, 0.0};
    const Eigen::Vector2d along =
        (body_.nodes.row(nodes[1]) - body_.nodes.row(nodes[0])).transpose();
    if (along.norm() > 0.0) return along.normalized();
    throw ConfigError(key + ".direction",
                      "missing: the two masses stand at one place, so that no line joins them");
  }

  SparseMatrix assembled(const Triplets& triplets) const {
    SparseMatrix matrix(body_.mass.rows(), body_.mass.cols());
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    return matrix;
  }

  const LumpedParameters& parameters_;
  const BodyMatrices& body_;
  Triplets stiffness_, damping_;
};

void check_moves(const LumpedParameters& body, std::vector<Problem>& problems) {
  for (std::size_t i = 0; i < body.moves.size(); ++i) {
    const std::string& name = body.moves[i];
    const bool is_known = name == "x" || name == "y";
    const bool is_new = std::find(body.moves.begin(), body.moves.begin() + static_cast<long>(i),
                                  name) == body.moves.begin() + static_cast<long>(i);
    if (is_known && is_new) continue;
    problems.push_back({fmt::format("moves.{}", i),
                        fmt::format("expected x or y, each once, got '{}'", name),
                        {},
                        0,
                        0});
  }
  if (body.moves.empty()) problems.push_back({"moves", "is empty; name x, y or both", {}, 0, 0});
  if (body.masses.empty()) problems.push_back({"masses", "is empty; a body needs one", {}, 0, 0});
}

}  // namespace

const Schema& LumpedMassParameters::schema() {
  using P = LumpedMassParameters;
  static const Schema keys =
      SchemaOf<P>("lumped_mass")
          .real("mass", &P::mass, {.doc = "Mass.", .unit = "kg", .range = Range::positive()})
          .real_list("at", &P::at,
                     {.doc = "Place in the frame of the body, x and y; default: its origin.",
                      .unit = "m",
                      .optional = true})
          .check([](const P& mass, std::vector<Problem>& problems) {
            if (!mass.at.empty() && mass.at.size() != 2)
              problems.push_back({"at", "must be two lengths, x and y", {}, 0, 0});
          });
  return keys;
}

const Schema& LumpedSpringParameters::schema() {
  using P = LumpedSpringParameters;
  static const Schema keys =
      SchemaOf<P>("lumped_spring")
          .text_list("at", &P::at,
                     {.doc = "A mass, which the spring joins to the ground, or a list of two."})
          .real("stiffness", &P::stiffness,
                {.doc = "Along its direction.", .unit = "N m-1", .range = Range::non_negative()})
          .real("damping", &P::damping,
                {.doc = "Of a damper beside it.",
                 .unit = "N s m-1",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("direction", &P::direction,
                {.doc = "Angle of the spring against +x; default: the line between its two masses, "
                        "0 to the ground.",
                 .unit = "rad",
                 .optional = true})
          .check([](const P& spring, std::vector<Problem>& problems) {
            if (spring.at.size() != 1 && spring.at.size() != 2)
              problems.push_back({"at", "must be one mass or two", {}, 0, 0});
          });
  return keys;
}

const Schema& LumpedDampingParameters::schema() {
  using P = LumpedDampingParameters;
  static const Schema keys = SchemaOf<P>("lumped_damping")
                                 .real("alpha", &P::alpha,
                                       {.doc = "In proportion to the masses.",
                                        .unit = "s-1",
                                        .range = Range::non_negative(),
                                        .optional = true})
                                 .real("beta", &P::beta,
                                       {.doc = "In proportion to the stiffness of the springs.",
                                        .unit = "s",
                                        .range = Range::non_negative(),
                                        .optional = true});
  return keys;
}

const Schema& LumpedParameters::schema() {
  using P = LumpedParameters;
  static const Schema keys =
      SchemaOf<P>("lumped")
          .named_sections("masses", &P::masses,
                          {.doc = "Rigid masses by name, each also a point of the body."})
          .named_sections("springs", &P::springs,
                          {.doc = "Springs with dampers, by name.", .optional = true})
          .text_list("moves", &P::moves,
                     {.doc = "Directions in which the masses move: x, y or both; held in others.",
                      .optional = true})
          .section("damping", &P::damping,
                   {.doc = "Proportional damping, besides that of the springs.", .optional = true})
          .text("guided", &P::guided,
                {.doc = "A mass on which the drive's load acts in +y; the drive then moves the "
                        "ground of all springs in +x.",
                 .optional = true})
          .check(check_moves);
  return keys;
}

BodyMatrices LumpedParameters::make() const {
  BodyMatrices body;
  body.nodes.resize(static_cast<Eigen::Index>(masses.size()), 2);
  std::vector<double> mass_of_dof;
  for (const auto& [name, mass] : masses) {
    const auto node = static_cast<int>(body.node_dofs.size());
    body.nodes.row(node) = place_of(mass).transpose();
    body.points[name] = node;
    std::array<int, 2> dofs{BodyMatrices::held, BodyMatrices::held};
    for (std::size_t i = 0; i < 2; ++i) {
      if (!moves_along(*this, i == 0 ? "x" : "y")) continue;
      dofs[i] = static_cast<int>(mass_of_dof.size());
      mass_of_dof.push_back(mass.mass);
    }
    body.node_dofs.push_back(dofs);
  }
  const auto n = static_cast<Eigen::Index>(mass_of_dof.size());
  body.mass.resize(n, n);
  body.mass.reserve(Eigen::VectorXi::Ones(n));
  for (Eigen::Index i = 0; i < n; ++i)
    body.mass.insert(i, i) = mass_of_dof[static_cast<std::size_t>(i)];
  body.mass.makeCompressed();

  SpringAssembly springs_of(*this, body);
  for (const auto& [name, spring] : springs) springs_of.add(name, spring);
  body.stiffness = springs_of.stiffness();
  const SparseMatrix velocity =
      damping.alpha * body.mass + damping.beta * body.stiffness + springs_of.damping();
  if (const auto proportional = proportional_damping(velocity, body.mass, body.stiffness)) {
    body.damping = *proportional;
  } else {
    body.velocity = velocity;
    body.circulatory = SparseMatrix(n, n);
  }
  if (!guided) return body;

  const int node = node_of(*this, *guided, "guided");
  body.load_dof = body.node_dofs[static_cast<std::size_t>(node)][1];
  if (body.load_dof == BodyMatrices::held)
    throw ConfigError("guided", "needs a mass that moves in y, on which the load acts");
  body.base_inertia = Eigen::VectorXd::Zero(n);
  for (const auto& dofs : body.node_dofs) {
    if (dofs[0] != BodyMatrices::held)
      body.base_inertia(dofs[0]) = mass_of_dof[static_cast<std::size_t>(dofs[0])];
  }
  return body;
}

}  // namespace stridor
