#include "io/figures/mesh_picture.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"
#include "io/figures/picture_canvas.hpp"
#include "io/figures/picture_flags.hpp"
#include "io/figures/picture_styles.hpp"

namespace stridor {
namespace {

constexpr int most_rows_of_labels = 14;

/// Everything about one figure while it is laid out, cm.
class MeshFigure {
 public:
  explicit MeshFigure(const MeshPicture& picture) : picture_(picture), canvas_(picture) {
    canvas_.fit(size_.width - 3.5, least_height, most_height);
    merge_labels();
    choose_width();
    place_labels();
    fill_legend();
    stack();
  }

  void draw(const std::filesystem::path& figure) const {
    FigureScript script(size_);
    const bool has_faces = std::any_of(
        picture_.parts.begin(), picture_.parts.end(),
        [](const PicturePart& part) { return !part.faces.empty() || !part.lines.empty(); });
    if (has_faces) script.append(polygon_data("$faces", picture_, canvas_));
    script.append(place_data());
    script.add("set multiplot\n{}\nunset key\nunset grid", axes_style);
    // The page itself in cm for faces, then axes with numbers over it.
    if (has_faces) {
      script.add("set margins 0, 0, 0, 0\nunset border\nunset tics");
      script.add("set xrange [0:{:.6f}]\nset yrange [0:{:.6f}]\nset style fill solid 1 noborder",
                 size_.width, size_.height);
      script.add("plot $faces using 1:2:3 with filledcurves closed fillcolor rgb variable");
      script.add("{}\nunset grid", axes_style);
    }
    add_axes(script);
    add_labels(script);
    add_arrows(script);
    for (const PictureSpring& spring : picture_.springs)
      add_spring(script, canvas_.on_page(canvas_.flat(spring.at)),
                 canvas_.on_page(canvas_.flat(canvas_.end_of(spring))), spring.is_grounded);
    add_legend(script);
    script.add_caption(caption_, 0.4, caption_top_);
    add_places(script);
    script.add("unset multiplot");
    draw_figure(figure, script.text(), size_);
  }

 private:
  bool is_planar() const { return picture_.view.is_planar; }
  double in_units(double metres) const { return metres / picture_.metres_per_unit; }

  static constexpr double most_height = 13.0;
  static constexpr double least_height = 1.8;
  static constexpr double least_drawing = 6.0;

  /// A text with the place that it names.
  struct Flag {
    Eigen::Vector3d at;
    std::string text;
  };

  /// Names of one spot become one text.
  void merge_labels() {
    constexpr double spot = 0.25;  // cm
    constexpr std::size_t most_names = 3;
    std::vector<PictureLabel> labels = picture_.labels;
    std::stable_sort(labels.begin(), labels.end(), [](const PictureLabel& a, const PictureLabel& b) {
      return a.weight > b.weight;
    });
    std::vector<std::vector<const PictureLabel*>> spots;
    for (const PictureLabel& label : labels) {
      const auto is_near = [&](const auto& others) {
        const Eigen::Vector2d apart = canvas_.flat(label.at) - canvas_.flat(others.front()->at);
        return apart.norm() * canvas_.cm_per_metre < spot;
      };
      const auto found = std::find_if(spots.begin(), spots.end(), is_near);
      if (found == spots.end()) {
        spots.push_back({&label});
      } else {
        found->push_back(&label);
      }
    }
    // A text at the right end of the narrowest drawing still ends on the page.
    const double most_width = size_.width - (least_drawing + 3.0);
    for (const auto& names : spots) {
      Flag& flag = flags_.emplace_back(Flag{names.front()->at, ""});
      for (std::size_t count = std::min(names.size(), most_names); count > 0; --count) {
        flag.text = flag_text(names, count);
        if (flag_width(flag) <= most_width) break;
      }
    }
  }

  static std::string flag_text(const std::vector<const PictureLabel*>& names, std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_repeated = i > 0 && names[i]->of == names[i - 1]->of;
      if (i > 0) text += ", ";
      if (!names[i]->of.empty() && !is_repeated) text += names[i]->of + ".";
      text += names[i]->text;
    }
    if (names.size() > count) text += fmt::format(" and {} more", names.size() - count);
    return text;
  }

  void choose_width() {
    double right = size_.width - 0.6;
    for (int round = 0; round < 4; ++round) {
      x_range_ = {in_units(canvas_.x.lower), in_units(canvas_.x.upper)};
      y_range_ = {in_units(canvas_.y.lower), in_units(canvas_.y.upper)};
      x_scale_ = axis_scale(x_range_.lower, x_range_.upper, 7);
      const double shape = (y_range_.upper - y_range_.lower) / (x_range_.upper - x_range_.lower);
      y_scale_ = axis_scale(y_range_.lower, y_range_.upper, shape < 0.3 ? 2 : 5);
      canvas_.left = is_planar() ? 1.4 * line_height(size_.font_size) +
                                       (static_cast<double>(tick_characters(y_range_, y_scale_)) + 1.3) *
                                           character_width(size_.font_size)
                                 : 2.6;
      canvas_.fit(right - canvas_.left, least_height, most_height);
      double overflow = canvas_.left + canvas_.width() - (size_.width - 0.6);
      for (const Flag& flag : flags_)
        overflow = std::max(overflow, flag_x(flag) + flag_width(flag) + 0.2 - size_.width);
      if (overflow <= 0.0) break;
      right = std::max(canvas_.left + least_drawing, canvas_.left + canvas_.width() - overflow);
    }
  }

  double flag_x(const Flag& flag) const {
    return canvas_.on_page(canvas_.flat(flag.at)).x();
  }
  double flag_width(const Flag& flag) const {
    return 0.12 + 1.12 * text_width(flag.text, caption_font);
  }

  void place_labels() {
    std::vector<FlagRequest> requests;
    for (const Flag& flag : flags_) requests.push_back({flag_x(flag), flag_width(flag)});
    rows_ = flag_rows(requests, 0.15, most_rows_of_labels);
    for (const int row : rows_) num_rows_ = std::max(num_rows_, row + 1);
    num_unwritten_ = static_cast<int>(std::count(rows_.begin(), rows_.end(), -1));
  }

  struct LegendEntry {
    std::string text;
    std::optional<PictureMarkStyle> mark;
    const char* arrow = nullptr;  ///< its colour
    bool is_spring = false;
    int row = 0;
    double left = 0.0;
  };

  void fill_legend() {
    for (const PicturePart& part : picture_.parts) {
      if (part.name.empty()) continue;
      colours_.push_back(fmt::format("#{:06x}", part.colour));
      const bool is_body = !part.faces.empty() || !part.lines.empty();
      legend_.push_back({part.name, PictureMarkStyle{"", is_body ? 5 : 7, 1.3, nullptr}});
      legend_.back().mark->colour = nullptr;
    }
    for (const PictureMark mark : all_marks) {
      if (std::any_of(picture_.places.begin(), picture_.places.end(),
                      [&](const PicturePlace& place) { return place.mark == mark; }))
        legend_.push_back({style_of(mark).name, style_of(mark)});
    }
    using Kind = PictureArrow::Kind;
    for (const Kind kind : {Kind::motion, Kind::load, Kind::normal}) {
      if (std::any_of(picture_.arrows.begin(), picture_.arrows.end(),
                      [&](const PictureArrow& arrow) { return arrow.kind == kind; }))
        legend_.push_back({style_of(kind).name, std::nullopt, style_of(kind).colour});
    }
    if (!picture_.springs.empty()) {
      legend_.push_back({"spring", std::nullopt});
      legend_.back().is_spring = true;
    }
    double at = 0.4;
    int row = 0;
    for (LegendEntry& entry : legend_) {
      const double width = 1.0 + 1.12 * text_width(entry.text, caption_font);
      if (at > 0.4 && at + width > size_.width) {
        at = 0.4;
        ++row;
      }
      entry.left = at;
      entry.row = row;
      at += width + 0.3;
    }
    num_legend_rows_ = legend_.empty() ? 0 : row + 1;
  }

  /// From below: caption, legend, axis, picture, labels.
  void stack() {
    std::string text = picture_.caption;
    if (num_unwritten_ > 0)
      text += fmt::format(" {} more names find no room.", num_unwritten_);
    caption_ = wrapped(text, caption_font, size_.width - 0.9);
    caption_top_ = caption_height(caption_) + 0.1;
    legend_top_ = caption_top_ + 0.1 + num_legend_rows_ * 1.25 * line_height(caption_font);
    canvas_.bottom = legend_top_ + (is_planar() ? 2.6 * line_height(size_.font_size) : 0.3);
    if (!is_planar()) canvas_.bottom = std::max(canvas_.bottom, legend_top_ + 0.3);
    const double top = canvas_.bottom + std::max(canvas_.height(), is_planar() ? 0.0 : 3.2);
    labels_bottom_ = top + 0.35;
    size_.height = labels_bottom_ + num_rows_ * row_height() + 0.3;
  }
  static double row_height() { return 1.15 * line_height(caption_font); }

  std::string place_data() const {
    std::string data;
    for (const PictureMark mark : all_marks) {
      data += fmt::format("$mark_{} << END_OF_DATA\n", static_cast<int>(mark));
      for (const PicturePlace& place : picture_.places) {
        if (place.mark != mark) continue;
        const Eigen::Vector2d at = canvas_.flat(place.at);
        data += fmt::format("{:.9g} {:.9g}\n", as_number(in_units(at.x()), x_scale_),
                            as_number(in_units(at.y()), y_scale_));
      }
      data += "END_OF_DATA\n";
    }
    return data;
  }

  void add_axes(FigureScript& script) const {
    script.set_margins(canvas_.left, canvas_.left + canvas_.width(), canvas_.bottom,
                       canvas_.bottom + canvas_.height());
    script.set_axis('x', x_range_, x_scale_);
    script.set_axis('y', y_range_, y_scale_);
    const double line = line_height(size_.font_size);
    if (is_planar()) {
      script.add("set xtics nomirror\nset ytics nomirror");
      script.add_text(offset_axis_label("x", picture_.unit, x_scale_),
                      canvas_.left + 0.5 * canvas_.width(), canvas_.bottom - 1.9 * line, "center");
      script.add_text(offset_axis_label("y", picture_.unit, y_scale_), 0.7 * line,
                      canvas_.bottom + 0.5 * canvas_.height(), "center rotate");
      return;
    }
    script.add("unset border\nunset tics");
    add_arms(script);
  }

  /// Three arms of a round length that show the directions of x, y and z.
  void add_arms(FigureScript& script) const {
    constexpr double longest = 1.1;
    const double metres = longest / canvas_.cm_per_metre;
    double length = std::pow(10.0, std::floor(std::log10(in_units(metres))));
    for (const double factor : {5.0, 2.0}) {
      if (factor * length * picture_.metres_per_unit <= metres) {
        length *= factor;
        break;
      }
    }
    const Eigen::Vector2d origin(1.35, canvas_.bottom + 1.3);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
      const Eigen::Vector2d arm = length * picture_.metres_per_unit * canvas_.cm_per_metre *
                                  Eigen::Vector2d(picture_.view.right.dot(axis), picture_.view.up.dot(axis));
      add_arrow(script, origin, origin + arm, "#404040", "head filled size screen 0.008,20", 1.2);
      const Eigen::Vector2d beyond = arm.norm() > 0.0 ? Eigen::Vector2d(origin + arm + 0.25 * arm.normalized()) : origin;
      script.add_text(std::string(1, "xyz"[i]), beyond.x(), beyond.y(), "center", caption_font);
    }
    script.add_text(fmt::format("arms: {:g} {}", length, picture_.unit), 0.2, canvas_.bottom + 0.25,
                    "left", 0.9 * caption_font);
  }

  static void add_arrow(FigureScript& script, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                        const char* colour, const char* head, double width) {
    script.add("set arrow from screen {:.6f}, screen {:.6f} to screen {:.6f}, screen {:.6f} {} "
               "linewidth {} linecolor '{}' front",
               script.across(from.x()), script.up(from.y()), script.across(to.x()),
               script.up(to.y()), head, width, colour);
  }

  void add_labels(FigureScript& script) const {
    for (std::size_t i = 0; i < flags_.size(); ++i) {
      if (rows_[i] < 0) continue;
      const Eigen::Vector2d at = canvas_.on_page(canvas_.flat(flags_[i].at));
      const double top = labels_bottom_ + (rows_[i] + 1) * row_height();
      add_arrow(script, at, {at.x(), top}, "#909090", "nohead", 0.6);
      script.add_text(flags_[i].text, at.x() + 0.1, top - 0.5 * row_height(), "left",
                      caption_font);
    }
  }

  void add_arrows(FigureScript& script) const {
    for (const PictureArrow& arrow : picture_.arrows) {
      add_arrow(script, canvas_.on_page(canvas_.flat(arrow.at)),
                canvas_.on_page(canvas_.flat(canvas_.head_of(arrow))), style_of(arrow.kind).colour,
                "head filled size screen 0.012,20", 1.8);
    }
  }

  static void add_spring(FigureScript& script, const Eigen::Vector2d& from,
                         const Eigen::Vector2d& to, bool is_grounded) {
    for (const auto& [begin, end] : spring_lines(from, to, is_grounded))
      add_arrow(script, begin, end, "#404040", "nohead", 1.2);
  }

  void add_legend(FigureScript& script) const {
    std::size_t part = 0;
    int tag = 1000;  // beyond those of texts
    for (const LegendEntry& entry : legend_) {
      const double y = legend_top_ - (entry.row + 0.5) * 1.25 * line_height(caption_font);
      if (entry.is_spring) {
        add_spring(script, {entry.left, y}, {entry.left + 0.7, y}, false);
      } else if (entry.arrow != nullptr) {
        add_arrow(script, {entry.left, y}, {entry.left + 0.7, y}, entry.arrow,
                  "head filled size screen 0.012,20", 1.8);
      } else {
        const std::string colour =
            entry.mark->colour == nullptr ? colours_[part++] : std::string(entry.mark->colour);
        script.add("set label {} '' at screen {:.6f}, screen {:.6f} point pointtype {} pointsize {} "
                   "linewidth 1.6 linecolor rgb '{}'",
                   tag++, script.across(entry.left + 0.35), script.up(y), entry.mark->type,
                   entry.mark->size, colour);
      }
      script.add_text(entry.text, entry.left + 0.85, y, "left", caption_font);
    }
  }

  void add_places(FigureScript& script) const {
    std::string plot = "plot NaN";
    for (const PictureMark mark : all_marks) {
      if (std::none_of(picture_.places.begin(), picture_.places.end(),
                       [&](const PicturePlace& place) { return place.mark == mark; }))
        continue;
      const PictureMarkStyle style = style_of(mark);
      plot += fmt::format(", $mark_{} using 1:2 with points pointtype {} pointsize {} linewidth 1.6 "
                          "linecolor rgb '{}'",
                          static_cast<int>(mark), style.type, style.size, style.colour);
    }
    script.add("{}", plot);
  }

  const MeshPicture& picture_;
  PictureCanvas canvas_;
  FigureSize size_;
  ValueRange x_range_, y_range_;  ///< in the unit of the picture
  AxisScale x_scale_, y_scale_;
  std::vector<Flag> flags_;
  std::vector<int> rows_;  ///< of them
  int num_rows_ = 0;
  int num_unwritten_ = 0;
  std::vector<LegendEntry> legend_;
  std::vector<std::string> colours_;  ///< of the parts in it
  int num_legend_rows_ = 0;
  std::vector<std::string> caption_;
  double caption_top_ = 0.0, legend_top_ = 0.0, labels_bottom_ = 0.0;
};

}  // namespace

PictureView PictureView::isometric() {
  const Eigen::Vector3d towards = Eigen::Vector3d(1.0, -1.0, 1.0).normalized();
  const Eigen::Vector3d right = Eigen::Vector3d(1.0, 1.0, 0.0).normalized();
  return {right, towards.cross(right), towards, false};
}

PictureColour part_colour(std::size_t number) {
  constexpr std::array<PictureColour, 8> colours{0x0b5394, 0xc0392b, 0x38761d, 0x741b47,
                                                 0xb45f06, 0x134f5c, 0x7f6000, 0x666666};
  return colours[number % colours.size()];
}

void draw_mesh_picture(const MeshPicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  MeshFigure(picture).draw(figure);
}

}  // namespace stridor
