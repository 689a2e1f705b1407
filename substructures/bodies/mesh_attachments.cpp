#include "substructures/bodies/mesh_attachments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "substructures/bodies/mesh_surface_parameters.hpp"

namespace stridor {
namespace {

void add_problem(std::vector<Problem>& problems, Refusal refusal, const char* key,
                 std::string text) {
  problems.push_back({refusal, key, std::move(text)});
}

void expect_names(const std::vector<std::string>& on, const char* what,
                  std::vector<Problem>& problems) {
  if (on.empty())
    add_problem(problems, Refusal::missing, "on", fmt::format("must name a {}", what));
}

template <std::size_t n>
bool is_one_of(const std::string& word, const std::array<std::string_view, n>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

constexpr std::array<std::string_view, 3> cartesian{"x", "y", "z"};
constexpr std::array<std::string_view, 3> cylindrical{"radial", "tangential", "axial"};
constexpr std::array<std::string_view, 3> rotations{"rx", "ry", "rz"};

}  // namespace

const Schema& MeshSupportParameters::schema() {
  using P = MeshSupportParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_support")
          .text_list("on", &P::on, {.doc = "Surfaces, node sets or rigid regions that are held."})
          .text_list("held", &P::held,
                     {.doc = "Directions in which they are: x, y, z; or radial, tangential, axial "
                             "about a line; of a rigid region also its rotations rx, ry, rz. "
                             "Default: all.",
                      .optional = true})
          .section("about", &P::about,
                   {.doc = "The line of radial, tangential and axial; default: z of the mesh.",
                    .optional = true})
          .check([](const P& support, std::vector<Problem>& problems) {
            bool is_straight = false;
            bool is_round = false;
            for (const std::string& direction : support.held) {
              const bool of_line = is_one_of(direction, cylindrical);
              if (!of_line && !is_one_of(direction, cartesian) && !is_one_of(direction, rotations))
                add_problem(problems, Refusal::wrong_value, "held",
                            fmt::format("'{}' is no direction: x, y, z, radial, tangential, axial, "
                                        "or rx, ry, rz of a rigid region",
                                        direction));
              is_round |= of_line;
              is_straight |= !of_line;
            }
            if (is_round && is_straight)
              add_problem(problems, Refusal::contradiction, "held",
                          "has directions about a line beside others; make two supports");
            if (support.about && !is_round)
              add_problem(problems, Refusal::contradiction, "about",
                          "is not used: no direction is radial, tangential or axial");
            expect_names(support.on, "surface, node set or rigid region", problems);
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
            expect_names(guide.on, "surface or node set", problems);
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
          .flag("rotation", &P::rotation,
                {.doc = "Of `mean_of`: whether <point>_rotation is a point too, whose "
                        "displacements along x, y and z are the mean rotations about them, in rad.",
                 .optional = true})
          .check([](const P& point, std::vector<Problem>& problems) {
            const auto superfluous = [&](const char* key) {
              add_problem(problems, Refusal::contradiction, key,
                          "is not used: the point is given already; leave one of them out");
            };
            const bool is_placed = !point.at.empty();
            if (point.node && is_placed) superfluous("node");
            if (!point.mean_of.empty() && (point.node || is_placed)) superfluous("mean_of");
            if (!is_placed && !point.node && point.mean_of.empty())
              add_problem(problems, Refusal::missing, "at",
                          "is missing; give it, `node` or `mean_of`");
            if (point.rotation && point.mean_of.empty())
              add_problem(problems, Refusal::contradiction, "rotation", "goes with `mean_of`");
            expect_components(point.at, "at", true, problems);
          });
  return keys;
}

const Schema& MeshRigidRegionParameters::schema() {
  using P = MeshRigidRegionParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_rigid_region")
          .text_list("on", &P::on,
                     {.doc = "Surfaces or node sets that move as one rigid body. The region is a "
                             "point of its name, and <name>_rotation is one whose displacements "
                             "are the rotations about x, y and z, in rad."})
          .real_list("at", &P::at,
                     {.doc = "Place of the point, in the frame of the mesh; default: the mean of "
                             "the nodes.",
                      .unit = "m",
                      .optional = true})
          .check([](const P& region, std::vector<Problem>& problems) {
            expect_names(region.on, "surface or node set", problems);
            expect_components(region.at, "at", true, problems);
          });
  return keys;
}

const Schema& MeshTieParameters::schema() {
  using P = MeshTieParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_tie")
          .text("slave", &P::slave,
                {.doc = "A surface, the nodes of which move as the faces of the other one do. They "
                        "are moved onto these faces."})
          .text("master", &P::master,
                {.doc = "A surface; best that of the coarser mesh or the stiffer part."})
          .real("tolerance", &P::tolerance,
                {.doc = "Distance up to which a node is tied; default: 5 % of the size of a face.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true})
          .flag("partial", &P::partial,
                {.doc = "Whether nodes of the slave that are off the master stay free; else they "
                        "are refused.",
                 .optional = true})
          .check([](const P& tie, std::vector<Problem>& problems) {
            if (tie.slave == tie.master)
              add_problem(problems, Refusal::wrong_value, "master",
                          "must be another surface than the slave");
          });
  return keys;
}

const Schema& MeshMassParameters::schema() {
  using P = MeshMassParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_mass")
          .text("on", &P::on, {.doc = "A point or rigid region."})
          .real("mass", &P::mass,
                {.doc = "Mass at the point.", .unit = "kg", .range = Range::non_negative()})
          .real_list("inertia", &P::inertia,
                     {.doc = "At a rigid region: moment of inertia about z of a planar body, else "
                             "those about x, y and z, about the point of the region.",
                      .unit = "kg m2",
                      .range = Range::non_negative(),
                      .optional = true})
          .check([](const P& given, std::vector<Problem>& problems) {
            if (!given.inertia.empty() && given.inertia.size() != 1 && given.inertia.size() != 3)
              add_problem(problems, Refusal::wrong_value, "inertia",
                          "must be one number, or three");
            if (given.mass == 0.0 && given.inertia.empty())
              add_problem(problems, Refusal::wrong_value, "mass",
                          "must not be zero without an inertia");
          });
  return keys;
}

const Schema& MeshLoadParameters::schema() {
  using P = MeshLoadParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_load")
          .text_list("on", &P::on,
                     {.doc = "Surfaces, over which the load is even. A drive that names "
                             "<body>.<load> in its load_on scales it: pressure or traction times "
                             "area."})
          .real_list("direction", &P::direction,
                     {.doc = "Of the traction, in the frame of the mesh, of any length; default: "
                             "against the normals, a pressure.",
                      .optional = true})
          .check([](const P& load, std::vector<Problem>& problems) {
            expect_names(load.on, "surface", problems);
            expect_components(load.direction, "direction", true, problems);
            if (!load.direction.empty() && !(in_space(load.direction).norm() > 0.0))
              add_problem(problems, Refusal::wrong_value, "direction", "must not be zero");
          });
  return keys;
}

}  // namespace stridor
