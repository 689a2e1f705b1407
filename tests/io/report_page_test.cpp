#include "io/report/report_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <stdexcept>

#include "core/errors.hpp"
#include "io/report/packed_text.hpp"
#include "tests/support/program.hpp"
#include "tests/support/report_blocks.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

std::vector<unsigned char> bytes_from(const std::string& text) {
  return {text.begin(), text.end()};
}

// RFC 4648, section 10.
TEST(PackedText, Base64IsThatOfItsStandard) {
  EXPECT_EQ(base64_text(bytes_from("")), "");
  EXPECT_EQ(base64_text(bytes_from("f")), "Zg==");
  EXPECT_EQ(base64_text(bytes_from("fo")), "Zm8=");
  EXPECT_EQ(base64_text(bytes_from("foo")), "Zm9v");
  EXPECT_EQ(base64_text(bytes_from("foobar")), "Zm9vYmFy");
}

TEST(PackedText, GzipComesBackAndIsEqualForEqualBytes) {
  std::mt19937 random(7);
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{200000}}) {
    std::vector<unsigned char> bytes(count);
    for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(random() & 15U);
    const std::string packed = gzipped(bytes);
    EXPECT_EQ(packed, gzipped(bytes));
    EXPECT_EQ(inflated(bytes_from(packed)), bytes);
  }
}

TEST(SampleCoding, EverySampleIsRightToAHalfOfTheScaleOfItsPiece) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise;
  std::vector<double> samples;
  // A loud piece about 10 beside a quiet one about 0, and a last one that is not full.
  for (std::size_t i = 0; i < 2 * samples_per_scale + 100; ++i)
    samples.push_back(i < samples_per_scale ? 10.0 + noise(random) : 1e-6 * noise(random));
  const std::vector<double> decoded = decoded_samples(coded_samples(samples), samples.size());
  for (std::size_t begin = 0; begin < samples.size(); begin += samples_per_scale) {
    const std::size_t end = std::min(samples.size(), begin + samples_per_scale);
    const auto [least, most] = std::minmax_element(samples.begin() + static_cast<std::ptrdiff_t>(begin),
                                                   samples.begin() + static_cast<std::ptrdiff_t>(end));
    const double bound = (*most - *least) / (4.0 * 32767.0) * (1.0 + 1e-9);
    for (std::size_t i = begin; i < end; ++i) ASSERT_NEAR(decoded[i], samples[i], bound) << i;
  }
}

TEST(SampleCoding, ConstantsMissingAndExtremeValues) {
  const std::vector<double> constant(5000, 0.1);
  EXPECT_EQ(decoded_samples(coded_samples(constant), 5000), constant);
  const double huge = std::numeric_limits<double>::max();
  const std::vector<double> odd{none, 1.0, std::numeric_limits<double>::infinity(), -1.0};
  const std::vector<double> decoded = decoded_samples(coded_samples(odd), 4);
  EXPECT_TRUE(std::isnan(decoded[0]));
  EXPECT_NEAR(decoded[1], 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(decoded[2]));
  const std::vector<double> wide = decoded_samples(coded_samples(std::vector{huge, -huge}), 2);
  EXPECT_NEAR(wide[0] / huge, 1.0, 1e-9);
  EXPECT_NEAR(wide[1] / huge, -1.0, 1e-9);
  EXPECT_TRUE(decoded_samples(coded_samples({}), 0).empty());
  EXPECT_TRUE(std::isnan(decoded_samples(coded_samples(std::vector{none}), 1)[0]));
  EXPECT_THROW(decoded_samples(std::vector<unsigned char>(7), 2), std::invalid_argument);
}

TEST(SampleCoding, ExtremesPassOverWhatIsMissing) {
  const std::vector<double> samples{3.0, -1.0, none, 2.0, none, none, 7.0};
  const std::vector<double> found = extremes(samples, 2);
  ASSERT_EQ(found.size(), 8u);
  EXPECT_THAT((std::vector<double>{found.begin(), found.begin() + 4}), ElementsAre(-1.0, 3.0, 2.0, 2.0));
  EXPECT_TRUE(std::isnan(found[4]) && std::isnan(found[5]));
  EXPECT_THAT((std::vector<double>{found.begin() + 6, found.end()}), ElementsAre(7.0, 7.0));
  EXPECT_EQ(extremes(samples, 1).size(), 14u);
  EXPECT_THROW(extremes(samples, 0), std::invalid_argument);
}

TEST(ReportPage, HoldsEveryBlockAndWhatItIs) {
  const TemporaryFolder folder;
  const std::string path = (folder / "page.html").string();
  nlohmann::ordered_json contents;
  const std::vector<double> numbers{0.1, -1e300, none, 5e-324};
  {
    ReportPage page(path, Overwrite::no, "a < b & \"c\"");
    contents["numbers"] = page.add_numbers(numbers);
    contents["floats"] = page.add_floats(std::vector{0.5, -2.0});
    contents["samples"] = page.add_samples(std::vector{-1.0, 0.0, 1.0});
    contents["bytes"] = page.add_bytes(std::vector<unsigned char>{0, 255, 7});
    // What a scene may say must not end the script that holds it.
    contents["text"] = "</script><script>alert(1)</script> \xc3\xa9 \xff";
    page.finish(contents);
    EXPECT_EQ(page.size(), contents_of(path).size());
  }
  const std::string text = contents_of(path);
  EXPECT_THAT(text, StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(text, HasSubstr("<title>a &lt; b &amp; &quot;c&quot;</title>"));
  EXPECT_THAT(text, HasSubstr("default-src 'none'"));
  EXPECT_THAT(text, HasSubstr("Leon Sorokin"));
  EXPECT_THAT(text, Not(HasSubstr("@TITLE@")));
  EXPECT_THAT(script_of(text, "report"), Not(HasSubstr("<")));
  const nlohmann::json read = contents_of_report(text);
  EXPECT_EQ(read["text"].get<std::string>(), "</script><script>alert(1)</script> \xc3\xa9 \xef\xbf\xbd");
  const std::vector<double> back = numbers_of(text, read["numbers"]);
  EXPECT_EQ(back[0], 0.1);
  EXPECT_EQ(back[1], -1e300);
  EXPECT_TRUE(std::isnan(back[2]));
  EXPECT_EQ(back[3], 5e-324);
  EXPECT_THAT(numbers_of(text, read["floats"]), ElementsAre(0.5, -2.0));
  EXPECT_THAT(numbers_of(text, read["bytes"]), ElementsAre(0.0, 255.0, 7.0));
  EXPECT_NEAR(numbers_of(text, read["samples"])[0], -1.0, 1e-12);
}

TEST(ReportPage, AsksNothingOfTheNetwork) {
  const TemporaryFolder folder;
  const std::string path = (folder / "page.html").string();
  {
    ReportPage page(path, Overwrite::no, "x");
    page.finish({});
  }
  const std::string text = contents_of(path);
  for (const char* reference : {"src=\"", "href=\"http", "@import", "url(", "fetch(", "XMLHttpRequest"})
    EXPECT_THAT(text, Not(HasSubstr(reference)));
}

TEST(ReportPage, APageThatIsNotFinishedLeavesNothing) {
  const TemporaryFolder folder;
  const std::string path = (folder / "page.html").string();
  { ReportPage page(path, Overwrite::no, "x"); }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  {
    ReportPage page(path, Overwrite::no, "x");
    page.finish({});
  }
  EXPECT_THROW(ReportPage(path, Overwrite::no, "x"), FileError);
  EXPECT_THROW(ReportPage((folder / "none/page.html").string(), Overwrite::no, "x"), FileError);
}

// A process that was killed leaves what it had written under another name; that of nobody goes.
TEST(ReportPage, WhatAKilledProcessLeftIsTakenAway) {
  const TemporaryFolder folder;
  const std::string path = (folder / "page.html").string();
  // No process has a number this large (kernel.pid_max is at most 2^22).
  std::ofstream(path + ".part-4194305") << "<!DOCTYPE html>\n<html";
  std::ofstream(path + ".part-4194306") << "a note of somebody";
  {
    ReportPage page(path, Overwrite::no, "x");
    page.finish({});
  }
  EXPECT_THAT(folder.files(), ::testing::UnorderedElementsAre("page.html", "page.html.part-4194306"));
}

}  // namespace
}  // namespace stridor
