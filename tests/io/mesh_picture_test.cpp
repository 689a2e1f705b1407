#include "io/figures/mesh_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <sstream>

#include "core/errors.hpp"
#include "io/figures/picture_canvas.hpp"
#include "io/figures/picture_flags.hpp"
#include "io/figures/picture_styles.hpp"
#include "tests/support/element_meshes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<DrawnElement> elements_of(const Mesh& mesh) {
  std::vector<DrawnElement> elements;
  for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
    const std::span<const int> nodes = mesh.nodes_of(e);
    elements.push_back({mesh.shapes[e], {nodes.begin(), nodes.end()}});
  }
  return elements;
}

PicturePart block(ElementShape shape) {
  const Mesh mesh = box_mesh(shape, {3, 2, 2}, {0.03, 0.02, 0.01});
  PicturePart part;
  part.name = "block";
  part.nodes = mesh.nodes;
  part.faces = face_loops(elements_of(mesh));
  part.is_closed = facts_of(shape).dimension == 3;
  return part;
}

Eigen::Vector3d area_of(const PicturePart& part, const std::vector<int>& face) {
  Eigen::Vector3d twice = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < face.size(); ++k) {
    const Eigen::Vector3d a = part.nodes.row(face[k]);
    const Eigen::Vector3d b = part.nodes.row(face[(k + 1) % face.size()]);
    twice += a.cross(b);
  }
  return 0.5 * twice;
}

TEST(MeshPicture, FacesSurroundABlockOfEveryShapeOfElement) {
  for (const ElementShape shape : element_shapes) {
    const PicturePart part = block(shape);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double area = 0.0;
    double volume = 0.0;
    for (const std::vector<int>& face : part.faces) {
      const Eigen::Vector3d of_face = area_of(part, face);
      Eigen::Vector3d centre = Eigen::Vector3d::Zero();
      for (const int node : face)
        centre += part.nodes.row(node).transpose() / static_cast<double>(face.size());
      sum += of_face;
      area += of_face.norm();
      volume += of_face.dot(centre) / 3.0;
    }
    if (part.is_closed) {
      // A closed surface; ∮ x·n dA = 3 V.
      EXPECT_LT(sum.norm(), 1e-15) << facts_of(shape).name;
      EXPECT_NEAR(area, 2.0 * (0.03 * 0.02 + 0.03 * 0.01 + 0.02 * 0.01), 1e-12);
      EXPECT_NEAR(volume, 0.03 * 0.02 * 0.01, 1e-15);
    } else {
      EXPECT_NEAR(sum.z(), 0.03 * 0.02, 1e-12) << facts_of(shape).name;
    }
  }
}

/// Polygons of a data block by their corners, with the colour.
std::vector<std::pair<int, unsigned>> polygons_of(const std::string& data) {
  std::vector<std::pair<int, unsigned>> polygons;
  std::istringstream lines(data);
  std::string line;
  std::getline(lines, line);
  int corners = 0;
  unsigned colour = 0;
  while (std::getline(lines, line) && line != "END_OF_DATA") {
    if (line.empty()) {
      polygons.emplace_back(corners, colour);
      corners = 0;
      continue;
    }
    std::istringstream numbers(line);
    double x = 0.0, y = 0.0;
    numbers >> x >> y >> colour;
    ++corners;
  }
  return polygons;
}

TEST(MeshPicture, FacesThatLookAwayAreNotDrawnAndNearerOnesComeLast) {
  MeshPicture picture;
  picture.view = PictureView::isometric();
  PicturePart near = block(ElementShape::hex8);
  PicturePart far = near;
  far.colour = 0xff0000;
  // Away from the viewer.
  far.nodes.rowwise() -= picture.view.towards.transpose();
  picture.parts = {near, far};
  PictureCanvas canvas(picture);
  const auto polygons = polygons_of(polygon_data("$faces", picture, canvas));
  // Three sides of six are seen, of 2*3, 3*2 and 2*2 elements, each with a polygon and four edges.
  EXPECT_EQ(polygons.size(), 2u * (6 + 6 + 4) * 5u);
  const auto is_red = [](unsigned colour) { return (colour >> 16) > (colour & 0xffu); };
  for (std::size_t i = 0; i < polygons.size(); ++i)
    EXPECT_EQ(is_red(polygons[i].second), i < polygons.size() / 2) << i;
}

TEST(MeshPicture, LabelsNeverOverlapOneAnotherOrALineDown) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.0, 14.0), width(0.5, 4.0);
  for (int round = 0; round < 50; ++round) {
    std::vector<FlagRequest> flags;
    for (int i = 0; i < 12; ++i) flags.push_back({place(random), width(random)});
    const std::vector<int> rows = flag_rows(flags, 0.1, 20);
    for (std::size_t a = 0; a < flags.size(); ++a) {
      ASSERT_GE(rows[a], 0);
      for (std::size_t b = 0; b < flags.size(); ++b) {
        if (a == b) continue;
        const bool reaches_over = flags[b].x >= flags[a].x && flags[b].x < flags[a].x + flags[a].width;
        // The line of b goes down from its row, so a text over it must be above that.
        if (reaches_over) {
          EXPECT_GT(rows[a], rows[b]);
        }
      }
    }
  }
  const std::vector<FlagRequest> same{{1.0, 2.0}, {1.0, 2.0}, {1.0, 2.0}};
  EXPECT_THAT(flag_rows(same, 0.1, 2), ElementsAre(0, 1, -1));
}

TEST(MeshPicture, DrawsBodiesPlacesArrowsAndLabelsInEveryFormat) {
  const TemporaryFolder folder;
  for (const ElementShape shape : {ElementShape::quad8, ElementShape::tet10}) {
    MeshPicture picture;
    picture.parts = {block(shape)};
    picture.view = picture.parts[0].is_closed ? PictureView::isometric() : PictureView::plane();
    picture.unit = "mm";
    picture.metres_per_unit = 1e-3;
    picture.places = {{{0.0, 0.0, 0.0}, PictureMark::held}, {{0.03, 0.02, 0.0}, PictureMark::contact}};
    picture.arrows = {{{0.03, 0.02, 0.0}, {0.0, 1.0, 0.0}, PictureArrow::Kind::load}};
    picture.labels = {{{0.03, 0.02, 0.0}, "block", "corner", 0},
                      {{0.03, 0.02, 0.0}, "block", "tip", 1},
                      {{0.0, 0.0, 0.0}, "", "origin", 0}};
    picture.caption = "A block.";
    for (const char* name : {"a.svg", "a.png", "a.pdf"}) {
      draw_mesh_picture(picture, folder / name);
      EXPECT_GT(std::filesystem::file_size(folder / name), 2000u);
    }
    const std::string text = contents_of(folder / "a.svg");
    for (const char* word : {"block", "held", "slave point", "load", "block.tip, corner", "origin",
                             "A block.", "mm"})
      EXPECT_THAT(text, HasSubstr(word));
  }
}

TEST(MeshPicture, ASpringGoesFromEndToEndAndShowsTheGround) {
  const Eigen::Vector2d from(1.0, 2.0);
  const Eigen::Vector2d to(4.0, 6.0);
  const auto lines = spring_lines(from, to, false);
  ASSERT_GT(lines.size(), 6U);
  EXPECT_EQ(lines.front().first, from);
  EXPECT_EQ(lines.back().second, to);
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) EXPECT_EQ(lines[i].second, lines[i + 1].first);
  const auto grounded = spring_lines(from, to, true);
  ASSERT_EQ(grounded.size(), lines.size() + 5);  // a bar and four hatches
  const auto& bar = grounded[lines.size()];
  EXPECT_NEAR((bar.second - bar.first).dot(to - from), 0.0, 1e-12);
  EXPECT_NEAR((0.5 * (bar.first + bar.second) - to).norm(), 0.0, 1e-12);
  EXPECT_TRUE(spring_lines(from, from, true).empty());
}

TEST(MeshPicture, RefusesNothingToDrawAndOtherNames) {
  const TemporaryFolder folder;
  EXPECT_THAT(message_of<std::invalid_argument>([&] { draw_mesh_picture({}, folder / "a.svg"); }),
              HasSubstr("nothing to draw"));
  EXPECT_THAT(message_of<ConfigError>([&] { draw_mesh_picture({}, folder / "a.gif"); }),
              HasSubstr("must end with"));
}

}  // namespace
}  // namespace stridor
