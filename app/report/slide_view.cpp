#include "app/report/slide_view.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "app/report/drawn_bodies.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/figures/mesh_picture.hpp"
#include "io/figures/placed_bodies.hpp"
#include "io/scene/channels.hpp"
#include "models/body_cache.hpp"

namespace stridor {
namespace {

/// Times at which the page has the displacement of a drive, between which it is straight.
constexpr int num_moments = 513;

Json triple(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

class Slide {
 public:
  Slide(const PlacedModel& model, const RecordedStretch& run, ReportPage& page)
      : model_(model), placed_(model), run_(run), page_(page) {
    for (const Drive& drive : model.system.drives) {
      std::vector<double>& way = ways_.emplace_back();
      for (int i = 0; i < num_moments; ++i)
        way.push_back(drive.displacement(
            std::lerp(run.first_time(), run.last_time(), 1.0 * i / (num_moments - 1))));
    }
  }

  /// @param channels of the scene
  Json view(const std::vector<Channel>& channels, double bytes) {
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) add_body(b);
    add_masters(channels);
    const DrawnNodes drawn = drawn_nodes(drawn_);
    constexpr double bytes_per_node = 30.0;  // places, and the faces or lines at it
    if (drawn.count == 0 || bytes_per_node * static_cast<double>(drawn.count) > bytes)
      throw ConfigError(Refusal::too_large, "",
                        fmt::format("{} nodes do not fit into the page (--budget)", drawn.count));
    Json parts = parts_json(drawn, drawn_, page_);
    std::vector<double> places;
    for (std::size_t p = 0; p < drawn.parts.size(); ++p) {
      for (const int node : drawn.parts[p].nodes)
        for (int d = 0; d < 3; ++d) places.push_back(nodes_[p](node, d));
      parts[p].update(motions_[p]);
    }
    Json view = {{"type", "slide"},
                 {"planar", is_planar()},
                 {"up", upward_axis(model_.system)},
                 {"parts", std::move(parts)},
                 {"places", page_.add_floats(places)}};
    view["time"] = {{"from", run_.first_time()}, {"to", run_.last_time()}};
    view["drives"] = drives();
    view["springs"] = springs();
    view["contacts"] = contacts();
    view["points"] = points(channels);
    return view;
  }

 private:
  void add_body(std::size_t b) {
    const ModelBody& body = model_.bodies[b];
    if (body.parameters == nullptr || placed_.nodes(b).rows() == 0) return;
    const std::vector<DrawnElement> elements = body.parameters->elements();
    DrawnBody one{body.name, placed_.nodes(b).rows(), face_loops(elements), body.matrices.outlines};
    if (body.matrices.faces.empty())
      for (const auto& [name, nodes] : body.matrices.surfaces) one.lines.push_back(nodes);
    Json motion = Json::object();
    if (body.drive >= 0) motion["drive"] = body.drive;
    // What slides along the circumference of a plate turns about its axis.
    if (body.drive >= 0 && placed_.seat(b)) motion["radius"] = placed_.seat(b)->radius;
    if (const std::optional<Json> spin = spin_of(b)) motion["spin"] = *spin;
    part_of_body_[b] = drawn_.size();
    add_part(std::move(one), placed_.nodes(b), std::move(motion));
  }
  void add_part(DrawnBody body, Eigen::MatrixX3d nodes, Json motion) {
    drawn_.push_back(std::move(body));
    nodes_.push_back(std::move(nodes));
    motions_.push_back(std::move(motion));
  }

  std::optional<Json> spin_of(std::size_t b) const {
    const BodyMatrices& matrices = model_.bodies[b].matrices;
    if (!matrices.faces.empty()) {
      const double speed = matrices.faces.begin()->second.spin;
      if (speed == 0.0) return std::nullopt;
      return Json{{"speed", speed}, {"axis", {0.0, 0.0, 1.0}}, {"point", {0.0, 0.0, 0.0}}};
    }
    // One whose surfaces alone spin stays where it is.
    if (!matrices.spin || matrices.spin->speed == 0.0 || matrices.spin->gyroscopic.size() == 0)
      return std::nullopt;
    return Json{
        {"speed", matrices.spin->speed},
        {"axis", triple(placed_.direction(b, matrices.spin->point, matrices.spin->direction))},
        {"point", triple(placed_.at(b, matrices.spin->point))}};
  }

  /// Masters without end, as lines with teeth: the teeth show that the master moves.
  void add_masters(const std::vector<Channel>& channels) {
    double low = 0.0, high = 0.0;
    for (const Eigen::MatrixX3d& places : nodes_) {
      if (places.rows() == 0) continue;
      low = std::min(low, places.col(0).minCoeff());
      high = std::max(high, places.col(0).maxCoeff());
    }
    const double width = high - low;
    for (const ModelBody& body : model_.bodies) {
      if (body.drive < 0 || body.parameters == nullptr) continue;
      for (const double way : ways_[static_cast<std::size_t>(body.drive)]) {
        low = std::min(low, way);
        high = std::max(high, width + way);
      }
    }
    // Bodies of points alone have no extent but that of their motion.
    constexpr double motions_across = 10.0;
    const double extent =
        std::max({high - low, width > 0.0 ? 0.0 : motions_across * largest_motion(channels), 1e-9});
    for (const MasterSurface& surface : model_.system.surfaces) {
      if (!surface.is_endless) continue;
      constexpr int num_teeth = 16;
      const double margin = 0.5 * extent, spacing = (extent + 2.0 * margin) / num_teeth;
      Eigen::MatrixX3d nodes = Eigen::MatrixX3d::Zero(2 * (num_teeth + 1), 3);
      DrawnBody line{surface.name, nodes.rows(), {}, {}};
      for (int i = 0; i <= num_teeth; ++i) {
        const double x = low - margin + spacing * i;
        nodes(2 * i, 0) = x;
        nodes.row(2 * i + 1) << x - 0.5 * spacing, -0.5 * spacing, 0.0;
        line.lines.push_back({2 * i, 2 * i + 1});
        if (i > 0) line.lines.push_back({2 * i - 2, 2 * i});
      }
      Json motion = {{"period", spacing}};
      const int drive = model_.bodies[static_cast<std::size_t>(surface.body)].drive;
      if (drive >= 0) motion["drive"] = drive;
      add_part(std::move(line), std::move(nodes), std::move(motion));
    }
  }

  /// The largest recorded displacement of points, m.
  double largest_motion(const std::vector<Channel>& channels) const {
    double largest = 0.0;
    for (const Channel& channel : channels) {
      const std::string series = "/channels/" + channel.name;
      if (!channel.point || channel.derivative != Derivative::none || !run_.file.has(series))
        continue;
      for (const double value : run_.values(series))
        if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    }
    return largest > 0.0 ? largest : 1e-3;
  }

  bool is_planar() const {
    if (placed_.has_faces()) return false;
    return std::all_of(nodes_.begin(), nodes_.end(), [](const Eigen::MatrixX3d& places) {
      return places.rows() == 0 || places.col(2).cwiseAbs().maxCoeff() == 0.0;
    });
  }

  /// Null of drives that move nothing.
  Json drives() const {
    Json all = Json::array();
    for (const std::vector<double>& way : ways_) {
      const bool moves = std::any_of(way.begin(), way.end(), [](double one) { return one != 0.0; });
      all.push_back(moves ? page_.add_floats(way) : Json(nullptr));
    }
    return all;
  }

  Json springs() const {
    Json all = Json::array();
    for (const auto& [b, part] : part_of_body_) {
      for (const BodySpring& spring : model_.bodies[b].matrices.springs) {
        Json one = {{"part", part}, {"at", triple(placed_.at(b, spring.at))}};
        if (spring.other)
          one["to"] = triple(placed_.at(b, *spring.other));
        else
          one["behind"] = triple(placed_.ground_side(b, spring));
        all.push_back(std::move(one));
      }
    }
    return all;
  }

  Json contacts() const {
    Json all = Json::array();
    for (const ContactPair& pair : model_.pairs) {
      const auto part = part_of_body_.find(static_cast<std::size_t>(pair.slave_body));
      if (part == part_of_body_.end()) continue;
      for (std::size_t k = 0; k < pair.slave_nodes.size(); ++k) {
        const std::string name = pair.point_name(static_cast<int>(k));
        Json one = {{"name", name},
                    {"part", part->second},
                    {"at", triple(placed_.node(part->first, pair.slave_nodes[k]))}};
        for (const ContactPoint& contact : model_.system.contacts)
          if (contact.name == name)
            if (const auto normal = placed_.normal_of(contact); normal && !contact.space)
              one["normal"] = triple(*normal);
        all.push_back(std::move(one));
      }
    }
    return all;
  }

  Json points(const std::vector<Channel>& channels) const {
    Json all = Json::array();
    for (const Channel& channel : channels) {
      if (!channel.point) continue;
      for (const auto& [b, part] : part_of_body_) {
        const ModelBody& body = model_.bodies[b];
        const auto point = body.matrices.points.find(channel.point->point);
        if (body.name != channel.point->body || point == body.matrices.points.end()) continue;
        const Eigen::Vector3d in_body = body.matrices.nodes.row(point->second).transpose();
        all.push_back({{"channel", channel.name},
                       {"part", part},
                       {"at", triple(placed_.node(b, point->second))},
                       {"along", triple(placed_.direction(
                                     b, in_body, Eigen::Vector3d::Unit(channel.direction)))},
                       {"is_displacement", channel.derivative == Derivative::none}});
      }
    }
    return all;
  }

  const PlacedModel& model_;
  PlacedBodies placed_;
  const RecordedStretch& run_;
  ReportPage& page_;
  std::vector<std::vector<double>> ways_;  ///< displacements of each drive, m
  std::vector<DrawnBody> drawn_;
  std::vector<Eigen::MatrixX3d> nodes_;  ///< of each of them
  std::vector<Json> motions_;            ///< what is said of each of them
  std::map<std::size_t, std::size_t> part_of_body_;
};

}  // namespace

void add_slide(const std::string& resolved, const std::string& source, const RecordedStretch& run,
               double bytes, ReportPage& page, Json& section) {
  const Activity placing("bodies for the slide of the report");
  try {
    const LoadedScene loaded = load_resolved_scene(resolved, source);
    if (loaded.scene.model.substructures.empty()) return;
    BodyCache cache;
    const ModelParameters parameters = parameters_with_files(loaded, cache);
    const PlacedModel model = place_model(parameters, cache);
    std::vector<Channel> channels;
    if (loaded.scene.record) channels = parse_channels(*loaded.scene.record, loaded.scene.model);
    section["views"].push_back(Slide(model, run, page).view(channels, bytes));
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    section["remarks"].push_back(std::string("No picture of the slide: ") + error.what());
  }
}

}  // namespace stridor
