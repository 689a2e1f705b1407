#include "io/shape_plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "io/vtk_writer.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

/// A square of side 1 m whose upper edge moves along x, its right end a quarter of a period late.
BodyShape square() {
  BodyShape body;
  body.name = "square";
  body.nodes.resize(4, 2);
  body.nodes << 0, 0, 1, 0, 1, 1, 0, 1;
  body.displacement = Eigen::MatrixX2cd::Zero(4, 2);
  body.displacement(2, 0) = {0.0, -0.5};
  body.displacement(3, 0) = 1.0;
  body.outlines = {{0, 1, 2, 3, 0}};
  return body;
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
  const std::string parts = contents_of(files[0]);
  EXPECT_THAT(parts, HasSubstr("POINTS 8 double\n"));
  EXPECT_THAT(parts, HasSubstr("LINES 2 12\n5 0 1 2 3 0\n5 4 5 6 7 4\n"));
  EXPECT_THAT(parts, HasSubstr("VECTORS imaginary double\n0 0 0\n0 0 0\n-0.5 0 0\n"));
  // A quarter of a period: Re(-0.5j e^{jπ/2}) = 0.5.
  EXPECT_THAT(contents_of(files[2]), HasSubstr("0.5 0 0\n"));
}

TEST(VtkWriter, WrongIndicesAndVectorsAreRefused) {
  const TemporaryFolder folder;
  VtkLines data;
  data.points = Eigen::MatrixX2d::Zero(2, 2);
  data.lines = {{0, 2}};
  EXPECT_THAT(message_of<std::invalid_argument>([&] { write_vtk(folder / "a.vtk", data); }),
              HasSubstr("write_vtk: there is no point 2"));
  data.lines = {{0, 1}};
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
