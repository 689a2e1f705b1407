// How the marks, arrows and springs of a mesh picture look.
#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "io/figures/mesh_picture.hpp"

namespace stridor {

/// Its name in the legend, and type, size and colour as gnuplot has them.
struct PictureMarkStyle {
  const char* name;
  int type;
  double size;
  const char* colour;
};
inline PictureMarkStyle style_of(PictureMark mark) {
  switch (mark) {
    case PictureMark::mass:
      return {"node", 7, 0.9, "#606060"};
    case PictureMark::contact:
      return {"slave point", 6, 1.5, "#e07b00"};
    case PictureMark::held:
      return {"held", 9, 1.2, "#202020"};
    case PictureMark::held_partly:
      return {"held in some directions", 8, 1.2, "#202020"};
    case PictureMark::guided:
      return {"guided", 5, 0.9, "#741b47"};
    case PictureMark::point:
      break;
  }
  return {"point", 2, 1.1, "#c0392b"};
}
inline constexpr std::array<PictureMark, 6> all_marks{PictureMark::held,   PictureMark::held_partly,
                                                      PictureMark::guided, PictureMark::mass,
                                                      PictureMark::point,  PictureMark::contact};

struct PictureArrowStyle {
  const char* name;
  const char* colour;
};
inline PictureArrowStyle style_of(PictureArrow::Kind kind) {
  switch (kind) {
    case PictureArrow::Kind::motion:
      return {"prescribed motion", "#741b47"};
    case PictureArrow::Kind::load:
      return {"load", "#b02318"};
    case PictureArrow::Kind::normal:
      break;
  }
  return {"normal of the master", "#e07b00"};
}

/// The lines of a spring on the page, cm: a zigzag between straight ends, and where it is on the
/// ground a hatched bar across its end. None where both ends come to lie on one spot.
std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> spring_lines(const Eigen::Vector2d& from,
                                                                      const Eigen::Vector2d& to,
                                                                      bool is_grounded);

}  // namespace stridor
