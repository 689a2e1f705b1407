// Keys of bodies given by their matrices.
#include <algorithm>

#include "substructures/bodies/matrix_body.hpp"

namespace stridor {

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
               {"position", MatrixRole::position},
               {"structural", MatrixRole::structural}},
              {.doc = "What it adds to: damping, gyroscopic (skew-symmetric) or velocity (any) to "
                      "the matrix of velocities; stiffness, circulatory (skew-symmetric) or "
                      "position (any) to that of displacements; structural (symmetric) to the "
                      "imaginary part of a complex stiffness, by which every mode gets the viscous "
                      "damping of the same loss."})
          .text_rows("matrix", &P::matrix,
                     {.doc = "The matrix: a file, from the folder of the scene, or a list of rows, "
                             "each a list or a text of numbers."})
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
               " A file, from the folder of the scene (Matrix Market, CalculiX, Abaqus, "
               "Harwell-Boeing or Nastran DMIG), or a list of rows, each a list or a text of "
               "numbers.",
        .optional = is_optional};
  };
  static const Schema keys =
      SchemaOf<P>("matrices")
          .text_rows("mass", &P::mass, matrix("Mass matrix, symmetric positive semidefinite.", false))
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
                            [](const auto& term) {
                              return !is_of_velocity(term.role) &&
                                     term.role != MatrixRole::structural;
                            });
            if (!body.stiffness.empty() || has_position) return;
            problems.push_back(
                {Refusal::missing, "stiffness",
                 "is missing; give it, or a term of the role stiffness or position"});
          });
  return keys;
}

const Schema& MatrixNodesParameters::schema() {
  using P = MatrixNodesParameters;
  static const Schema keys =
      SchemaOf<P>("matrix_nodes")
          .text("unknowns", &P::unknowns,
                {.doc = "Which rows are which displacements of which nodes: a file .dof of CalculiX, "
                        ".mapping of ANSYS, or a table `node, direction` or `node, direction, x, y, "
                        "z` a line; or all_of_mesh: all displacements of all nodes of the mesh, "
                        "ascending. Matrices of Abaqus and Nastran say it themselves.",
                 .optional = true})
          .text("mesh", &P::mesh,
                {.doc = "A mesh that gives nodes their places, and surfaces and sets by name: Gmsh "
                        "(.msh) or Abaqus and CalculiX (.inp).",
                 .optional = true})
          .text("nodes", &P::nodes,
                {.doc = "A table of places, `node, x, y, z` a line, where there is no mesh.",
                 .optional = true})
          .text("length_unit", &P::length_unit,
                {.doc = "Unit of length of matrices, mesh and tables.", .optional = true})
          .text("force_unit", &P::force_unit,
                {.doc = "Unit of force of the matrices. With lengths in mm, N makes the unit of "
                        "mass a tonne.",
                 .optional = true})
          .text("time_unit", &P::time_unit,
                {.doc = "Unit of time of the matrices.", .optional = true});
  return keys;
}

const Schema& MatrixPointParameters::schema() {
  using P = MatrixPointParameters;
  static const Schema keys =
      SchemaOf<P>("matrix_point")
          .real_list("at", &P::at,
                     {.doc = "Place: x and y in the frame of the body; where nodes are known, as of "
                             "a mesh.",
                      .unit = "m",
                      .optional = true})
          .integer("x", &P::x,
                   {.doc = "Number of the unknown that is its displacement in x, from 1; default "
                           "0: it is held there.",
                    .optional = true,
                    .range = Range::non_negative()})
          .integer("y", &P::y,
                   {.doc = "The same in y.", .optional = true, .range = Range::non_negative()})
          .integer("node", &P::node,
                   {.doc = "Where nodes are known, in the place of the others: the number of a node.",
                    .optional = true})
          .text("mean_of", &P::mean_of,
                {.doc = "Likewise: a surface or node set, of which the point has the mean "
                        "displacement.",
                 .optional = true})
          .check([](const P& point, std::vector<Problem>& problems) {
            const bool is_of_nodes = point.node || !point.mean_of.empty();
            if (point.node && !point.mean_of.empty())
              problems.push_back({Refusal::contradiction, "mean_of",
                                  "is not used: the point is given already; leave it out"});
            if (is_of_nodes && (!point.at.empty() || point.x > 0 || point.y > 0)) {
              problems.push_back({Refusal::contradiction, point.node ? "node" : "mean_of",
                                  "is not used: the point is given already; leave it out"});
            }
            if (!is_of_nodes && point.at.empty())
              problems.push_back(
                  {Refusal::missing, "at", "is missing; give it, `node` or `mean_of`"});
            if (!point.at.empty() && point.at.size() != 2 && point.at.size() != 3)
              problems.push_back({Refusal::wrong_size, "at", "must be two or three lengths"});
          });
  return keys;
}

const Schema& MatrixSurfaceParameters::schema() {
  using P = MatrixSurfaceParameters;
  static const Schema keys =
      SchemaOf<P>("matrix_surface")
          .text_list("points", &P::points,
                     {.doc = "Names of at least two points, in the order in which the body lies on "
                             "the right-hand side.",
                      .optional = true})
          .section("plane", &P::plane,
                   {.doc = "Where nodes are known: what lies in a plane.", .optional = true})
          .section("cylinder", &P::cylinder, {.doc = "What lies on a cylinder.", .optional = true})
          .section("box", &P::box, {.doc = "What lies in a box.", .optional = true})
          .real("tolerance", &P::tolerance,
                {.doc = "Distance up to which nodes lie there; default: 1e-6 of the extent.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true})
          .check([](const P& surface, std::vector<Problem>& problems) {
            const bool is_region = surface.plane || surface.cylinder || surface.box;
            if (is_region && !surface.points.empty())
              problems.push_back(
                  {Refusal::contradiction, "points", "is not used beside a region; leave it out"});
            if (!is_region && surface.points.size() < 2)
              problems.push_back({Refusal::wrong_value, "points", "must be at least two points"});
          });
  return keys;
}

const Schema& MatrixGuideParameters::schema() {
  using P = MatrixGuideParameters;
  static const Schema keys =
      SchemaOf<P>("matrix_guide")
          .integer("load", &P::load,
                   {.doc = "Number of the unknown on which the drive's load acts, from 1.",
                    .optional = true,
                    .range = {0.0, 1e9, false, false}})
          .real_list("translation", &P::translation,
                     {.doc = "Displacement of every unknown as the body moves by one metre in +x: "
                             "1 for what is a displacement in x, 0 for one in y.",
                      .optional = true})
          .text_list("on", &P::on,
                     {.doc = "Where nodes are known, in the place of both: surfaces or node sets "
                             "that follow the drive along x, are held across, and share one "
                             "displacement along y, on which its load acts.",
                      .optional = true})
          .check([](const P& guide, std::vector<Problem>& problems) {
            const bool is_by_number = guide.load > 0 || !guide.translation.empty();
            if (is_by_number && !guide.on.empty())
              problems.push_back(
                  {Refusal::contradiction, "on", "is not used beside `load`; leave it out"});
            if (!guide.on.empty()) return;
            if (guide.load == 0)
              problems.push_back({Refusal::missing, "load", "is missing; give it, or `on`"});
            if (guide.translation.empty())
              problems.push_back({Refusal::missing, "translation", "is missing; give it, or `on`"});
          });
  return keys;
}

const Schema& TouchedMatrixBodyParameters::schema() {
  using P = TouchedMatrixBodyParameters;
  static const Schema keys =
      SchemaOf<P>("touched_matrices")
          .include(&P::body)
          .include(&P::nodes)
          .real("angle", &P::angle,
                {.doc = "By which the body is turned about z; where nodes are known.",
                 .unit = "rad",
                 .range = Range::between(-7.0, 7.0),
                 .optional = true})
          .named_sections("points", &P::points,
                          {.doc = "Points that touch others, carry a surface or are recorded.",
                           .optional = true})
          .named_sections("surfaces", &P::surfaces,
                          {.doc = "Outlines on which others slide, and parts of a mesh by where "
                                  "they are.",
                           .optional = true})
          .named_sections("supports", &P::supports,
                          {.doc = "What is held beyond what the matrices hold, by name; where nodes "
                                  "are known.",
                           .optional = true})
          .named_sections("springs", &P::springs,
                          {.doc = "Springs to the ground, by name; where nodes are known.",
                           .optional = true})
          .section("interface", &P::interface,
                   {.doc = "Surface nodes kept for contact.", .optional = true})
          .section("guided", &P::guided,
                   {.doc = "The drive moves the body: its unknowns are counted from a frame that "
                           "moves along.",
                    .optional = true})
          .section("reduction", &P::reduction,
                   {.doc = "Craig-Bampton reduction; default: every unknown is kept.",
                    .optional = true});
  return keys;
}

}  // namespace stridor
