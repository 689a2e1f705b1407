#include "substructures/bodies/matrix_body.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/errors.hpp"
#include "core/suggestion.hpp"
#include "substructures/reduction/proportional_damping.hpp"

namespace stridor {
namespace {

std::string listed(const std::map<std::string, MatrixPointParameters>& points) {
  std::vector<std::string> names;
  names.reserve(points.size());
  for (const auto& entry : points) names.push_back(entry.first);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// An unknown counted from 1, or `held`.
int dof_of(std::int64_t number, Eigen::Index num_dofs, const std::string& key) {
  if (number > num_dofs) {
    throw ConfigError(
        key, fmt::format("there is no unknown {}: the matrices have {}", number, num_dofs));
  }
  return static_cast<int>(number) - 1;
}

}  // namespace

bool is_of_velocity(MatrixRole role) {
  return role == MatrixRole::damping || role == MatrixRole::gyroscopic ||
         role == MatrixRole::velocity;
}

const Schema& MatrixTermParameters::schema() {
  using P = MatrixTermParameters;
  static const Schema keys =
      SchemaOf<P>("matrix_term")
          .choice(
              "role", &P::role,
              {{"damping", MatrixRole::damping},
               {"gyroscopic", MatrixRole::gyroscopic},
               {"stiffness", MatrixRole::stiffness},
               {"circulatory", MatrixRole::circulatory},
               {"velocity", MatrixRole::velocity},
               {"position", MatrixRole::position}},
              {.doc = "What it adds to: damping, gyroscopic (skew-symmetric) or velocity (any) to "
                      "the matrix of velocities; stiffness, circulatory (skew-symmetric) or "
                      "position (any) to that of displacements."})
          .text_rows("matrix", &P::matrix,
                     {.doc = "The matrix: a Matrix Market file, from the folder of the scene, or a "
                             "list of rows, each a list or a text of numbers."})
          .real("factor", &P::factor,
                {.doc = "What it is multiplied with; to be varied, an expression of a parameter.",
                 .optional = true});
  return keys;
}

const Schema& MatrixBodyParameters::schema() {
  using P = MatrixBodyParameters;
  const auto matrix = [](const char* doc, bool is_optional) {
    return PlainKey{
        .doc = std::string(doc) +
               " A Matrix Market file, from the folder of the scene, or a list of rows, "
               "each a list or a text of numbers.",
        .optional = is_optional};
  };
  static const Schema keys =
      SchemaOf<P>("matrices")
          .text_rows("mass", &P::mass, matrix("Mass matrix, symmetric positive definite.", false))
          .text_rows("damping", &P::damping, matrix("Damping matrix.", true))
          .text_rows("gyroscopic", &P::gyroscopic,
                     matrix("Gyroscopic matrix, skew-symmetric.", true))
          .text_rows("stiffness", &P::stiffness,
                     matrix("Stiffness matrix; may be absent where a term says it.", true))
          .text_rows("circulatory", &P::circulatory,
                     matrix("Circulatory matrix, skew-symmetric.", true))
          .section_list("terms", &P::terms,
                        {.doc = "Matrices with factors, added to these.", .optional = true})
          .check([](const P& body, std::vector<Problem>& problems) {
            const bool has_position =
                std::any_of(body.terms.begin(), body.terms.end(),
                            [](const auto& term) { return !is_of_velocity(term.role); });
            if (!body.stiffness.empty() || has_position) return;
            problems.push_back({"stiffness",
                                "is missing; give it, or a term of the role stiffness or position",
                                {},
                                0,
                                0});
          });
  return keys;
}

const Schema& MatrixPointParameters::schema() {
  using P = MatrixPointParameters;
  static const Schema keys =
      SchemaOf<P>("matrix_point")
          .real_list("at", &P::at, {.doc = "Place in the frame of the body: x and y.", .unit = "m"})
          .integer("x", &P::x,
                   {.doc = "Number of the unknown that is its displacement in x, from 1; default "
                           "0: it is held there.",
                    .optional = true,
                    .range = Range::non_negative()})
          .integer("y", &P::y,
                   {.doc = "The same in y.", .optional = true, .range = Range::non_negative()})
          .check([](const P& point, std::vector<Problem>& problems) {
            if (point.at.size() != 2)
              problems.push_back({"at", "must be two lengths, x and y", {}, 0, 0});
          });
  return keys;
}

const Schema& MatrixSurfaceParameters::schema() {
  using P = MatrixSurfaceParameters;
  static const Schema keys =
      SchemaOf<P>("matrix_surface")
          .text_list("points", &P::points,
                     {.doc = "Names of at least two points, in the order in which the body lies on "
                             "the right-hand side."})
          .check([](const P& surface, std::vector<Problem>& problems) {
            if (surface.points.size() < 2)
              problems.push_back({"points", "must be at least two points", {}, 0, 0});
          });
  return keys;
}

const Schema& MatrixGuideParameters::schema() {
  using P = MatrixGuideParameters;
  static const Schema keys =
      SchemaOf<P>("matrix_guide")
          .integer("load", &P::load,
                   {.doc = "Number of the unknown on which the drive's load acts, from 1.",
                    .range = {1.0, 1e9, false, false}})
          .real_list("translation", &P::translation,
                     {.doc = "Displacement of every unknown as the body moves by one metre in +x: "
                             "1 for what is a displacement in x, 0 for one in y."});
  return keys;
}

const Schema& TouchedMatrixBodyParameters::schema() {
  using P = TouchedMatrixBodyParameters;
  static const Schema keys =
      SchemaOf<P>("touched_matrices")
          .include(&P::body)
          .named_sections("points", &P::points,
                          {.doc = "Points that touch others, carry a surface or are recorded.",
                           .optional = true})
          .named_sections("surfaces", &P::surfaces,
                          {.doc = "Outlines on which others slide.", .optional = true})
          .section("guided", &P::guided,
                   {.doc = "The drive moves the body: its unknowns are counted from a frame that "
                           "moves along.",
                    .optional = true})
          .section("reduction", &P::reduction,
                   {.doc = "Craig-Bampton reduction; default: every unknown is kept.",
                    .optional = true});
  return keys;
}

SparseSystem sum(const NamedMatrices& matrices, const MatrixBodyParameters& body) {
  SparseSystem system;
  system.mass = matrices.mass;
  system.velocity = matrices.damping + matrices.gyroscopic;
  system.position = matrices.stiffness + matrices.circulatory;
  for (std::size_t i = 0; i < body.terms.size(); ++i) {
    SparseMatrix& to = is_of_velocity(body.terms[i].role) ? system.velocity : system.position;
    const SparseMatrix before = to;
    to = before + body.terms[i].factor * matrices.terms.at(i);
  }
  return system;
}

BodyMatrices make_matrix_body(const TouchedMatrixBodyParameters& parameters) {
  if (!parameters.matrices)
    throw std::invalid_argument("make_matrix_body: the matrices have not been read");
  const SparseSystem system = sum(*parameters.matrices, parameters.body);
  const Eigen::Index n = system.size();
  BodyMatrices body;
  body.mass = system.mass;
  const SparseMatrix transposed = system.position.transpose();
  body.stiffness = 0.5 * (system.position + transposed);
  const SparseMatrix skew = 0.5 * (system.position - transposed);
  const std::optional<RayleighDamping> damping =
      proportional_damping(system.velocity, body.mass, body.stiffness);
  if (damping) body.damping = *damping;
  if (!damping || skew.norm() > 0.0) {
    body.velocity = damping ? SparseMatrix(n, n) : system.velocity;
    body.circulatory = skew;
  }

  body.nodes.resize(static_cast<Eigen::Index>(parameters.points.size()), 3);
  for (const auto& [name, point] : parameters.points) {
    const auto node = static_cast<int>(body.node_dofs.size());
    const std::string key = "points." + name;
    body.nodes.row(node) << point.at[0], point.at[1], 0.0;
    body.node_dofs.push_back({dof_of(point.x, n, key + ".x"), dof_of(point.y, n, key + ".y")});
    body.points[name] = node;
  }
  for (const auto& [name, surface] : parameters.surfaces) {
    const std::string key = "surfaces." + name + ".points";
    if (body.points.contains(name))
      throw ConfigError("surfaces." + name, "a point has this name already; take another");
    std::vector<int> nodes;
    for (const std::string& point : surface.points) {
      const auto found = body.points.find(point);
      if (found == body.points.end()) {
        std::vector<std::string> names;
        for (const auto& entry : body.points) names.push_back(entry.first);
        throw ConfigError(key, fmt::format("there is no point '{}'{} (there are: {})", point,
                                           did_you_mean(point, names), listed(parameters.points)));
      }
      if (!nodes.empty() &&
          !((body.nodes.row(nodes.back()) - body.nodes.row(found->second)).norm() > 0.0)) {
        throw ConfigError(key, fmt::format("'{}' stands where the point before it does", point));
      }
      nodes.push_back(found->second);
    }
    body.surfaces[name] = nodes;
  }
  if (!parameters.guided) return body;
  const MatrixGuideParameters& guide = *parameters.guided;
  body.load_dof = dof_of(guide.load, n, "guided.load");
  if (static_cast<Eigen::Index>(guide.translation.size()) != n) {
    throw ConfigError("guided.translation",
                      fmt::format("has {} numbers, expected one for each of the {} unknowns",
                                  guide.translation.size(), n));
  }
  body.base_inertia = body.mass * Eigen::Map<const Eigen::VectorXd>(guide.translation.data(), n);
  return body;
}

void TouchedMatrixBodyParameters::read(const BodyFiles& files) {
  matrices = std::make_shared<const NamedMatrices>(read_matrices(body, files));
}

bool TouchedMatrixBodyParameters::take_contents(const BodyParameters& other) {
  const auto* given = dynamic_cast<const TouchedMatrixBodyParameters*>(&other);
  if (given == nullptr || !given->matrices || !have_same_matrices(given->body, body)) return false;
  matrices = given->matrices;
  return true;
}

BodyMatrices TouchedMatrixBodyParameters::make() const {
  return make_matrix_body(*this);
}

std::optional<int> TouchedMatrixBodyParameters::num_modes() const {
  if (!reduction) return std::nullopt;
  return reduction->fixed_interface_modes;
}

double TouchedMatrixBodyParameters::num_slave_nodes(const std::string& name) const {
  const auto surface = surfaces.find(name);
  return surface == surfaces.end() ? 1.0 : static_cast<double>(surface->second.points.size());
}

ReductionSize TouchedMatrixBodyParameters::reduction_size(double interface_nodes) const {
  ReductionSize size;
  if (!matrices || !reduction) return size;
  const auto n = static_cast<double>(matrices->mass.rows());
  auto entries = static_cast<double>(matrices->stiffness.nonZeros());
  for (std::size_t i = 0; i < matrices->terms.size(); ++i) {
    if (!is_of_velocity(body.terms[i].role))
      entries += static_cast<double>(matrices->terms[i].nonZeros());
  }
  size.interface = size.watched = std::min(2.0 * interface_nodes, n);
  size.unknowns = n - size.interface;
  size.modes = reduction->fixed_interface_modes;
  size.matrix_entries = static_cast<double>(matrices->mass.nonZeros()) + entries;
  // As of a solid body under nested dissection.
  size.factor_entries =
      std::max(0.5 * entries, std::min(0.5 * n * n, 4.0 * std::pow(n, 4.0 / 3.0)));
  return size;
}

SizeKey TouchedMatrixBodyParameters::size_key() const {
  return {".mass", "give smaller matrices, or fewer points"};
}

}  // namespace stridor
