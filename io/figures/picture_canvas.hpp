// Where the things of a mesh picture stand on the page, and its faces as polygons.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>

#include "io/figures/axes.hpp"
#include "io/figures/mesh_picture.hpp"

namespace stridor {

/// Places on the page.
class PictureCanvas {
 public:
  /// @throws std::invalid_argument if there is nothing to draw
  explicit PictureCanvas(const MeshPicture& picture);

  Eigen::Vector2d flat(const Eigen::Vector3d& place) const {
    return {view_.right.dot(place), view_.up.dot(place)};
  }
  Eigen::Vector3d head_of(const PictureArrow& arrow) const {
    const double length = arrow.direction.norm();
    return arrow.at + (length > 0.0 ? arrow_length_ / length : 0.0) * arrow.direction;
  }
  Eigen::Vector3d end_of(const PictureSpring& spring) const {
    if (!spring.is_grounded) return spring.to;
    const double length = spring.to.norm();
    return spring.at + (length > 0.0 ? 2.0 * arrow_length_ / length : 0.0) * spring.to;
  }
  Eigen::Vector2d on_page(const Eigen::Vector2d& place) const {
    return {left + (place.x() - x.lower) * cm_per_metre,
            bottom + (place.y() - y.lower) * cm_per_metre};
  }
  double diagonal() const { return std::hypot(x.upper - x.lower, y.upper - y.lower); }
  double width() const { return (x.upper - x.lower) * cm_per_metre; }
  double height() const { return (y.upper - y.lower) * cm_per_metre; }

  /// Chooses the scale that fits, and widens what is shown to a least height.
  void fit(double room, double least_height, double most_height) {
    cm_per_metre =
        std::min(room / (x.upper - x.lower), most_height / (y.upper - y.lower));
    const double missing = least_height / cm_per_metre - (y.upper - y.lower);
    if (missing <= 0.0) return;
    y = {y.lower - 0.5 * missing, y.upper + 0.5 * missing};
  }

  ValueRange x, y;  ///< m
  double left = 0.0, bottom = 0.0, cm_per_metre = 1.0;

 private:
  void include(const Eigen::Vector3d& place) {
    const Eigen::Vector2d at = flat(place);
    x.include({&at.x(), 1});
    y.include({&at.y(), 1});
  }

  PictureView view_;
  double arrow_length_ = 0.0;
};

/// The faces and lines of all parts as a data block of polygons for `filledcurves closed`, in cm of
/// the page with a colour each, farther ones first. Lines are narrow polygons, so that they are
/// hidden as faces are.
/// @param block its name, as `$faces`
std::string polygon_data(const std::string& block, const MeshPicture& picture,
                         const PictureCanvas& canvas);

}  // namespace stridor
