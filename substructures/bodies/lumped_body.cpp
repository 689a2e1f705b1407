#include "substructures/bodies/lumped_body.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.hpp"
#include "core/suggestion.hpp"
#include "substructures/reduction/proportional_damping.hpp"

namespace stridor {
namespace {

std::vector<std::string> mass_names(const std::map<std::string, LumpedMassParameters>& masses) {
  std::vector<std::string> names;
  names.reserve(masses.size());
  for (const auto& entry : masses) names.push_back(entry.first);
  return names;
}

constexpr std::array axis_names{"x", "y", "z"};

bool moves_along(const LumpedParameters& body, const std::string& direction) {
  return std::find(body.directions.begin(), body.directions.end(), direction) !=
         body.directions.end();
}

Eigen::Vector3d place_of(const LumpedMassParameters& mass) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < mass.at.size(); ++i) place(static_cast<Eigen::Index>(i)) = mass.at[i];
  return place;
}

/// Node of a mass, in the order of their names.
int node_of(const LumpedParameters& body, const std::string& name, const std::string& key) {
  const auto found = body.masses.find(name);
  if (found != body.masses.end())
    return static_cast<int>(std::distance(body.masses.begin(), found));
  const std::vector<std::string> names = mass_names(body.masses);
  throw ConfigError(Refusal::unknown_name, key,
                    fmt::format("there is no mass '{}'{} (there are: {})", name,
                                did_you_mean(name, names), fmt::join(names, ", ")));
}

/// Adds springs and dampers to the matrices of a body.
class SpringAssembly {
 public:
  SpringAssembly(const LumpedParameters& parameters, BodyMatrices& body)
      : parameters_(parameters), body_(body) {}

  void add(const std::string& name, const LumpedSpringParameters& spring) {
    const std::string key = "springs." + name;
    std::vector<int> nodes;
    for (const std::string& mass : spring.at)
      nodes.push_back(node_of(parameters_, mass, key + ".at"));
    if (nodes.size() == 2 && nodes[0] == nodes[1])
      throw ConfigError(Refusal::wrong_size, key + ".at",
                        "must be two different masses, or one to the ground");
    const bool is_along =
        spring.stiffness.along || (spring.damping && spring.damping->along);
    const Eigen::Vector3d along =
        is_along ? direction(spring, key) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    const Eigen::Matrix3d stiffness = spring_matrix(spring.stiffness, along);
    add_to(stiffness_, nodes, stiffness);
    if (spring.damping) add_to(damping_, nodes, spring_matrix(*spring.damping, along));
    const Eigen::Vector3d place = body_.nodes.row(nodes.front());
    if (nodes.size() == 2) {
      body_.springs.push_back({place, Eigen::Vector3d(body_.nodes.row(nodes[1])), along});
      return;
    }
    add_ground_end(name, nodes.front(), stiffness);
    for (const Eigen::Vector3d& seen : spring_directions(spring.stiffness, along))
      body_.springs.push_back({place, std::nullopt, seen});
  }

  SparseMatrix stiffness() const { return assembled(stiffness_); }
  SparseMatrix damping() const { return assembled(damping_); }

 private:
  using Triplets = std::vector<Eigen::Triplet<double>>;

  Eigen::Vector3d direction(const LumpedSpringParameters& spring, const std::string& key) const {
    if (spring.direction) return spring.direction->unit();
    if (spring.at.size() == 1) return Eigen::Vector3d::UnitX();
    const Eigen::Vector3d along = place_of(parameters_.masses.at(spring.at[1])) -
                                  place_of(parameters_.masses.at(spring.at[0]));
    if (along.norm() > 0.0) return along.normalized();
    throw ConfigError(Refusal::missing, key + ".direction",
                      "missing: the two masses stand at one place, so that no line joins them");
  }

  /// Adds B k Bᵀ.
  void add_to(Triplets& triplets, const std::vector<int>& nodes, const Eigen::Matrix3d& matrix) {
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      for (std::size_t b = 0; b < nodes.size(); ++b) {
        const double sign = a == b ? 1.0 : -1.0;
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            const double entry = matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
            if (entry == 0.0) continue;
            for (const DofWeight& row : body_.displacement(nodes[a], i)) {
              for (const DofWeight& column : body_.displacement(nodes[b], j))
                triplets.emplace_back(row.dof, column.dof, sign * entry);
            }
          }
        }
      }
    }
  }

  /// Forces of the spring while its ground end moves by 1 m in each direction.
  void add_ground_end(const std::string& name, int node, const Eigen::Matrix3d& stiffness) {
    for (std::size_t moved = 0; moved < 3; ++moved) {
      DofSum& load = body_.loads[name + "." + axis_names[moved]];
      for (std::size_t i = 0; i < 3; ++i) {
        const double force =
            stiffness(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(moved));
        if (force == 0.0) continue;
        for (const DofWeight& dof : body_.displacement(node, i))
          load.push_back({dof.dof, force * dof.weight});
      }
    }
  }

  SparseMatrix assembled(const Triplets& triplets) const {
    SparseMatrix matrix(body_.mass.rows(), body_.mass.cols());
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    return matrix;
  }

  const LumpedParameters& parameters_;
  BodyMatrices& body_;
  Triplets stiffness_, damping_;
};

void check_directions(const LumpedParameters& body, std::vector<Problem>& problems) {
  const std::vector<std::string>& given = body.directions;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const bool is_known = std::find(axis_names.begin(), axis_names.end(), given[i]) !=
                          axis_names.end();
    const auto here = given.begin() + static_cast<std::ptrdiff_t>(i);
    if (is_known && std::find(given.begin(), here, given[i]) == here) continue;
    problems.push_back({Refusal::wrong_value, fmt::format("directions.{}", i),
                        fmt::format("expected x, y or z, each once, got '{}'", given[i])});
  }
  if (given.empty())
    problems.push_back({Refusal::missing, "directions", "is empty; name some of x, y and z"});
  if (body.masses.empty())
    problems.push_back({Refusal::missing, "masses", "is empty; a body needs one"});
}

}  // namespace

const Schema& LumpedMassParameters::schema() {
  using P = LumpedMassParameters;
  static const Schema keys =
      SchemaOf<P>("lumped_mass")
          .real("mass", &P::mass, {.doc = "Mass.", .unit = "kg", .range = Range::positive()})
          .real_list("at", &P::at,
                     {.doc = "Place in the frame of the body: x and y, or x, y and z; default: its "
                             "origin.",
                      .unit = "m",
                      .optional = true})
          .check([](const P& mass, std::vector<Problem>& problems) {
            if (!mass.at.empty() && mass.at.size() != 2 && mass.at.size() != 3)
              problems.push_back(
                  {Refusal::wrong_size, "at", "must be two or three lengths: x, y and z"});
          });
  return keys;
}

const Schema& LumpedSpringParameters::schema() {
  using P = LumpedSpringParameters;
  static const Schema keys =
      SchemaOf<P>("lumped_spring")
          .text_list("at", &P::at,
                     {.doc = "A mass, which the spring joins to the ground, or a list of two."})
          .section("stiffness", &P::stiffness,
                   {.doc = "A number, along the direction of the spring, or a matrix.",
                    .number_key = "along"})
          .section("damping", &P::damping,
                   {.doc = "Of a damper beside it, likewise.",
                    .optional = true,
                    .number_key = "along"})
          .section("direction", &P::direction,
                   {.doc = "Of the spring: an angle in the plane against +x, or a vector; default: "
                           "the line between its two masses, x to the ground.",
                    .optional = true,
                    .number_key = "angle",
                    .list_key = "vector"})
          .check([](const P& spring, std::vector<Problem>& problems) {
            if (spring.at.size() != 1 && spring.at.size() != 2)
              problems.push_back({Refusal::wrong_value, "at", "must be one mass or two"});
            if (spring.direction && !spring.stiffness.along &&
                !(spring.damping && spring.damping->along)) {
              problems.push_back({Refusal::contradiction, "direction",
                                  "is not used: this stiffness is a matrix, which has its "
                                  "directions in itself"});
            }
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
          .text_list("directions", &P::directions,
                     {.doc = "In which the masses move, of x, y and z; they are held in others.",
                      .optional = true})
          .section("damping", &P::damping,
                   {.doc = "Proportional damping, besides that of the springs.", .optional = true})
          .text("guided", &P::guided,
                {.doc = "A mass on which the drive's load acts in +y; the drive then moves the "
                        "ground of all springs in +x.",
                 .optional = true})
          .check(check_directions);
  return keys;
}

BodyMatrices LumpedParameters::make() const {
  BodyMatrices body;
  body.nodes.resize(static_cast<Eigen::Index>(masses.size()), 3);
  std::vector<double> mass_of_dof;
  for (const auto& [name, mass] : masses) {
    const auto node = static_cast<int>(body.node_dofs.size());
    body.nodes.row(node) = place_of(mass).transpose();
    body.points[name] = node;
    std::array<int, 3> dofs{BodyMatrices::held, BodyMatrices::held, BodyMatrices::held};
    for (std::size_t i = 0; i < 3; ++i) {
      if (!moves_along(*this, axis_names[i])) continue;
      dofs[i] = static_cast<int>(mass_of_dof.size());
      mass_of_dof.push_back(mass.mass);
    }
    body.node_dofs.push_back({dofs[0], dofs[1]});
    if (moves_along(*this, "z")) body.across.push_back(dofs[2]);
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
    throw ConfigError(Refusal::missing, "guided",
                      "needs a mass that moves in y, on which the load acts");
  body.base_inertia = Eigen::VectorXd::Zero(n);
  for (const auto& dofs : body.node_dofs) {
    if (dofs[0] != BodyMatrices::held)
      body.base_inertia(dofs[0]) = mass_of_dof[static_cast<std::size_t>(dofs[0])];
  }
  return body;
}

}  // namespace stridor
