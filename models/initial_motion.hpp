// Initial motions of a body, from the values prescribed.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "models/initial_parameters.hpp"
#include "models/model_body.hpp"
#include "substructures/reduction/modal_body.hpp"

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
class InitialMotion {
 public:
  /// Gives the points named rows of their bodies.
  /// @throws ConfigError where there is no such body or point
  template <MotionKind kind>
  InitialMotion(const std::vector<InitialMotionParameters<kind>>& given, const std::string& key,
                std::vector<ModelBody>& bodies) {
    for (std::size_t k = 0; k < given.size(); ++k)
      add(key + "." + std::to_string(k), given[k].at, {given[k].x, given[k].y, given[k].z}, bodies);
  }

  /// The motion of one body in reduced coordinates; empty where nothing is given.
  /// @throws ConfigError where the body cannot take it
  Eigen::VectorXd of(int body, const ModelBody& built, const SystemBody& finished) const;

 private:
  struct Entry {
    std::string key;
    int body = 0;
    std::optional<PointRows> rows;  ///< of a point; none for the whole body
    Eigen::Vector3d value;
  };

  void add(const std::string& key, const std::string& at, const Eigen::Vector3d& value,
           std::vector<ModelBody>& bodies);

  std::vector<Entry> entries_;
};

}  // namespace stridor
