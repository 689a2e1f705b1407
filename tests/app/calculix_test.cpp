// CalculiX itself, where it is installed: it still writes what is kept, and has our frequencies.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
namespace fs = std::filesystem;

const fs::path data = fs::path(STRIDOR_SOURCE_DIR) / "tests/data/calculix";

bool has_calculix() {
  return std::system("command -v ccx >/dev/null 2>&1") == 0;
}

/// Runs a deck; ccx ends with 0 after errors, too.
void run_calculix(const fs::path& folder, const std::string& job) {
  const std::string line = "cd '" + folder.string() + "' && ccx " + job + " >" + job + ".log 2>&1";
  ASSERT_EQ(std::system(line.c_str()), 0);
  EXPECT_EQ(contents_of(folder / (job + ".log")).find("*ERROR"), std::string::npos);
}

std::vector<double> numbers_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<double>(stream), std::istream_iterator<double>()};
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

/// The fourth number of the lines of modes in a .dat file, Hz.
std::vector<double> frequencies_of(const std::string& text) {
  std::vector<double> frequencies;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::vector<double> numbers = numbers_of(line);
    if (line.find("P A R T I C I P") != std::string::npos) break;
    if (numbers.size() == 5) frequencies.push_back(numbers[3]);
  }
  return frequencies;
}

class CalculixTest : public ::testing::TestWithParam<const char*> {};

TEST_P(CalculixTest, WritesTheMatricesThatAreKeptAndHasOurFrequencies) {
  if (!has_calculix()) GTEST_SKIP() << "needs ccx (calculix-ccx)";
  const std::string name = GetParam();
  const TemporaryFolder folder;
  const std::string deck = contents_of(data / (name + ".inp"));
  write_file(folder / "job.inp", deck);
  run_calculix(folder.path(), "job");
  for (const char* ending : {".sti", ".mas", ".dof"}) {
    const std::vector<double> made = numbers_of(contents_of(folder / (std::string("job") + ending)));
    const std::vector<double> kept = numbers_of(contents_of(data / (name + ending)));
    ASSERT_EQ(made.size(), kept.size()) << ending;
    double largest = 0.0;
    for (const double value : kept) largest = std::max(largest, std::abs(value));
    // Other machines add up in another order.
    for (std::size_t i = 0; i < made.size(); ++i) ASSERT_NEAR(made[i], kept[i], 1e-12 * largest);
  }
  write_file(folder / "freq.inp",
             replaced(replaced(deck, ", SOLVER=MATRIXSTORAGE", ""), "\n10\n*END STEP",
                      "\n4\n*END STEP"));
  run_calculix(folder.path(), "freq");
  const std::vector<double> theirs = frequencies_of(contents_of(folder / "freq.dat"));
  ASSERT_EQ(theirs.size(), 4U);
  const std::string job = (folder / "job").string();
  const ProgramResult result = Program({"import", job + ".sti", job + ".mas", job + ".dof",
                                        job + ".inp", "--length-unit", "mm", "--json"})
                                   .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto ours = nlohmann::json::parse(result.out)["matrices"]["frequencies"];
  // Half a unit of the seventh digit behind the point, of numbers from 0.1.
  for (std::size_t i = 0; i < theirs.size(); ++i)
    EXPECT_NEAR(ours[i].get<double>() / theirs[i], 1.0, 5e-7) << i;
}

INSTANTIATE_TEST_SUITE_P(Elements, CalculixTest, ::testing::Values("c3d4", "c3d10", "c3d20r"));

}  // namespace
}  // namespace stridor
