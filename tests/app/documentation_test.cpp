// Commands in the documents are run as printed there.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <regex>
#include <sstream>

#include "core/refusals.hpp"
#include "tests/app/document_fixture.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;
using namespace test;

/// The Python that has all of these modules; "" if none has.
std::string python_with(const std::string& modules, const UserFolder& folder) {
  for (const char* python : {"python3", "/usr/bin/python3"})
    if (folder.has_command(std::string(python) + " -c 'import " + modules + "'")) return python;
  return "";
}

/// A file of every name that a snippet opens: a locus of that name, or the run of a scene.
void make_files(const UserFolder& folder, const std::string& snippet) {
  const std::regex name("\"([a-z_]+)\\.h5\"");
  for (std::sregex_iterator it(snippet.begin(), snippet.end(), name), end; it != end; ++it) {
    const std::string stem = (*it)[1];
    if (fs::exists(folder / (stem + ".h5"))) continue;
    const std::string scene = stem == "beam" ? "beam_on_beam" : "examples/" + stem;
    const auto made = folder.run(
        stem == "locus"
            ? "stridor locus scenes/beam_on_beam.yaml --from 70mm --to 98mm --points 5 -o locus.h5"
            : "stridor run scenes/" + scene + ".yaml -o " + stem + ".h5 --set time.end=0.02");
    ASSERT_EQ(made.exit_code, 0) << made.output;
  }
}

std::vector<fs::path> documents() {
  std::vector<fs::path> all{source / "README.md"};
  for (const auto& entry : fs::directory_iterator(source / "docs"))
    if (entry.path().extension() == ".md") all.push_back(entry.path());
  return all;
}

/// The block of a language that begins with a word.
std::string block_of(const fs::path& document, const std::string& language,
                     const std::string& beginning) {
  for (const std::string& one : blocks_of(document, language))
    if (one.starts_with(beginning)) return one;
  ADD_FAILURE() << document << " has no block of " << language << " with " << beginning;
  return {};
}

TEST(Readme, SceneSquealsForTheReasonGiven) {
  const UserFolder folder;
  const fs::path readme = source / "README.md";
  write_file(folder / "beam.yaml", block_of(readme, "yaml", "format:"));
  const std::string text = contents_of(readme);
  std::smatch command, reason;
  ASSERT_TRUE(std::regex_search(text, command, std::regex("`(stridor eig beam\\.yaml [^`]*)`")));
  ASSERT_TRUE(std::regex_search(
      text, reason,
      std::regex("a mode of ([0-9]+) Hz gains\\s+([0-9.]+) % of its energy at the contact in each "
                 "cycle and loses ([0-9.]+) % by")));
  const auto outcome = folder.run(command[1]);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  std::smatch mode, energy;
  ASSERT_TRUE(std::regex_search(outcome.output, mode, std::regex("at ([0-9.]+) Hz, growth")));
  ASSERT_TRUE(std::regex_search(
      outcome.output, energy,
      std::regex("of its energy \\+([0-9.]+) % enters at the contact in each cycle, -([0-9.]+) %")));
  EXPECT_NEAR(std::stod(mode[1]), std::stod(reason[1]), 0.5);
  EXPECT_NEAR(std::stod(energy[1]), std::stod(reason[2]), 0.05);
  EXPECT_NEAR(std::stod(energy[2]), std::stod(reason[3]), 0.05);
}

TEST(Commands, WorkAsPrintedOneAfterTheOther) {
  const UserFolder folder;
  const std::string block = block_of(source / "docs" / "commands.md", "sh", "stridor check");
  // Shorter runs, whose results are not those expected of the whole.
  const std::string shorter = " --set time.end=0.45";
  int num_run = 0;
  for (const std::string& line : lines_of(block)) {
    std::string command = line.substr(0, line.find("  #"));
    if (command.starts_with("stridor run scenes/")) command += shorter + " --set 'expect=[]'";
    if (command.starts_with("stridor compare")) command += shorter + " --published-window 1e-3";
    if (command.starts_with("stridor precision") || command.starts_with("stridor sweep"))
      command += shorter;
    const auto outcome = folder.run(command);
    EXPECT_EQ(outcome.exit_code, 0) << command << "\n" << outcome.output;
    if (command.starts_with("stridor threshold")) {
      EXPECT_TRUE(std::regex_search(outcome.output, std::regex("[0-9]+(\\.[0-9]+)? *k?Hz")))
          << "finds nothing: " << outcome.output;
    }
    ++num_run;
  }
  EXPECT_GE(num_run, 15);
}

/// Whether a program has printed a number to the digits that it shows.
bool is_printed(double wanted, const std::string& output) {
  const std::regex number("[0-9]+\\.([0-9]{3,})");
  for (std::sregex_iterator it(output.begin(), output.end(), number), end; it != end; ++it) {
    const double half_of_last = 0.5 * std::pow(10.0, -static_cast<double>((*it)[1].length()));
    if (std::abs(std::stod(it->str()) - wanted) <= 1.001 * half_of_last) return true;
  }
  return false;
}

TEST(Pages, OfDiscAndPadsGiveTheirNumbers) {
  const UserFolder folder;
  const std::regex row("\\| [^|]+ \\| `([^`]+)` \\| ([^|]*)\\|.*");
  const std::regex digits("[0-9]+\\.[0-9]{6,}");
  int num_rows = 0, num_numbers = 0;
  for (const std::string& line : lines_of(contents_of(source / "docs" / "disc_and_pads.md"))) {
    std::smatch cells;
    if (!std::regex_match(line, cells, row)) continue;
    std::string command = std::regex_replace(cells[1].str(), std::regex(" E/"), " scenes/examples/");
    command = std::regex_replace(command, std::regex(" B\\b"), " scenes/disc_and_pads.yaml");
    command = std::regex_replace(command, std::regex(" L "), " --parameter parameters.load ");
    const auto outcome = folder.run("stridor " + command);
    EXPECT_EQ(outcome.exit_code, 0) << command << '\n' << outcome.output;
    ++num_rows;
    const std::string ours = cells[2].str();
    for (std::sregex_iterator it(ours.begin(), ours.end(), digits), end; it != end; ++it, ++num_numbers)
      EXPECT_TRUE(is_printed(std::stod(it->str()), outcome.output)) << it->str() << '\n' << outcome.output;
  }
  EXPECT_EQ(num_rows, 14);
  EXPECT_EQ(num_numbers, 10);
}

/// The part of a page below each of its headings of the third level.
std::vector<std::pair<std::string, std::string>> sections_of(const fs::path& page) {
  std::vector<std::pair<std::string, std::string>> sections;
  for (const std::string& line : lines_of(contents_of(page))) {
    if (line.starts_with("### ")) {
      sections.emplace_back(line.substr(4), "");
    } else if (!sections.empty()) {
      sections.back().second += line + "\n";
    }
  }
  return sections;
}

TEST(Pages, OfRefusalsHasASectionForEveryCode) {
  std::vector<std::string> codes;
  for (const Refusal refusal : all_refusals()) codes.emplace_back(code_of(refusal));
  std::vector<std::string> headings;
  for (const auto& [heading, text] : sections_of(source / "docs" / "refusals.md")) {
    headings.push_back(heading);
    EXPECT_NE(text.find("*Cause.*"), std::string::npos) << heading;
  }
  EXPECT_EQ(headings, codes);
}

TEST(Pages, OfRefusalsShowWhatIsPrinted) {
  const UserFolder folder;
  int num_refused = 0;
  for (const auto& [code, text] : sections_of(source / "docs" / "refusals.md")) {
    std::istringstream stream(text);
    for (const std::string& block : blocks_in(stream, "text")) {
      if (!block.starts_with("$ ")) continue;  // of two processes at once
      UserFolder::Outcome outcome{};
      for (const std::string& line : lines_of(block)) {
        if (line.starts_with("$ ")) {
          outcome = folder.run(line.substr(2));
          continue;
        }
        EXPECT_GE(outcome.exit_code, 2) << block << outcome.output;
        EXPECT_NE(outcome.output.find(line), std::string::npos) << line << "\n" << outcome.output;
        EXPECT_NE(outcome.output.find("[" + code + "]"), std::string::npos) << outcome.output;
        ++num_refused;
      }
    }
  }
  EXPECT_GE(num_refused, 28);
}

TEST(Snippets, OfPythonRun) {
  const UserFolder folder;
  const std::string python = python_with("h5py", folder);
  const std::string with_xarray = python_with("xarray, h5netcdf", folder);
  if (python.empty()) GTEST_SKIP() << "needs python3 with h5py";
  int num_run = 0;
  for (const fs::path& document : documents()) {
    for (const std::string& snippet : blocks_of(document, "python")) {
      const bool needs_xarray = snippet.find("import xarray") != std::string::npos;
      if (needs_xarray && with_xarray.empty()) continue;
      make_files(folder, snippet);
      write_file(folder / "snippet.py", snippet);
      const auto outcome = folder.run((needs_xarray ? with_xarray : python) + " snippet.py");
      EXPECT_EQ(outcome.exit_code, 0) << document << "\n" << snippet << outcome.output;
      ++num_run;
    }
  }
  EXPECT_GE(num_run, 2);
}

/// Frequency and gain of the loudest burst as a notebook prints them; empty where it does not.
std::vector<double> loudest_burst_of(const fs::path& notebook) {
  const std::string text = contents_of(notebook);
  std::smatch printed;
  const std::regex line("loudest burst: ([0-9.]+) Hz, gain ([0-9.]+)");
  if (!std::regex_search(text, printed, line)) return {};
  return {std::stod(printed[1]), std::stod(printed[2])};
}

TEST(Snippets, OfTheNotebookRun) {
  const UserFolder folder;
  const std::string python = python_with("nbconvert, ipykernel, matplotlib, h5py", folder);
  if (python.empty()) {
    GTEST_SKIP() << "needs python3 with nbconvert, ipykernel, matplotlib and h5py (Debian: "
                    "jupyter-nbconvert, python3-ipykernel, python3-matplotlib, python3-h5py)";
  }
  const fs::path kept = source / "docs" / "squeal_notebook.ipynb";
  // Settings of the user's own have no part in it.
  const auto outcome = folder.run(
      "export JUPYTER_CONFIG_DIR=$PWD JUPYTER_RUNTIME_DIR=$PWD IPYTHONDIR=$PWD MPLCONFIGDIR=$PWD\n"
      "export PYTHONDONTWRITEBYTECODE=1 STRIDOR_PROGRAM='" STRIDOR_PROGRAM "' PYTHONPATH='" +
      (source / "python").string() + "'\n" + python + " -m nbconvert --to notebook --execute '" +
      kept.string() + "' --output-dir . --output executed.ipynb");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  const auto shown = loudest_burst_of(kept), printed = loudest_burst_of(folder / "executed.ipynb");
  ASSERT_EQ(shown.size(), 2u);
  ASSERT_EQ(printed.size(), 2u);
  EXPECT_NEAR(printed[0], shown[0], 1e-3 * shown[0]);
  EXPECT_NEAR(printed[1], shown[1], 0.02);  // its last digit, and rounding of another processor
}

TEST(Snippets, OfOctaveRun) {
  const UserFolder folder;
  if (!folder.has_command("octave-cli --version")) GTEST_SKIP() << "needs octave";
  int num_run = 0;
  for (const fs::path& document : documents()) {
    for (const std::string& snippet : blocks_of(document, "octave")) {
      make_files(folder, snippet);
      // Drawing takes fonts and a display of Octave's own; the data are what counts.
      write_file(folder / "snippet.m",
                 "plot = @(x, y) assert(numel(x), numel(y));\n" + snippet);
      const auto outcome = folder.run("octave-cli --no-init-file --no-history snippet.m");
      EXPECT_EQ(outcome.exit_code, 0) << document << "\n" << snippet << outcome.output;
      EXPECT_EQ(outcome.output.find("HDF5"), std::string::npos) << outcome.output;
      ++num_run;
    }
  }
  EXPECT_GE(num_run, 1);
}

/// A file, how it is made, and what Octave must find in it.
struct MadeFile {
  const char* name;
  const char* command;
  const char* holds;  ///< a condition of Octave on `file`
};

TEST(Octave, LoadsTheFilesOfEveryVerb) {
  const UserFolder folder;
  if (!folder.has_command("octave-cli --version")) GTEST_SKIP() << "needs octave";
  constexpr std::array files{
      MadeFile{"ruler.h5", "run scenes/examples/ruler.yaml --set time.end=0.02 -o ruler.h5",
               "numel(file.time) > 1 && numel(file.contact.contact.force) == numel(file.time) && "
               "ischar(file.scene.text) && ischar(file.scene.resolved)"},
      MadeFile{"disc.h5", "run scenes/examples/disc_squeal.yaml --set time.end=1e-3 -o disc.h5",
               "numel(file.time) > 1 && isfield(file.contact, 'upper')"},
      MadeFile{"sphere.h5", "run scenes/viscoelastic_sphere.yaml --set time.end=0.1 -o sphere.h5",
               "numel(file.time) > 1 && isfield(file.contact.contact, 'area')"},
      MadeFile{"two.h5", "run scenes/examples/two_feet.yaml --set time.end=1e-3 -o two.h5",
               "numel(file.time) > 1"},
      MadeFile{"amplitudes.h5",
               "spectrogram ruler.h5 --channel contact.force --data amplitudes.h5 -o a.png",
               "numel(fieldnames(file)) >= 3"},
      MadeFile{"locus.h5",
               "locus scenes/beam_on_beam.yaml --from 30mm --to 98mm --points 3 -o locus.h5",
               "numel(fieldnames(file)) >= 2"},
      MadeFile{"map.h5",
               "map scenes/beam_on_beam.yaml --x contact.friction.coefficient 0.1 0.3 2 "
               "--y contact.start 0.03 0.05 2 -o map.h5",
               "numel(fieldnames(file)) >= 2"},
      MadeFile{"sweep.h5",
               "sweep scenes/examples/ruler.yaml --parameter contact.friction.coefficient "
               "--from 0.1 --to 0.2 --points 2 --set time.end=0.02 -o sweep.h5",
               "numel(fieldnames(file)) >= 2"},
      MadeFile{"contact.h5", "contact scenes/viscoelastic_contact.yaml -o contact.h5",
               "numel(fieldnames(file)) >= 2"},
      MadeFile{"cycle.h5", "cycle scenes/viscoelastic_sphere.yaml -o cycle.h5",
               "numel(file.time) > 1"}};
  for (const MadeFile& made : files) {
    const auto outcome = folder.run(std::string("stridor ") + made.command);
    ASSERT_EQ(outcome.exit_code, 0) << made.command << "\n" << outcome.output;
    const auto loaded = folder.run(std::string("octave-cli --no-init-file --no-history --eval \"file = load('") +
                                   made.name + "'); if !(" + made.holds + ") disp(file); exit(1); end\"");
    EXPECT_EQ(loaded.exit_code, 0) << made.name << "\n" << loaded.output;
    EXPECT_EQ(loaded.output, "") << made.name;
  }
}

}  // namespace
}  // namespace stridor
