#include "io/figures/shape_plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <iterator>
#include <map>
#include <sstream>

#include "core/errors.hpp"
#include "io/results/vtu_writer.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A square of side 1 m, one Q8 element, whose upper edge moves along x, its right end a quarter of
/// a period late.
BodyShape square() {
  BodyShape body;
  body.name = "square";
  body.nodes = Eigen::MatrixX3d::Zero(8, 3);
  body.nodes.leftCols(2) << 0, 0, 1, 0, 1, 1, 0, 1, 0.5, 0, 1, 0.5, 0.5, 1, 0, 0.5;
  body.displacement = Eigen::MatrixX3cd::Zero(8, 3);
  body.displacement(2, 0) = {0.0, -0.5};
  body.displacement(3, 0) = 1.0;
  body.outlines = {{0, 1, 2, 3, 0}};
  body.elements = {{ElementShape::quad8, {0, 1, 2, 3, 4, 5, 6, 7}}};
  return body;
}

/// Unstructured grid as a reader of VTK's XML format sees it.
struct VtkContents {
  std::vector<std::array<double, 3>> points;
  std::vector<std::vector<int>> cells;
  std::vector<int> types;
  std::vector<int> bodies;
  std::map<std::string, std::vector<std::array<double, 3>>> vectors;
};

/// Numbers of the array of a name.
std::vector<double> array_of(const std::string& text, const std::string& name) {
  const std::size_t at = text.find("Name=\"" + name + "\"");
  EXPECT_NE(at, std::string::npos) << name;
  const std::size_t begin = text.find('>', at) + 1;
  std::istringstream numbers(text.substr(begin, text.find("</DataArray>", begin) - begin));
  return {std::istream_iterator<double>(numbers), {}};
}

std::vector<std::array<double, 3>> triples_of(const std::vector<double>& numbers) {
  std::vector<std::array<double, 3>> triples;
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
    triples.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  return triples;
}

std::vector<int> integers_of(const std::vector<double>& numbers) {
  return {numbers.begin(), numbers.end()};
}

VtkContents read_vtu(const std::filesystem::path& path) {
  const std::string text = contents_of(path);
  EXPECT_THAT(text, ::testing::StartsWith("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\""));
  VtkContents contents;
  contents.points = triples_of(array_of(text, "points"));
  const std::vector<int> connectivity = integers_of(array_of(text, "connectivity"));
  int first = 0;
  for (const int end : integers_of(array_of(text, "offsets"))) {
    contents.cells.emplace_back(connectivity.begin() + first, connectivity.begin() + end);
    first = end;
  }
  contents.types = integers_of(array_of(text, "types"));
  contents.bodies = integers_of(array_of(text, "body"));
  for (const char* name : {"real", "imaginary", "displacement"}) {
    if (text.find("Name=\"" + std::string(name) + "\"") != std::string::npos)
      contents.vectors[name] = triples_of(array_of(text, name));
  }
  return contents;
}

TEST(ShapeScale, LargestDisplacementBecomesAFixedShareOfTheExtent) {
  EXPECT_NEAR(shape_scale({square()}), 0.06 * std::sqrt(2.0), 1e-15);
  BodyShape still = square();
  still.displacement.setZero();
  EXPECT_EQ(shape_scale({still}), 0.0);
}

TEST(ShapePlot, BothPartsAreDrawn) {
  const TemporaryFolder folder;
  plot_shape({{square()}, {{0.5, 1.0}}, "A caption."}, folder / "shape.svg");
  const std::string svg = contents_of(folder / "shape.svg");
  for (const char* text : {"real part", "imaginary part", "A caption."})
    EXPECT_THAT(svg, HasSubstr(text));
  // The sides of the element are drawn thinner than the outline.
  BodyShape bare = square();
  bare.elements.clear();
  plot_shape({{bare}, {{0.5, 1.0}}, "A caption."}, folder / "bare.svg");
  EXPECT_GT(svg.size(), contents_of(folder / "bare.svg").size());
  EXPECT_THAT(message_of<std::invalid_argument>([&] { plot_shape({}, folder / "none.svg"); }),
              HasSubstr("there is no node"));
}

TEST(ShapePlot, NodesAloneAreDrawnAtRestAndWhereTheyMove) {
  const TemporaryFolder folder;
  BodyShape tested = square();
  tested.outlines.clear();
  tested.elements.clear();
  plot_shape({{tested}, {}, "A body of matrices."}, folder / "nodes.svg");
  const std::string svg = contents_of(folder / "nodes.svg");
  const auto marks_of = [&](const std::string& mark) {
    int marks = 0;
    for (std::size_t at = svg.find(mark); at != std::string::npos; at = svg.find(mark, at + 1))
      ++marks;
    return marks;
  };
  EXPECT_EQ(marks_of("xlink:href='#gpPt5'"), 2 * 8 + 1);  // circles in both diagrams, and in a dot
  EXPECT_EQ(marks_of("xlink:href='#gpPt6'"), 2 * 8);  // dots
  // One node, and a motion along one line: a picture all the same.
  tested.nodes = Eigen::MatrixX3d::Zero(1, 3);
  tested.displacement = Eigen::MatrixX3cd::Constant(1, 3, 0.0);
  tested.displacement(0, 0) = 1.0;
  EXPECT_DOUBLE_EQ(shape_scale({tested}), 0.06);
  plot_shape({{tested}, {}, "A mass."}, folder / "mass.svg");
  EXPECT_GT(std::filesystem::file_size(folder / "mass.svg"), 1000U);
}

TEST(ShapeFrames, HoldOnePeriod) {
  const TemporaryFolder folder;
  const auto files =
      write_shape_frames({{square(), square()}, {}, "two squares"}, folder / "mode", 4, 0.02);
  ASSERT_EQ(files.size(), 6u);
  EXPECT_EQ(files[0].filename(), "mode.vtu");
  EXPECT_EQ(files[4].filename(), "mode_frame_003.vtu");
  EXPECT_THAT(contents_of(files[5]),
              AllOf(HasSubstr("type=\"Collection\""),
                    HasSubstr("timestep=\"0.015\" part=\"0\" file=\"mode_frame_003.vtu\"")));
  const VtkContents parts = read_vtu(files[0]);
  using Triples = std::vector<std::array<double, 3>>;
  EXPECT_EQ(parts.points.size(), 16u);
  EXPECT_EQ(parts.cells, (std::vector<std::vector<int>>{{0, 1, 2, 3, 4, 5, 6, 7},
                                                        {8, 9, 10, 11, 12, 13, 14, 15}}));
  constexpr int quadratic_quad = 23;  // of vtkCellType.h
  EXPECT_EQ(parts.types, (std::vector<int>{quadratic_quad, quadratic_quad}));
  EXPECT_EQ(parts.bodies, (std::vector<int>{0, 1}));
  const Triples& real = parts.vectors.at("real");
  const Triples& imaginary = parts.vectors.at("imaginary");
  EXPECT_EQ(real[3], (std::array{1.0, 0.0, 0.0}));
  EXPECT_EQ(imaginary[10], (std::array{-0.5, 0.0, 0.0}));
  // A quarter of a period: Re(-0.5j e^{jπ/2}) = 0.5. The nodes move by the enlarged displacement.
  const VtkContents frame = read_vtu(files[2]);
  const double displacement = frame.vectors.at("displacement")[2][0];
  EXPECT_NEAR(displacement, 0.5, 1e-8);
  EXPECT_NEAR(frame.points[2][0], 1.0 + shape_scale({square()}) * displacement, 1e-8);
}

TEST(ShapePlot, BodiesInSpaceAreSeenFromAbove) {
  const TemporaryFolder folder;
  BodyShape block;
  block.name = "block";
  block.nodes.resize(8, 3);
  block.nodes << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  block.displacement = Eigen::MatrixX3cd::Zero(8, 3);
  block.displacement(6, 2) = 1.0;
  block.elements = {{ElementShape::hex8, {0, 1, 2, 3, 4, 5, 6, 7}}};
  plot_shape({{block}, {}, "A block."}, folder / "shape.svg");
  EXPECT_THAT(contents_of(folder / "shape.svg"), HasSubstr("upwards"));
  const VtkContents frame =
      read_vtu(write_shape_frames({{block}, {}, ""}, folder / "mode", 1, 1.0)[1]);
  EXPECT_NEAR(frame.points[6][2], 1.0 + shape_scale({block}), 1e-8);
  constexpr int hexahedron = 12;
  EXPECT_EQ(frame.types, (std::vector<int>{hexahedron}));
}

TEST(ShapePlot, BodiesInSpaceOfManyElementsShowTheirOuterFaces) {
  const TemporaryFolder folder;
  constexpr int n = 18;  // 5,832 elements, of which 6 n² sides are outside
  const auto node = [](int i, int j, int k) { return (k * (n + 1) + j) * (n + 1) + i; };
  BodyShape block;
  block.name = "block";
  block.nodes.resize((n + 1) * (n + 1) * (n + 1), 3);
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) block.nodes.row(node(i, j, k)) << i, j, k;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        block.elements.push_back({ElementShape::hex8,
                                  {node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k),
                                   node(i, j + 1, k), node(i, j, k + 1), node(i + 1, j, k + 1),
                                   node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)}});
      }
    }
  }
  block.displacement = Eigen::MatrixX3cd::Zero(block.nodes.rows(), 3);
  block.displacement(0, 2) = 1.0;
  plot_shape({{block}, {}, "A block."}, folder / "shape.svg");
  const std::string drawn = contents_of(folder / "shape.svg");
  int num_polygons = 0;
  for (std::size_t at = drawn.find("<polygon"); at != std::string::npos;
       at = drawn.find("<polygon", at + 1))
    ++num_polygons;
  EXPECT_GE(num_polygons, 2 * 6 * n * n);  // of both phases
}

TEST(ShapeFrames, OfABodyWithoutElementsHoldItsOutline) {
  const TemporaryFolder folder;
  BodyShape outline = square();
  outline.elements.clear();
  const VtkContents parts =
      read_vtu(write_shape_frames({{outline, square()}, {}, ""}, folder / "mode", 1, 1.0)[0]);
  constexpr int poly_line = 4;
  constexpr int quadratic_quad = 23;
  EXPECT_EQ(parts.types, (std::vector<int>{poly_line, quadratic_quad}));
  EXPECT_EQ(parts.bodies, (std::vector<int>{0, 1}));
  EXPECT_EQ(parts.cells[0], (std::vector<int>{0, 1, 2, 3, 0}));
}

TEST(VtuWriter, WrongIndicesAndVectorsAreRefused) {
  const TemporaryFolder folder;
  VtkMesh data;
  data.points = Eigen::MatrixX3d::Zero(2, 3);
  data.cells = {{VtkMesh::poly_line, {0, 2}}};
  EXPECT_THAT(message_of<std::invalid_argument>([&] { write_vtu(folder / "a.vtu", data); }),
              HasSubstr("write_vtu: the bodies of 0 cells are given, of 1"));
  data.parts = {0};
  EXPECT_THAT(message_of<std::invalid_argument>([&] { write_vtu(folder / "a.vtu", data); }),
              HasSubstr("write_vtu: there is no point 2"));
  data.cells = {{VtkMesh::poly_line, {0, 1}}};
  data.vectors = {{"u", Eigen::MatrixX3d::Zero(3, 3)}};
  EXPECT_THAT(message_of<std::invalid_argument>([&] { write_vtu(folder / "a.vtu", data); }),
              HasSubstr("write_vtu: 3 vectors 'u' for 2 points"));
  data.vectors.clear();
  EXPECT_THAT(message_of<FileError>([&] { write_vtu(folder / "none" / "a.vtu", data); }),
              HasSubstr("cannot be written"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace stridor
