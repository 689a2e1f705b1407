// The slide of a run in a report: bodies, what moves them, contacts and recorded points.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/app/pictures_fixture.hpp"
#include "tests/support/report_blocks.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class ReportSlide : public Pictures {
 protected:
  /// Runs a scene and makes its page, each with further arguments. @return the page
  std::string page_of(const std::string& scene, std::vector<std::string> run,
                      std::vector<std::string> report = {}) const {
    run.insert(run.begin(), {"run", scene, "-o", path("run.h5"), "--force"});
    const ProgramResult ran = Program(run).run();
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    report.insert(report.begin(), {"report", path("run.h5"), "-o", path("page.html"), "--force"});
    const ProgramResult reported = Program(report).run();
    EXPECT_EQ(reported.exit_code, 0) << reported.err;
    return contents_of(path("page.html"));
  }
  static Json section_of(const std::string& page) {
    return contents_of_report(page)["sections"][0];
  }
  static Json view_of(const Json& section, const std::string& type) {
    for (const Json& view : section["views"])
      if (view["type"] == type) return view;
    return nullptr;
  }
  static Json part_of(const Json& view, const std::string& name) {
    for (const Json& part : view["parts"])
      if (part["name"] == name) return part;
    return nullptr;
  }
  static std::string scene(const std::string& name) {
    return std::string(STRIDOR_SOURCE_DIR) + "/scenes/" + name;
  }
};

// 30 mm/s reached along a ramp of 0.1 s that is alike forwards and backwards: 30 mm/s (t − 0.05 s)
// after it.
TEST_F(ReportSlide, BodiesMoveByTheLawOfTheirDrive) {
  const std::string page =
      page_of(scene("beam_on_beam.yaml"), {"--set", "time.end=0.15", "--set", "measure.from=0.1"});
  const Json view = view_of(section_of(page), "slide");
  ASSERT_FALSE(view.is_null());
  EXPECT_TRUE(view["planar"]);
  EXPECT_EQ(part_of(view, "oblique")["drive"], 0);
  EXPECT_FALSE(part_of(view, "cantilever").contains("drive"));
  ASSERT_EQ(view["drives"].size(), 1u);
  const std::vector<double> way = numbers_of(page, view["drives"][0]);
  ASSERT_GE(way.size(), 2u);
  EXPECT_EQ(way.front(), 0.0);
  EXPECT_TRUE(std::is_sorted(way.begin(), way.end()));
  const double end = view["time"]["to"];
  constexpr double single = 1e-6;  // of numbers of four bytes, and of the ramp
  EXPECT_NEAR(way.back(), 0.03 * (end - 0.05), 0.003 * single);
  // Every node of the bodies, between the ends of the beams.
  std::size_t count = 0;
  for (const Json& part : view["parts"]) count += part["count"].get<std::size_t>();
  const std::vector<double> places = numbers_of(page, view["places"]);
  ASSERT_EQ(places.size(), 3 * count);
  // The cantilever is 2 mm thick about y = 0; the oblique beam stands on it.
  EXPECT_NEAR(*std::min_element(places.begin(), places.end()), -1e-3, 1e-3 * single);
}

TEST_F(ReportSlide, ContactsAndRecordedPointsHaveTheirPlacesAndDirections) {
  const std::string page =
      page_of(scene("beam_on_beam.yaml"), {"--set", "time.end=0.15", "--set", "measure.from=0.1"});
  const Json view = view_of(section_of(page), "slide");
  ASSERT_EQ(view["contacts"].size(), 1u);
  const Json contact = view["contacts"][0];
  EXPECT_EQ(contact["name"], "contact");
  EXPECT_EQ(view["parts"][contact["part"].get<std::size_t>()]["name"], "oblique");
  EXPECT_NEAR(contact["at"][0].get<double>(), 0.03, 1e-12);
  EXPECT_NEAR(contact["at"][1].get<double>(), 1e-3, 1e-12);  // on the top of the cantilever
  EXPECT_EQ(contact["normal"], Json({0.0, 1.0, 0.0}));
  ASSERT_EQ(view["points"].size(), 1u);
  const Json point = view["points"][0];
  EXPECT_EQ(point["channel"], "cantilever.free_end.y.acceleration");
  EXPECT_EQ(point["along"], Json({0.0, 1.0, 0.0}));
  EXPECT_NEAR(point["at"][0].get<double>(), 0.1, 1e-12);
  EXPECT_FALSE(point["is_displacement"]);
}

TEST_F(ReportSlide, ADiscTurnsUnderItsPads) {
  const std::string page = page_of(scene("examples/disc_squeal.yaml"), {"--set", "time.end=0.002"});
  const Json view = view_of(section_of(page), "slide");
  ASSERT_FALSE(view.is_null());
  const std::vector<std::string> again{"report", path("run.h5"), "-o", path("page.html"),
                                       "--force"};
  EXPECT_EQ(Program(again).run().exit_code, 0);
  EXPECT_EQ(contents_of(path("page.html")), page) << "two calls give equal bytes";
  EXPECT_FALSE(view["planar"]);
  EXPECT_EQ(view["up"], 2);
  EXPECT_EQ(part_of(view, "disc")["spin"]["speed"], 10.0);
  EXPECT_EQ(part_of(view, "disc")["spin"]["axis"], Json({0.0, 0.0, 1.0}));
  EXPECT_FALSE(part_of(view, "upper").contains("spin"));
  EXPECT_TRUE(view["drives"][0].is_null());
  // On both faces, at a radius of 130 mm.
  ASSERT_EQ(view["contacts"].size(), 2u);
  for (const Json& contact : view["contacts"]) {
    EXPECT_NEAR(std::hypot(contact["at"][0].get<double>(), contact["at"][1].get<double>()), 0.13,
                1e-12);
    EXPECT_EQ(contact["normal"][2].get<double>(), contact["name"] == "upper" ? 1.0 : -1.0);
  }
  // The frame of a body on the lower face is turned over; that on the upper one moves along the
  // axis.
  ASSERT_FALSE(view["points"].empty());
  for (const Json& point : view["points"])
    EXPECT_EQ(point["along"], Json({0.0, 0.0, 1.0})) << point["channel"];
}

TEST_F(ReportSlide, AMasterWithoutEndMovesUnderWhatItDrags) {
  const std::string page = page_of(scene("viscoelastic_sphere.yaml"),
                                   {"--set", "time.end=0.5", "--set", "measure.from=0.1"});
  const Json view = view_of(section_of(page), "slide");
  ASSERT_FALSE(view.is_null());
  const Json ground = view["parts"].back();
  ASSERT_TRUE(ground.contains("drive"));
  EXPECT_GT(ground["period"].get<double>(), 0.0);
  const std::vector<double> way =
      numbers_of(page, view["drives"][ground["drive"].get<std::size_t>()]);
  EXPECT_NEAR(way.back(), 5e-3 * view["time"]["to"].get<double>(), 1e-8);  // v_d = v R/τ = 5 mm/s
  EXPECT_EQ(view["springs"].size(), 3u);
  EXPECT_EQ(part_of(view, "sphere")["count"], 1);
  EXPECT_EQ(std::count_if(view["points"].begin(), view["points"].end(),
                          [](const Json& point) { return point["is_displacement"].get<bool>(); }),
            2);
}

TEST_F(ReportSlide, IsLeftAwayWithTheShapesAndWhereItDoesNotFit) {
  const std::vector<std::string> brief{"--set", "time.end=0.002"};
  EXPECT_TRUE(
      view_of(section_of(page_of(scene("examples/disc_squeal.yaml"), brief, {"--no-shapes"})),
              "slide")
          .is_null());
  const Json section =
      section_of(page_of(scene("examples/disc_squeal.yaml"), brief, {"--budget", "300kB"}));
  EXPECT_TRUE(view_of(section, "slide").is_null());
  EXPECT_THAT(section["remarks"].dump(), HasSubstr("No picture of the slide: "));
  EXPECT_THAT(section["remarks"].dump(), HasSubstr("nodes do not fit into the page (--budget)"));
}

// The files of meshes are looked for where they were when the run was made.
TEST_F(ReportSlide, SaysWhyThereIsNone) {
  namespace fs = std::filesystem;
  for (const char* name : {"sliding_block.yaml", "rail.inp", "slider.inp"})
    fs::copy_file(scene(std::string("examples/") + name), path(name));
  page_of(path("sliding_block.yaml"), {"--set", "time.end=0.0025", "--set", "measure.from=0.002"});
  fs::remove(path("rail.inp"));
  const ProgramResult result =
      Program({"report", path("run.h5"), "-o", path("page.html"), "--force"}).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Json section = section_of(contents_of(path("page.html")));
  EXPECT_TRUE(view_of(section, "slide").is_null());
  EXPECT_THAT(section["remarks"].dump(), HasSubstr("No picture of the slide: "));
  EXPECT_THAT(section["remarks"].dump(), HasSubstr("rail.inp"));
}

}  // namespace
}  // namespace stridor
