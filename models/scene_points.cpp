#include "models/scene_points.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/suggestion.hpp"
#include "models/model_body.hpp"
#include "substructures/bodies/surface_springs.hpp"
#include "substructures/elements/mesh_point.hpp"
#include "substructures/reduction/recovery.hpp"

namespace stridor {
namespace {

constexpr double share_of_extent = 1e-6;

/// The elements of a body with its nodes, for places within them. Those of a plate are for figures
/// alone: its points have their rows from its modes.
Mesh mesh_of(const ModelBody& body) {
  Mesh mesh;
  mesh.nodes = node_places(body.matrices);
  if (!body.matrices.faces.empty()) return mesh;
  int label = 0;
  for (const DrawnElement& element : body.parameters->elements())
    mesh.add_element(element.shape, element.nodes, ++label);
  return mesh;
}

/// From where the scene puts things into the frame of a body.
Eigen::Vector3d in_body(const ModelBody& body, const std::vector<double>& at) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < at.size(); ++i) place(static_cast<Eigen::Index>(i)) = at[i];
  if (body.is_mirrored) place.y() *= -1.0;
  place.head(body.place.size()) -= body.place;
  return place;
}

int nearest_node(const Mesh& mesh, const Eigen::Vector3d& place) {
  Eigen::Index nearest = 0;
  (mesh.nodes.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

void add_point(const std::string& name, const ScenePointParameters& point, ModelBody& body) {
  const std::string key = "points." + name + ".at";
  BodyMatrices& matrices = body.matrices;
  if (matrices.points.contains(name) || matrices.surfaces.contains(name)) {
    throw ConfigError(
        Refusal::doubled_name, "points." + name,
        fmt::format("'{}' has a point or surface of this name; take another", body.name));
  }
  if (matrices.nodes.rows() == 0)
    throw ConfigError(Refusal::unknown_name, key, fmt::format("'{}' has no nodes", body.name));
  const Mesh mesh = mesh_of(body);
  const Eigen::Vector3d place = in_body(body, point.at);
  const Eigen::RowVector3d size =
      mesh.nodes.colwise().maxCoeff() - mesh.nodes.colwise().minCoeff();
  const double rounding = share_of_extent * size.norm();
  const int nearest = nearest_node(mesh, place);
  const double distance = (mesh.nodes.row(nearest).transpose() - place).norm();
  if (distance > rounding && mesh.num_elements() > 0) {
    const MeshPoint found = find_point(mesh, place, rounding);
    if (!found.weights.empty()) {
      NodeShares shares;
      for (std::size_t i = 0; i < found.nodes.size(); ++i)
        shares.push_back({found.nodes[i], found.weights[i]});
      add_dependent_point(name, place.head(matrices.nodes.cols()), shares, matrices);
      return;
    }
  }
  if (distance <= std::max(rounding, point.tolerance.value_or(0.0))) {
    matrices.points[name] = nearest;
    return;
  }
  Eigen::Vector3d at = mesh.nodes.row(nearest).transpose();
  at.head(body.place.size()) += body.place;
  if (body.is_mirrored) at.y() *= -1.0;
  throw ConfigError(
      Refusal::off_the_surface, key,
      fmt::format("is not on '{}': its nearest node is at ({:.6g}, {:.6g}, {:.6g}) m, {:.4g} "
                  "m away; move the point, or give a `tolerance` of at least that",
                  body.name, at.x(), at.y(), at.z(), distance));
}

}  // namespace

const Schema& ScenePointParameters::schema() {
  using P = ScenePointParameters;
  static const Schema keys =
      SchemaOf<P>("scene_point")
          .real_list("at", &P::at,
                     {.doc = "Where the scene puts it at rest, x and y, or x, y and z; `draw` shows "
                             "these coordinates. Within an element the point moves as its shape "
                             "functions have it.",
                      .unit = "m"})
          .text("of", &P::of, {.doc = "The body."})
          .real("tolerance", &P::tolerance,
                {.doc = "Distance up to which a place that is in no element goes to the nearest "
                        "node; default: none.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true})
          .check([](const P& point, std::vector<Problem>& problems) {
            if (point.at.size() == 2 || point.at.size() == 3) return;
            problems.push_back(
                {Refusal::wrong_value, "at",
                 fmt::format("must have two or three numbers, got {}", point.at.size())});
          });
  return keys;
}

void add_scene_points(const std::map<std::string, ScenePointParameters>& points,
                      std::vector<ModelBody>& bodies) {
  for (const auto& [name, point] : points) {
    const std::string& of = point.of;
    const auto body = std::find_if(bodies.begin(), bodies.end(), [&of](const ModelBody& one) {
      return one.parameters != nullptr && one.name == of;
    });
    if (body != bodies.end()) {
      add_point(name, point, *body);
      continue;
    }
    std::vector<std::string> names;
    for (const ModelBody& one : bodies)
      if (one.parameters != nullptr) names.push_back(one.name);
    throw ConfigError(Refusal::unknown_name, "points." + name + ".of",
                      fmt::format("there is no substructure '{}'{} (there are: {})", point.of,
                                  did_you_mean(point.of, names), listed_names(names)));
  }
}

}  // namespace stridor
