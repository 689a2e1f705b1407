#include "io/figures/spectrogram_marks.hpp"

#include <algorithm>

#include "io/figures/axes.hpp"

namespace stridor {
namespace {

bool overlap(const PictureBox& a, const PictureBox& b) {
  return a.left < b.right && b.left < a.right && a.bottom < b.top && b.bottom < a.top;
}

PictureBox grown(const PictureBox& box, double margin) {
  return {box.left - margin, box.right + margin, box.bottom - margin, box.top + margin};
}

// What labels and their leaders must keep clear of.
struct Obstacles {
  std::vector<PictureBox> boxes;
  std::vector<PictureBox> texts;
  std::vector<PictureBox> leaders;

  static bool is_hit(const PictureBox& box, const std::vector<PictureBox>& others) {
    return std::any_of(others.begin(), others.end(),
                       [&](const PictureBox& other) { return overlap(box, other); });
  }
};

// From a box to a label above or below it.
PictureBox leader_between(const PictureBox& box, const PictureBox& label) {
  const double x = std::clamp(0.5 * (box.left + box.right), label.left, label.right);
  return label.bottom > box.top ? PictureBox{x, x, box.top, label.bottom}
                                : PictureBox{x, x, label.top, box.bottom};
}

// Puts a label at the first place beside its box that is free and within the map. @return whether
// there is one
bool add_label(MarkPlace& place, const std::string& text, const MapArea& map,
               Obstacles& obstacles) {
  constexpr double gap = 0.08;
  constexpr int num_levels = 6;
  const double width = text_width(text, map.font_size) + 0.15;
  const double height = 0.85 * line_height(map.font_size);
  const PictureBox& box = place.box;
  const double middle = 0.5 * (box.left + box.right);
  const auto within = [&](double left) {
    return std::clamp(left, 0.0, std::max(0.0, map.width - width));
  };
  for (int level = 0; level < num_levels; ++level) {
    const double away = gap + level * (height + gap);
    for (const double bottom : {box.top + away, box.bottom - away - height}) {
      for (const double left :
           {within(middle - 0.5 * width), within(box.left), within(box.right - width)}) {
        const PictureBox label{left, left + width, bottom, bottom + height};
        const PictureBox clearance = grown(label, 0.5 * gap);
        if (label.bottom < 0.0 || label.top > map.height || label.right > map.width + 1e-9)
          continue;
        if (Obstacles::is_hit(clearance, obstacles.boxes) ||
            Obstacles::is_hit(clearance, obstacles.texts) ||
            Obstacles::is_hit(clearance, obstacles.leaders))
          continue;
        if (level > 0) {
          const PictureBox leader = leader_between(box, label);
          if (Obstacles::is_hit(grown(leader, 0.5 * gap), obstacles.texts)) continue;
          place.leader = leader;
          obstacles.leaders.push_back(leader);
        }
        place.text = text;
        place.label = label;
        obstacles.texts.push_back(label);
        return true;
      }
    }
  }
  return false;
}

}  // namespace

std::vector<MarkPlace> place_marks(const std::vector<SpectrogramMark>& marks, const MapArea& map) {
  constexpr double least_width = 0.12;  // cm, so that a short stretch remains a box
  std::vector<MarkPlace> places;
  Obstacles obstacles;
  const double across = map.width / (map.to - map.from);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const SpectrogramMark& mark = marks[i];
    if (!(mark.from <= map.to && mark.to >= map.from && mark.frequency >= 0.0 &&
          mark.frequency <= map.max_frequency)) {
      continue;
    }
    const double middle = (0.5 * (mark.from + mark.to) - map.from) * across;
    const double half = std::max(0.5 * (mark.to - mark.from) * across, 0.5 * least_width);
    const double height = map.height * mark.frequency / map.max_frequency;
    const auto within = [](double x, double limit) { return std::clamp(x, 0.0, limit); };
    const PictureBox box{within(middle - half, map.width), within(middle + half, map.width),
                         within(height - map.half_box, map.height),
                         within(height + map.half_box, map.height)};
    places.push_back({i, box, "", std::nullopt, std::nullopt});
    obstacles.boxes.push_back(box);
  }
  for (MarkPlace& place : places) {
    for (const std::string& text : {marks[place.mark].label, marks[place.mark].short_label}) {
      if (!text.empty() && add_label(place, text, map, obstacles)) break;
    }
  }
  return places;
}

}  // namespace stridor
