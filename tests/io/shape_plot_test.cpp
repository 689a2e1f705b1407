#include "io/figures/shape_plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "core/errors.hpp"
#include "io/results/vtk_writer.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

/// A square of side 1 m, one Q8 element, whose upper edge moves along x, its right end a quarter of
/// a period late.
BodyShape square() {
  BodyShape body;
  body.name = "square";
  body.nodes.resize(8, 2);
  body.nodes << 0, 0, 1, 0, 1, 1, 0, 1, 0.5, 0, 1, 0.5, 0.5, 1, 0, 0.5;
  body.displacement = Eigen::MatrixX2cd::Zero(8, 2);
  body.displacement(2, 0) = {0.0, -0.5};
  body.displacement(3, 0) = 1.0;
  body.outlines = {{0, 1, 2, 3, 0}};
  body.elements = {{ElementShape::quad8, {0, 1, 2, 3, 4, 5, 6, 7}}};
  return body;
}

/// Unstructured grid as a reader of VTK's legacy format sees it.
struct VtkContents {
  std::vector<std::array<double, 3>> points;
  std::vector<std::vector<int>> cells;
  std::vector<int> types;
  std::vector<int> bodies;
  std::map<std::string, std::vector<std::array<double, 3>>> vectors;
};

VtkContents read_vtk(const std::filesystem::path& path) {
  std::istringstream file(contents_of(path));
  VtkContents contents;
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "# vtk DataFile Version 3.0");
  std::getline(file, line);
  std::string word;
  file >> word;
  EXPECT_EQ(word, "ASCII");
  const auto read_triples = [&](std::vector<std::array<double, 3>>& triples) {
    for (auto& [x, y, z] : triples) file >> x >> y >> z;
  };
  std::size_t count = 0;
  while (file >> word) {
    if (word == "DATASET") {
      file >> word;
      EXPECT_EQ(word, "UNSTRUCTURED_GRID");
    } else if (word == "POINTS") {
      file >> count >> word;
      contents.points.resize(count);
      read_triples(contents.points);
    } else if (word == "CELLS") {
      std::size_t num_indices = 0;
      file >> count >> num_indices;
      contents.cells.resize(count);
      for (auto& cell : contents.cells) {
        file >> count;
        num_indices -= count + 1;
        cell.resize(count);
        for (int& index : cell) file >> index;
      }
      EXPECT_EQ(num_indices, 0u);
    } else if (word == "CELL_TYPES") {
      file >> count;
      contents.types.resize(count);
      for (int& type : contents.types) file >> type;
    } else if (word == "SCALARS") {
      file >> word >> word >> word >> word >> word;
      contents.bodies.resize(contents.cells.size());
      for (int& body : contents.bodies) file >> body;
    } else if (word == "VECTORS") {
      std::string name;
      file >> name >> word;
      contents.vectors[name].resize(contents.points.size());
      read_triples(contents.vectors[name]);
    } else {
      EXPECT_THAT(word, ::testing::AnyOf("CELL_DATA", "POINT_DATA"));
      file >> count;
    }
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

TEST(ShapeFrames, HoldOnePeriod) {
  const TemporaryFolder folder;
  const auto files =
      write_shape_frames({{square(), square()}, {}, "two squares"}, folder / "mode", 4);
  ASSERT_EQ(files.size(), 5u);
  EXPECT_EQ(files[0].filename(), "mode.vtk");
  EXPECT_EQ(files[4].filename(), "mode_frame_003.vtk");
  const VtkContents parts = read_vtk(files[0]);
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
  const VtkContents frame = read_vtk(files[2]);
  const double displacement = frame.vectors.at("displacement")[2][0];
  EXPECT_NEAR(displacement, 0.5, 1e-8);
  EXPECT_NEAR(frame.points[2][0], 1.0 + shape_scale({square()}) * displacement, 1e-8);
}

TEST(ShapeFrames, OfABodyWithoutElementsHoldItsOutline) {
  const TemporaryFolder folder;
  BodyShape outline = square();
  outline.elements.clear();
  const VtkContents parts =
      read_vtk(write_shape_frames({{outline, square()}, {}, ""}, folder / "mode", 1)[0]);
  constexpr int poly_line = 4;
  constexpr int quadratic_quad = 23;
  EXPECT_EQ(parts.types, (std::vector<int>{poly_line, quadratic_quad}));
  EXPECT_EQ(parts.bodies, (std::vector<int>{0, 1}));
  EXPECT_EQ(parts.cells[0], (std::vector<int>{0, 1, 2, 3, 0}));
}

TEST(VtkWriter, WrongIndicesAndVectorsAreRefused) {
  const TemporaryFolder folder;
  VtkMesh data;
  data.points = Eigen::MatrixX2d::Zero(2, 2);
  data.cells = {{VtkMesh::poly_line, {0, 2}}};
  EXPECT_THAT(message_of<std::invalid_argument>([&] { write_vtk(folder / "a.vtk", data); }),
              HasSubstr("write_vtk: the bodies of 0 cells are given, of 1"));
  data.parts = {0};
  EXPECT_THAT(message_of<std::invalid_argument>([&] { write_vtk(folder / "a.vtk", data); }),
              HasSubstr("write_vtk: there is no point 2"));
  data.cells = {{VtkMesh::poly_line, {0, 1}}};
  data.vectors = {{"u", Eigen::MatrixX2d::Zero(3, 2)}};
  EXPECT_THAT(message_of<std::invalid_argument>([&] { write_vtk(folder / "a.vtk", data); }),
              HasSubstr("write_vtk: 3 vectors 'u' for 2 points"));
  data.vectors.clear();
  EXPECT_THAT(message_of<FileError>([&] { write_vtk(folder / "none" / "a.vtk", data); }),
              HasSubstr("cannot be written"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace stridor
