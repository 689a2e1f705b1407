#include "io/imports/uff_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/imports/uff_lines.hpp"
#include "io/results/uff_writer.hpp"
#include "substructures/elements/shape_functions.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/uff_text.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::string dataset(const std::string& body) {
  return "    -1\n" + body + "    -1\n";
}

/// Millimetres, mN: a mass in kg.
const std::string units = dataset(
    "   164\n         5mm (milli-newton)         2\n"
    "    1.0000000000000000D+03    1.0000000000000000D+03    1.0000000000000000D+00\n"
    "    2.7314999999999998D+02\n");
const std::string nodes = dataset(
    "  2411\n         1         0         0        11\n"
    "    0.0000000000000000D+00    1.0000000000000000D+01   -1.0000000000000000D+00\n"
    "         7         0         0        11\n"
    "    2.5000000000000000D+01    0.0000000000000000D+00    0.0000000000000000D+00\n");

/// A real normal mode of 812.5 Hz, mass 2 kg, damping 0.4 %.
std::string real_mode(const std::string& values = "  1.00000E+00 -2.50000E-01  0.00000E+00\n") {
  return dataset("    55\nmode\nNONE\nNONE\nNONE\nNONE\n"
                 "         1         2         2         8         2         3\n"
                 "         2         4         0         3\n"
                 "  8.12500E+02  2.00000E+00  4.00000E-03  0.00000E+00\n"
                 "         7\n" +
                 values);
}

ModalTest read(const std::string& text) { return read_uff({"a.uff", text}); }

TEST(Uff, NodesUnitsAndNormalModes) {
  const ModalTest test = read(dataset("   151\nanything\n") + units + nodes + real_mode());
  EXPECT_THAT(test.nodes, SizeIs(2));
  EXPECT_NEAR((test.nodes.at(7) - Eigen::Vector3d(0.025, 0.0, 0.0)).norm(), 0.0, 1e-15);
  ASSERT_THAT(test.modes, SizeIs(1));
  const TestMode& mode = test.modes[0];
  EXPECT_EQ(mode.number, 3);
  EXPECT_DOUBLE_EQ(mode.frequency, 812.5);
  EXPECT_DOUBLE_EQ(mode.damping_ratio, 0.004);
  EXPECT_DOUBLE_EQ(mode.modal_mass, 2.0);
  EXPECT_EQ(mode.shape.at(7)[1], -0.25);
  EXPECT_EQ(mode.source, "a.uff:19");
  EXPECT_TRUE(test.remarks.empty());
  // Without units they are SI, and said to be.
  const ModalTest plain = read(nodes + real_mode());
  EXPECT_DOUBLE_EQ(plain.nodes.at(7).x(), 25.0);
  EXPECT_THAT(plain.remarks, ElementsAre(HasSubstr("has no units")));
}

TEST(Uff, ComplexModesHaveTheirScaleFromModalA) {
  // s = ω(−ζ ± i√(1−ζ²)) with a = 2 i ω_d m for a shape that is real, turned by 30°.
  const double omega = 2.0 * std::numbers::pi * 500.0;
  const double damped = omega * std::sqrt(1.0 - 0.02 * 0.02);
  const std::complex<double> turn = std::polar(1.0, std::numbers::pi / 6.0);
  const std::complex<double> a = std::complex<double>(0.0, 2.0 * damped * 1.5) * turn * turn;
  for (const int analysis : {3, 7}) {
    const std::string text = dataset(fmt::format(
        "    55\nmode\nNONE\nNONE\nNONE\nNONE\n{:10}{:10}{:10}{:10}{:10}{:10}\n{:10}{:10}{:10}{:10}\n"
        "{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n{:10}\n"
        "{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n",
        1, analysis, 2, 8, 5, 3, 2, 6, 0, 1, -0.02 * omega, damped, a.real(), a.imag(), 0.0, 0.0, 4,
        turn.real(), turn.imag(), 0.0, 0.0, -turn.real(), -turn.imag()));
    const TestMode mode = read(text).modes.at(0);
    EXPECT_TRUE(mode.is_complex);
    // Six digits are written.
    EXPECT_NEAR(mode.frequency, 500.0, 5e-3);
    EXPECT_NEAR(mode.damping_ratio, 0.02, 1e-6);
    EXPECT_NEAR(mode.modal_mass, 1.5, 1e-4);
    EXPECT_NEAR(std::abs(mode.shape.at(4)[2] + turn), 0.0, 1e-5);
  }
}

TEST(Uff, DefectsOfRealFilesAreTolerated) {
  const std::string text = units + nodes + real_mode();
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_THAT(read(crlf).modes, SizeIs(1));
  // The last dataset is not closed; a delimiter stands twice; texts are not ASCII.
  EXPECT_THAT(read(text.substr(0, text.size() - 7)).modes, SizeIs(1));
  for (const char* stray : {"    -1\n", "    -1\n    -1\n"})
    EXPECT_THAT(read(stray + text).modes, SizeIs(1));
  EXPECT_THAT(read(dataset("   151\n\xb5m/s\xb2\n") + text).modes, SizeIs(1));
  // Numbers run together in their columns.
  const ModalTest joined = read(units + nodes + real_mode("-1.00000E+000-2.50000E-001-1.00000E+000\n"));
  EXPECT_EQ(joined.modes[0].shape.at(7)[2], -1.0);
  // −1 in a coordinate or as a label is no delimiter.
  const ModalTest minus =
      read(dataset("    15\n        -1         0         0        11 -1.00000E+00 -1.00000E+00 -1.00000E+00\n") +
           real_mode());
  EXPECT_EQ(minus.nodes.at(-1).x(), -1.0);
  // Binary data are passed over, and may hold a delimiter; -1 need not stand in a line of its own.
  const std::string binary = "    -1\n    58b     1     2           2          12           0           0"
                             "           0           0\none\ntwo\nab\n    -1\ncd" "    -1\n";
  EXPECT_THAT(read(binary + text).modes, SizeIs(1));
}

TEST(Uff, WrongFilesAreAnsweredWithPlaceAndWhatWasExpected) {
  const auto message = [](const std::string& text) {
    return message_of<ConfigError>([&] { read(text); });
  };
  EXPECT_THAT(message("hello\n"), AllOf(HasSubstr("a.uff:1:1"), HasSubstr("expected -1"), HasSubstr("hello")));
  EXPECT_THAT(message("    -1\nabc\n    -1\n"), HasSubstr("a.uff:2:1: expected the number of a dataset"));
  EXPECT_THAT(message(nodes), HasSubstr("expected mode shapes (dataset 55"));
  EXPECT_THAT(message(real_mode("  1.0 two 3.0\n")),
              AllOf(HasSubstr("a.uff:12:1"), HasSubstr("expected the values at a node")));
  EXPECT_THAT(message(real_mode("  1.0 2.0\n")), HasSubstr("ends here; expected the values at a node"));
  EXPECT_THAT(message(real_mode("  1.0 2.0 3.0 4.0\n")), HasSubstr("3 numbers, got 4"));
  EXPECT_THAT(message(real_mode("")), HasSubstr("expected the values at a node"));
  EXPECT_THAT(message(dataset("   164\n 1 SI 2\n 0.0 1.0 1.0\n") + real_mode()),
              HasSubstr("positive factors of length and force"));
  EXPECT_THAT(message(nodes + dataset("  2411\n 7 0 0 11\n 1.0 2.0 3.0\n") + real_mode()),
              HasSubstr("node 7 is given a second time, elsewhere"));
  std::string scalar = real_mode();
  scalar.replace(scalar.find("2         8"), 11, "1         8");
  EXPECT_THAT(message(scalar), HasSubstr("expected three translations at each node"));
  EXPECT_THAT(
      message("    -1\n    58b     1     2           2         999\none\ntwo\n"),
      HasSubstr(
          "none of these, but 1 with functions (58), which `stridor frf SCENE --compare FILE`"));
  EXPECT_THAT(message_of<FileError>([] { read_uff_file("/nowhere/a.uff"); }),
              HasSubstr("expected a universal file"));
}

ModalTest drawn(const std::string& text) {
  const SourceText source{"a.uff", text};
  return modal_test_in(uff_datasets(source));
}

TEST(Uff, TraceLinesJoinNodesAndAZeroLiftsThePen) {
  using Lines = std::vector<std::vector<std::int64_t>>;
  const std::string head = "    82\n         1        10         7\n";
  const Lines expected{{1, 2, 3}, {4, 5, 6, 7, 8}};
  const std::string labels =
      "         1         2         3         0         0         4         5         6\n         "
      "7         8\n";
  EXPECT_EQ(drawn(dataset(head + "frame\n" + labels)).lines, expected);
  // Without a name, padded, with line ends of Windows.
  EXPECT_EQ(drawn(dataset(head + labels)).lines, expected);
  EXPECT_EQ(drawn(dataset(head + "NONE\n" + labels + "         0         0\n")).lines, expected);
  std::string windows;
  for (const char c : dataset(head + "NONE\n" + labels))
    windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(drawn(windows).lines, expected);
  // Two in one dataset; a pair of pens lifted leaves no line.
  EXPECT_EQ(
      drawn(
          dataset(
              "    82\n         1         2\nNONE\n         1         2\n         2         2\nb\n"
              "         5         0\n"))
          .lines,
      (Lines{{1, 2}}));
  // Labels of ten digits leave no blanks between them.
  EXPECT_EQ(drawn(dataset("    82\n         1         2\nNONE\n10000000011000000002\n")).lines,
            (Lines{{1000000001, 1000000002}}));
  const ModalTest cut = drawn(
      dataset("    82\n         4         5         1\nNONE\n         1         2         3\n"));
  EXPECT_EQ(cut.lines, (Lines{{1, 2, 3}}));
  EXPECT_THAT(cut.remarks.front(),
              HasSubstr("a.uff:3: 2 of 5 nodes of the trace line 4 are missing"));
}

TEST(Uff, BeamsAreLinesWithOrWithoutTheirOrientationAndOthersAreToldOf) {
  const std::string head = "  2412\n         1        21         1         1         7         2\n";
  const std::vector<std::vector<std::int64_t>> expected{{4, 9}};
  EXPECT_EQ(drawn(dataset(head + "         0         1         1\n         4         9\n")).lines,
            expected);
  EXPECT_EQ(drawn(dataset(head + "         4         9\n")).lines, expected);
  const std::string thin_shell =
      "         2        94         1         1         7         4\n"
      "         1         2         3         4\n";
  const std::string mass =
      "         3       161         1         1         7         1\n         1\n";
  const ModalTest test = drawn(dataset(head + "         4         9\n" + thin_shell + mass + mass));
  ASSERT_THAT(test.elements, SizeIs(1));
  EXPECT_EQ(test.elements[0].shape, ElementShape::quad4);
  EXPECT_THAT(test.remarks.front(), HasSubstr("a.uff:2: 2 elements of kind 161 are passed over"));
}

TEST(Uff, ElementsThatAreNotDrawnDoNoHarm) {
  const std::string springs =  // springs to ground have one node, some elements none
      "         1       138         1         1         7         1\n         4\n"
      "         2       900         1         1         7         0\n"
      "         3       901         1         1         7         9\n"
      "         1         2         3         4         5         6         7         8\n         "
      "9\n";
  const std::string plate =
      "         4        44         1         1         7         4\n"
      "         1         2         3         4\n";
  const ModalTest test = drawn(dataset("  2412\n" + springs + plate));
  EXPECT_THAT(test.elements, SizeIs(1));
  EXPECT_TRUE(test.lines.empty());
  EXPECT_THAT(test.remarks, Contains(HasSubstr("a.uff:2: an element of kind 900 is passed over")));
  EXPECT_THAT(test.remarks, Contains(HasSubstr("kind 901")));
}

TEST(Uff, BeamsOfThreeNodesNeedNoOrientation) {
  const std::string head = "         1        24         1         1         7         3\n";
  const std::string nodes = "         4         5         6\n";
  const std::vector<std::vector<std::int64_t>> expected{{4, 5, 6}, {4, 5, 6}};
  EXPECT_EQ(drawn(dataset("  2412\n" + head + nodes + head + nodes)).lines, expected);
  const std::string orientation = "         0         1         1\n";
  EXPECT_EQ(
      drawn(dataset("  2412\n" + head + orientation + nodes + head + orientation + nodes)).lines,
      expected);
}

TEST(Uff, WrongLinesAndElementsAreRefusedWithTheirPlace) {
  const auto refusal = [](const std::string& text) {
    return message_of<ConfigError>([&] { drawn(dataset(text)); });
  };
  EXPECT_THAT(
      refusal("    82\n         1       two         1\nNONE\n"),
      AllOf(HasSubstr("a.uff:3:"), HasSubstr("number of nodes and colour of a trace line")));
  EXPECT_THAT(refusal("    82\n         1         2         1\n"),
              AllOf(HasSubstr("a.uff:3:"), HasSubstr("the name of a trace line")));
  EXPECT_THAT(refusal("    82\n         1         2         1\nNONE\n         1     0.500\n"),
              AllOf(HasSubstr("a.uff:5:"), HasSubstr("labels of nodes")));
  EXPECT_THAT(refusal("  2412\n         1        94         1\n"),
              AllOf(HasSubstr("a.uff:3:"), HasSubstr("number of nodes of an element")));
  EXPECT_THAT(refusal("  2412\n         1        94         1         1         7         3\n      "
                      "   1         2         3\n"),
              AllOf(HasSubstr("a.uff:3:"),
                    HasSubstr("expected 4 nodes of an element of kind 94 (quad4), got 3")));
  EXPECT_THAT(refusal("  2412\n         1        94         1         1         7         4\n      "
                      "   1         2\n"),
              AllOf(HasSubstr("a.uff:4:"), HasSubstr("labels of the nodes of an element")));
}

// What is written is read: E13.5 has six digits.
TEST(UffWriter, ModesComeBackWithTheirNodes) {
  UffContents contents;
  contents.title = "modes";
  contents.program = "stridor";
  contents.stamp("2024-05-17T08:30:00Z");
  EXPECT_EQ(contents.date, "17-MAY-24");
  EXPECT_EQ(contents.time, "08:30:00");
  contents.nodes = {{1, "a", {0.0, 0.01, -2.5}}, {2, "a", {1.0, 0.0, 0.0}}};
  contents.lines = {{1, 2, 1, 2, 1, 2, 1, 2, 1}};
  const std::complex<double> s(-12.5, 4321.0);
  contents.modes = {{7, s, {{{{1.0, 0.0}, {-0.25, 0.125}, {0.0, 0.0}}}, {{{0.5, -0.5}, {0.0, 1e-7}, {2e-3, 0.0}}}}}};
  const std::string text = uff_text(contents, "-o");
  EXPECT_THAT(text, HasSubstr("    -1\n    82\n         1         9         1\nNONE\n         1         2"));
  const ModalTest test = read(text);
  ASSERT_THAT(test.nodes, SizeIs(2));
  EXPECT_EQ(test.lines, contents.lines);
  EXPECT_EQ(test.nodes.at(1), Eigen::Vector3d(0.0, 0.01, -2.5));
  ASSERT_THAT(test.modes, SizeIs(1));
  const TestMode& mode = test.modes[0];
  EXPECT_EQ(mode.number, 7);
  EXPECT_TRUE(mode.is_complex);
  EXPECT_NEAR(mode.frequency, std::abs(s) / (2.0 * std::numbers::pi), 1e-5 * mode.frequency);
  EXPECT_NEAR(mode.damping_ratio, 12.5 / std::abs(s), 1e-6);
  EXPECT_EQ(mode.shape.at(1)[1], std::complex<double>(-0.25, 0.125));
  EXPECT_EQ(mode.shape.at(2)[1], std::complex<double>(0.0, 1e-7));
  contents.modes[0].shape.pop_back();
  EXPECT_THROW(uff_text(contents, "-o"), std::invalid_argument);
}

// In a universal file nodes go around the lower side, up the edges, around the upper side; a node in the
// middle of an edge stands between its corners.
TEST(UffWriter, NodesOfElementsGoAroundTheirSides) {
  struct Expected {
    ElementShape shape;
    int kind, around_lower, upwards;  // nodes around the lower side, in the middles of upright edges
  };
  const std::vector<Expected> all = {
      {ElementShape::tri3, 41, 3, 0},    {ElementShape::tri6, 42, 6, 0},   {ElementShape::quad4, 44, 4, 0},
      {ElementShape::quad8, 45, 8, 0},   {ElementShape::tet4, 111, 3, 0},  {ElementShape::wedge6, 112, 3, 0},
      {ElementShape::wedge15, 113, 6, 3}, {ElementShape::hex8, 115, 4, 0}, {ElementShape::hex20, 116, 8, 4},
      {ElementShape::tet10, 118, 6, 3}};
  for (const Expected& one : all) {
    const Eigen::Matrix<double, Eigen::Dynamic, 3> places = natural_nodes(one.shape);
    UffContents contents;
    TestElement element{one.shape, {}};
    for (Eigen::Index i = 0; i < places.rows(); ++i) element.nodes.push_back(10 * i + 10);
    contents.elements = {element};
    const std::string text = uff_text(contents, "-o");
    const std::string record =
        fmt::format("    -1\n  2412\n         1{:10}         1         1         7{:10}\n", one.kind, places.rows());
    const ModalTest back = modal_test_in(uff_datasets({"a.uff", text}));
    ASSERT_THAT(back.elements, SizeIs(1));
    EXPECT_EQ(back.elements[0].shape, one.shape);
    EXPECT_EQ(back.elements[0].nodes, element.nodes);
    const std::size_t at = text.find(record);
    ASSERT_NE(at, std::string::npos) << facts_of(one.shape).name << '\n' << text;
    std::istringstream words(text.substr(at + record.size()));
    std::vector<Eigen::RowVector3d> nodes;
    for (Eigen::Index i = 0, label = 0; i < places.rows() && words >> label; ++i)
      nodes.push_back(places.row(label / 10 - 1));
    ASSERT_EQ(nodes.size(), static_cast<std::size_t>(places.rows()));
    const auto goes_around = [&](std::size_t first, int count) {
      for (int k = 1; k < count; k += 2) {
        const Eigen::RowVector3d middle = 0.5 * (nodes[first + k - 1] + nodes[first + (k + 1) % count]);
        EXPECT_LT((nodes[first + k] - middle).norm(), 1e-14) << facts_of(one.shape).name << ' ' << k;
      }
    };
    if (places.rows() == facts_of(one.shape).num_corners) continue;
    goes_around(0, one.around_lower);
    const std::size_t upper = static_cast<std::size_t>(one.around_lower + one.upwards);
    const std::size_t num_upper = nodes.size() - upper;
    if (num_upper > 1) goes_around(upper, static_cast<int>(num_upper));
    for (std::size_t k = 0; k < static_cast<std::size_t>(one.upwards); ++k) {
      const Eigen::RowVector3d above = num_upper > 1 ? nodes[upper + 2 * k] : nodes[upper];
      EXPECT_LT((nodes[one.around_lower + k] - 0.5 * (nodes[2 * k] + above)).norm(), 1e-14)
          << facts_of(one.shape).name << ' ' << k;
    }
  }
  UffContents contents;
  contents.elements = {{ElementShape::tet4, {1, 2, 3}}};
  EXPECT_THROW(uff_text(contents, "-o"), std::invalid_argument);
}

}  // namespace
}  // namespace stridor
