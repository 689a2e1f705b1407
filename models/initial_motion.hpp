// Initial motions of a body, from the values prescribed.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "models/initial_parameters.hpp"
#include "models/model_body.hpp"
#include "substructures/modal_body.hpp"

namespace stridor {

/// The displacement (or velocity) of one row of ReducedBody::rows.
struct PrescribedRow {
  int row = 0;
  double value = 0.0;
};

/// The shape of least strain energy ½ qᵀ K q with rows q as prescribed, in reduced coordinates; of
/// several such shapes the smallest.
///
/// @throws NumericalError if the rows cannot take these values, because a support holds them or
/// they
///         contradict each other
Eigen::VectorXd static_shape(const ModalBody& body, std::span<const PrescribedRow> prescribed);

/// The initial displacements or velocities of a scene with their names resolved.
struct InitialMotion {
  struct Entry {
    std::string key;
    int body = 0;
    std::optional<PointRows> rows;  ///< of a point; none for the whole body
    Eigen::Vector3d value;
  };
  std::vector<Entry> entries;

  template <MotionKind kind>
  InitialMotion(const std::vector<InitialMotionParameters<kind>>& given, const std::string& key,
                std::vector<ModelBody>& bodies) {
    for (std::size_t k = 0; k < given.size(); ++k) {
      Entry entry{fmt::format("{}.{}", key, k), 0, std::nullopt, {given[k].x, given[k].y, given[k].z}};
      const std::string& at = given[k].at;
      const bool is_point = at.find('.') != std::string::npos;
      const auto [b, point] = split_name(is_point ? at : at + ".all", bodies, entry.key + ".at");
      entry.body = b;
      ModelBody& body = bodies[static_cast<std::size_t>(b)];
      if (is_point) entry.rows = body.rows_of(node_at(body, point, entry.key + ".at"));
      entries.push_back(std::move(entry));
    }
  }

  /// The motion of one body in reduced coordinates; empty where nothing is given.
  Eigen::VectorXd of(int body, const ModelBody& built, const SystemBody& finished) const {
    Eigen::VectorXd motion;
    std::vector<PrescribedRow> prescribed;
    std::string key;
    const auto add = [&](const Eigen::VectorXd& part) {
      motion = motion.size() == 0 ? part : Eigen::VectorXd(motion + part);
    };
    for (const Entry& entry : entries) {
      if (entry.body != body) continue;
      if (entry.rows) {
        key = entry.key;
        if (entry.value.x() != 0.0) prescribed.push_back({entry.rows->x, entry.value.x()});
        if (entry.value.y() != 0.0) prescribed.push_back({entry.rows->y, entry.value.y()});
        if (entry.value.z() != 0.0 && entry.rows->z < 0) {
          throw ConfigError(entry.key + ".at",
                            fmt::format("'{}' does not move along z", built.name));
        }
        if (entry.value.z() != 0.0) prescribed.push_back({entry.rows->z, entry.value.z()});
      } else {
        add(translation(entry, built, finished));
      }
    }
    if (!prescribed.empty()) {
      try {
        add(static_shape(finished.modal, prescribed));
      } catch (const NumericalError& error) {
        throw ConfigError(key + ".at", error.what());
      }
    }
    return motion;
  }

  /// Whether a DoF is the displacement of nodes in a direction.
  static bool is_dof_of(const BodyMatrices& body, int dof, std::size_t direction) {
    if (direction == 2)
      return std::find(body.across.begin(), body.across.end(), dof) != body.across.end();
    return std::any_of(body.node_dofs.begin(), body.node_dofs.end(),
                       [&](const auto& dofs) { return dofs[direction] == dof; });
  }

  /// Constraint modes carry a body along with its interface; that is a translation where no support
  /// resists it.
  static Eigen::VectorXd translation(const Entry& entry, const ModelBody& built,
                                     const SystemBody& finished) {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(finished.reduced.size());
    const Eigen::MatrixXd& stiffness = finished.reduced.stiffness;
    for (Eigen::Index direction = 0; direction < 3; ++direction) {
      if (entry.value(direction) == 0.0) continue;
      Eigen::VectorXd unit = Eigen::VectorXd::Zero(finished.reduced.size());
      for (std::size_t k = 0; k < built.interface.size(); ++k) {
        if (is_dof_of(built.matrices, built.interface[k], static_cast<std::size_t>(direction)))
          unit(static_cast<Eigen::Index>(k)) = 1.0;
      }
      const double energy = unit.dot(stiffness * unit);
      const double scale = unit.dot(stiffness.cwiseAbs() * unit);
      // A body without interface DoFs in this direction is held by its supports alone.
      if (unit.isZero() || !(energy <= 1e-9 * scale)) {
        throw ConfigError(entry.key + ".at",
                          fmt::format("the supports of '{}' do not let all of it move alike; name "
                                      "a point of it",
                                      built.name));
      }
      motion += entry.value(direction) * unit;
    }
    return motion;
  }
};

}  // namespace stridor
