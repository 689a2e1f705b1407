#include "io/figures/scene_picture.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "io/figures/placed_bodies.hpp"

namespace stridor {
namespace {

template <class Place>
Eigen::Vector3d in_space(const Place& place) {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  result.head(place.size()) = place;
  return result;
}

class ScenePicture {
 public:
  ScenePicture(const PlacedModel& model, const std::vector<std::string>& recorded,
               const LengthUnit& unit)
      : model_(model), placed_(model), recorded_(recorded.begin(), recorded.end()) {
    picture_.unit = unit.name;
    picture_.metres_per_unit = unit.metres;
    bool is_spatial = placed_.has_faces();
    for (const ModelBody& body : model.bodies) {
      if (body.parameters == nullptr) continue;
      for (const DrawnElement& element : body.parameters->elements())
        is_spatial = is_spatial || facts_of(element.shape).dimension == 3;
    }
    if (is_spatial) picture_.view = PictureView::isometric();
  }

  MeshPicture make() {
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
      if (model_.bodies[b].parameters == nullptr) continue;
      add_body(b);
      add_supports(b);
    }
    add_contacts();
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) add_springs(b);
    add_drives();
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) add_points(b);
    const bool knows_places = std::any_of(
        picture_.parts.begin(), picture_.parts.end(),
        [](const PicturePart& part) { return part.nodes.rows() > 0; });
    if (!knows_places && picture_.labels.empty()) add_unknown();
    return std::move(picture_);
  }

 private:
  const Eigen::MatrixX3d& nodes(std::size_t b) const { return placed_.nodes(b); }
  Eigen::Vector3d place(std::size_t b, int node) const { return placed_.node(b, node); }

  void add_body(std::size_t b) {
    const ModelBody& body = model_.bodies[b];
    PicturePart part;
    part.name = body.name;
    part.colour = part_colour(b);
    part.nodes = nodes(b);
    const std::vector<DrawnElement> elements = body.parameters->elements();
    part.faces = face_loops(elements);
    part.is_closed =
        !elements.empty() && facts_of(elements.front().shape).dimension == 3;
    if (body.is_mirrored && part.is_closed)
      for (std::vector<int>& face : part.faces) std::reverse(face.begin(), face.end());
    if (!part.is_closed) {
      part.lines = body.matrices.outlines;
      if (body.matrices.faces.empty())
        for (const auto& [name, nodes] : body.matrices.surfaces) part.lines.push_back(nodes);
    }
    const bool is_measured = body.matrices.is_modal && body.matrices.faces.empty();
    if (elements.empty() && (part.lines.empty() || is_measured)) add_joined(b, part);
    if (part.nodes.rows() == 0) part.name += " (has no places)";
    picture_.parts.push_back(std::move(part));
  }

  /// Nodes, and lines between those that the stiffness joins.
  void add_joined(std::size_t b, PicturePart& part) {
    constexpr Eigen::Index most = 400;
    const BodyMatrices& matrices = model_.bodies[b].matrices;
    for (Eigen::Index i = 0; i < nodes(b).rows() && i < most; ++i)
      picture_.places.push_back({place(b, static_cast<int>(i)), PictureMark::mass});
    if (nodes(b).rows() > most || matrices.is_modal) return;
    const std::vector<int> nodes = nodes_of_dofs(matrices);
    std::set<std::pair<int, int>> joined;
    for (int column = 0; column < matrices.stiffness.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(matrices.stiffness, column); entry; ++entry) {
        const int from = nodes[static_cast<std::size_t>(entry.row())];
        const int to = nodes[static_cast<std::size_t>(column)];
        if (from < to && from >= 0 && entry.value() != 0.0) joined.emplace(from, to);
      }
    }
    for (const auto& [from, to] : joined) part.lines.push_back({from, to});
  }

  /// The first node that each DoF moves; −1 of those that move none.
  static std::vector<int> nodes_of_dofs(const BodyMatrices& matrices) {
    std::vector<int> nodes(static_cast<std::size_t>(matrices.num_dofs()), -1);
    for (int node = 0; node < matrices.nodes.rows(); ++node) {
      if (matrices.dependent.contains(node)) continue;
      for (const std::size_t direction : {0, 1, 2}) {
        for (const DofWeight& dof : matrices.displacement(node, direction)) {
          int& of_dof = nodes[static_cast<std::size_t>(dof.dof)];
          if (of_dof < 0) of_dof = node;
        }
      }
    }
    return nodes;
  }

  /// A node is held in directions in which others of its body move.
  void add_supports(std::size_t b) {
    const BodyMatrices& matrices = model_.bodies[b].matrices;
    if (matrices.is_modal) return;
    constexpr std::array<std::size_t, 3> directions{0, 1, 2};
    std::array<bool, 3> moves_any{};
    std::vector<PicturePlace> marked;
    for (int node = 0; node < matrices.nodes.rows(); ++node) {
      for (const std::size_t d : directions) moves_any[d] = moves_any[d] || matrices.moves(node, d);
    }
    for (int node = 0; node < matrices.nodes.rows(); ++node) {
      if (matrices.dependent.contains(node)) continue;
      int held = 0;
      int free = 0;
      bool is_guided = false;
      for (const std::size_t d : directions) {
        if (!moves_any[d]) continue;
        const DofSum sum = matrices.displacement(node, d);
        ++(sum.empty() ? held : free);
        is_guided = is_guided || (matrices.follows_drive() && sum.size() == 1 &&
                                  sum.front().dof == matrices.load_dof);
      }
      if (is_guided) {
        guided_[b].push_back(node);
        marked.push_back({place(b, node), PictureMark::guided});
      } else if (held > 0) {
        marked.push_back(
            {place(b, node), free == 0 ? PictureMark::held : PictureMark::held_partly});
      }
    }
    // Of many some.
    constexpr std::size_t most = 300;
    for (std::size_t i = 0; i < marked.size(); i += 1 + marked.size() / most)
      picture_.places.push_back(marked[i]);
  }

  void add_springs(std::size_t b) {
    for (const BodySpring& spring : model_.bodies[b].matrices.springs) {
      const Eigen::Vector3d at = placed_.at(b, spring.at);
      if (spring.other)
        picture_.springs.push_back({at, placed_.at(b, *spring.other), false});
      else
        picture_.springs.push_back({at, placed_.ground_side(b, spring), true});
    }
  }

  void add_contacts() {
    for (const MasterSurface& surface : model_.system.surfaces) add_master(surface);
    for (const ContactPair& pair : model_.pairs) {
      const auto slave = static_cast<std::size_t>(pair.slave_body);
      for (const int node : pair.slave_nodes)
        picture_.places.push_back({place(slave, node), PictureMark::contact});
      if (pair.slave_nodes.empty()) continue;
      const Eigen::Vector3d at = place(slave, pair.slave_nodes.front());
      picture_.labels.push_back({at, "", fmt::format("{} on {}", pair.name, pair.master_name), 2});
      for (const ContactPoint& contact : model_.system.contacts) {
        if (contact.name != pair.point_name(0)) continue;
        if (const std::optional<Eigen::Vector3d> normal = placed_.normal_of(contact))
          picture_.arrows.push_back({at, *normal, PictureArrow::Kind::normal});
      }
    }
  }

  void add_master(const MasterSurface& surface) {
    PicturePart part;
    part.colour = 0xe07b00;
    std::vector<Eigen::Vector3d> line;
    for (const auto& position : surface.positions) line.push_back(in_space(position));
    if (surface.is_endless) {
      // As far as the bodies reach.
      double low = 0.0;
      double high = 0.0;
      for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
        const Eigen::MatrixX3d& places = nodes(b);
        if (places.rows() == 0) continue;
        low = std::min(low, places.col(0).minCoeff());
        high = std::max(high, places.col(0).maxCoeff());
      }
      const double margin = high > low ? 0.15 * (high - low) : 0.5 * picture_.metres_per_unit;
      line = {Eigen::Vector3d(low - margin, 0.0, 0.0), Eigen::Vector3d(high + margin, 0.0, 0.0)};
      part.name = surface.name + " (no end)";
    }
    part.nodes.resize(static_cast<Eigen::Index>(line.size()), 3);
    std::vector<int>& nodes = part.lines.emplace_back();
    for (std::size_t k = 0; k < line.size(); ++k) {
      part.nodes.row(static_cast<Eigen::Index>(k)) = line[k].transpose();
      nodes.push_back(static_cast<int>(k));
    }
    if (part.name.empty() && !names_masters_) part.name = "master";
    names_masters_ = names_masters_ || part.name == "master";
    picture_.parts.push_back(std::move(part));
  }

  /// Mean place of nodes.
  Eigen::Vector3d middle(std::size_t b, const std::vector<int>& nodes) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int node : nodes) sum += place(b, node);
    return sum / static_cast<double>(nodes.size());
  }

  static double at_the_end(const TimeCurve& curve) {
    return curve.value(curve.constant_from());
  }

  void add_drives() {
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
      const ModelBody& body = model_.bodies[b];
      if (body.drive >= 0) {
        const Drive& drive = model_.system.drives[static_cast<std::size_t>(body.drive)];
        const double sign = at_the_end(drive.velocity) < 0.0 ? -1.0 : 1.0;
        const auto guided = guided_.find(b);
        const Eigen::Vector3d at = guided != guided_.end() ? middle(b, guided->second)
                                                           : Eigen::Vector3d(Eigen::Vector3d::Zero());
        if (!drive.velocity.is_zero() || guided != guided_.end())
          picture_.arrows.push_back({at, sign * Eigen::Vector3d::UnitX(), PictureArrow::Kind::motion});
      }
      for (const BodyLoad& load : model_.loads[b]) add_load(b, load);
    }
    add_spins();
  }

  void add_spins() {
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
      for (const auto& [name, face] : model_.bodies[b].matrices.faces) {
        if (face.side < 0) continue;
        const Eigen::Vector3d at(0.0, -face.outer_radius, 0.0);
        picture_.arrows.push_back({at, Eigen::Vector3d::UnitX(), PictureArrow::Kind::motion});
      }
    }
  }

  /// A load acts at the mean place of the nodes that it moves, along the mean of their directions.
  void add_load(std::size_t b, const BodyLoad& load) {
    const BodyMatrices& matrices = model_.bodies[b].matrices;
    const DofSum& sum = model_.bodies[b].rows[static_cast<std::size_t>(load.row)];
    std::map<int, double> weights;
    for (const DofWeight& dof : sum) weights[dof.dof] += dof.weight;
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    double total = 0.0;
    for (int node = 0; node < matrices.nodes.rows(); ++node) {
      if (matrices.dependent.contains(node)) continue;
      for (const std::size_t d : {0, 1, 2}) {
        for (const DofWeight& dof : matrices.displacement(node, d)) {
          const auto found = weights.find(dof.dof);
          if (found == weights.end()) continue;
          const double weight = found->second * dof.weight;
          total += std::abs(weight);
          at += std::abs(weight) * place(b, node);
          direction += weight * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(d));
        }
      }
    }
    if (!(total > 0.0)) return;
    const Drive& drive = model_.system.drives[static_cast<std::size_t>(load.drive)];
    const bool is_force = load.by == BodyLoad::By::force;
    if (at_the_end(is_force ? drive.load : drive.shift) < 0.0) direction *= -1.0;
    if (model_.bodies[b].is_mirrored) direction.y() *= -1.0;
    if (placed_.seat(b)) direction = Eigen::Vector3d(0.0, 0.0, direction.y());
    picture_.arrows.push_back({at / total, direction,
                               is_force ? PictureArrow::Kind::load : PictureArrow::Kind::motion});
  }

  void add_points(std::size_t b) {
    const ModelBody& body = model_.bodies[b];
    if (body.parameters == nullptr) return;
    for (const auto& [name, node] : body.matrices.points) {
      const bool is_recorded = recorded_.contains(body.name + "." + name);
      picture_.places.push_back({place(b, node), PictureMark::point});
      picture_.labels.push_back({place(b, node), body.name,
                                 is_recorded ? name + " (recorded)" : name, is_recorded ? 1 : 0});
    }
  }

  /// Bodies without places alone.
  void add_unknown() {
    picture_.labels.push_back({Eigen::Vector3d::Zero(), "", "no places are known", 0});
  }

  const PlacedModel& model_;
  PlacedBodies placed_;
  std::set<std::string> recorded_;
  bool names_masters_ = false;
  std::map<std::size_t, std::vector<int>> guided_;
  MeshPicture picture_;
};

}  // namespace

MeshPicture make_scene_picture(const PlacedModel& model, const std::vector<std::string>& recorded,
                               const LengthUnit& unit, const std::string& caption) {
  MeshPicture picture = ScenePicture(model, recorded, unit).make();
  picture.caption = caption;
  return picture;
}

}  // namespace stridor
