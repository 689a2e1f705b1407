// Files damaged at random, folders that cannot be written, disks that are full: every verb ends
// with an exit code that says so, and never otherwise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/mount.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;
using namespace test;
using ::testing::AnyOf;
using ::testing::HasSubstr;

const std::string rough_scene = scene_path("viscoelastic_contact.yaml");
const std::string rubber_scene = scene_path("viscoelastic_sphere.yaml");

using Arguments = std::vector<std::string>;

/// Some damage to the bytes of a file, always the same for a seed.
std::string damaged(std::string bytes, unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  // Metadata stand mostly at the front; data may become any number.
  const std::size_t at =
      below(below(3) == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 4096));
  const std::size_t length = std::min(1 + below(64), bytes.size() - at);
  switch (seed % 6) {
    case 0:
      bytes.resize(at);
      break;
    case 1:
      for (std::size_t i = 0; i < length; ++i) bytes[at + i] = static_cast<char>(below(256));
      break;
    case 2:
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), length, '\0');
      break;
    case 3:
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), length, '\xff');
      break;
    case 4:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
      break;
    default:
      bytes.erase(at, length);
      break;
  }
  return bytes;
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Reads a damaged file by some verb, over and over: it is read, refused as a file, or what it says
/// is refused as input or numbers.
void expect_survives(const std::string& bytes, unsigned num_seeds, const fs::path& path,
                     const Arguments& arguments) {
  unsigned num_refused = 0;
  for (unsigned seed = 0; seed < num_seeds; ++seed) {
    write_bytes(path, damaged(bytes, seed));
    const ProgramResult result = Program(arguments).run();
    EXPECT_THAT(result.exit_code, AnyOf(0, 2, 3, 4)) << "seed " << seed << ": " << result.err;
    EXPECT_TRUE(result.exit_code == 0 || !result.err.empty()) << "seed " << seed;
    if (result.exit_code == 4) ++num_refused;
  }
  EXPECT_GT(num_refused, num_seeds / 5);
}

TEST(Robustness, DamagedRunFilesAreReadOrRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "run.h5";
  ASSERT_EQ(Program({"run", scene_path("examples/landing.yaml"), "-o", file}).run().exit_code, 0);
  const std::string bytes = contents_of(file);
  const std::string bad = folder / "bad.h5";
  expect_survives(bytes, 60, bad, {"info", bad});
  expect_survives(bytes, 20, bad, {"run", "--resume", bad});
}

TEST(Robustness, DamagedContactLawsAreReadOrRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "law.h5";
  ASSERT_EQ(
      Program({"contact", rough_scene, "--set", "contacts.tip.normal.solver.grid=16", "--table",
               file, "--speeds", "0.01", "1", "4", "--indentations", "0.01", "0.1", "4"})
          .run()
          .exit_code,
      0);
  const std::string bad = folder / "bad.h5";
  expect_survives(contents_of(file), 60, bad,
                  {"eig", rubber_scene, "--set", "contact.normal.form=" + bad});
}

TEST(Robustness, EveryVerbSaysThatAFolderCannotBeWritten) {
  const TemporaryFolder folder;
  const fs::path locked = folder / "locked";
  fs::create_directory(locked);
  fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
  if (::access(locked.c_str(), W_OK) == 0) {
    // The superuser may write everywhere but where a file stands in place of the folder.
    fs::remove(locked);
    write_file(locked, "");
  }
  const std::string at = locked / "a";
  const std::string disc = scene_path("disc_and_pads.yaml");
  for (const Arguments& arguments :
       {Arguments{"run", scene_path("beam_on_beam.yaml"), "-o", at + ".h5"},
        {"contact", rough_scene, "-o", at + ".h5"},
        {"contact", rough_scene, "--table", at + ".h5"},
        {"contact", rough_scene, "--master-curve", at + ".inc"},
        {"cycle", rubber_scene, "-o", at + ".h5"},
        {"map", rubber_scene, "--x", "parameters.v", "0.1", "1", "3", "--y", "parameters.tau0",
         "0.01", "0.1", "3", "-o", at + ".h5"},
        {"locus", disc, "--parameter", "parameters.mu", "--from", "0.1", "--to", "0.2", "--points",
         "2", "-o", at + ".h5"}}) {
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 4) << arguments[0] << ": " << result.err;
    EXPECT_THAT(result.err, HasSubstr("locked")) << arguments[0];
  }
  if (fs::is_directory(locked)) fs::permissions(locked, fs::perms::owner_all);
}

TEST(Robustness, NumbersBeyondComputationAreRefusedWithTheirPlace) {
  const TemporaryFolder folder;
  write_file(folder / "huge.yaml",
             "format: 2\nsubstructures:\n  m: {type: matrices, mass: [[1, 0], [0, 1]],\n"
             "      stiffness: [[1e308, 0], [0, 1e308]]}\n");
  const std::string contact = scene_path("viscoelastic_contact.yaml");
  const struct {
    std::string scene;
    std::string set;
    const char* message;
  } cases[] = {
      {scene_path("beam_on_beam.yaml"), "substructures.oblique.thickness=1e-100 mm",
       "substructures.oblique.thickness: is beyond what can be computed with, 0 or 1e-30 to 1e+30 "
       "m in magnitude; got 1e-103 m"},
      {folder / "huge.yaml", "format=2",
       "substructures.m.stiffness.0.0: is beyond what can be computed with, up to 1e+100 in "
       "magnitude; got 1e+308"},
      {scene_path("disc_and_pads.yaml"), "substructures.disc.spin=1e-308",
       "substructures.disc.spin: is beyond what can be computed with"},
      {contact, "contacts.tip.normal.material.glassy_modulus=1e60",
       "contacts.tip.normal.material.glassy_modulus: is beyond what can be computed with"},
      {scene_path("examples/frozen_growth.yaml"), "substructures.cantilever.damping.alpha=1e200",
       "substructures.cantilever.damping.alpha: is beyond what can be computed with"}};
  for (const auto& [scene, set, message] : cases) {
    const ProgramResult result = Program({"check", scene, "--set", set}).run();
    EXPECT_EQ(result.exit_code, 2) << set;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

TEST(Robustness, NoNumberOfASceneIsAnInternalError) {
  const struct {
    const char* verb;
    const char* scene;
    std::vector<const char*> keys;
  } cases[] = {{"check",
                "examples/stick_slip.yaml",
                {"substructures.reed.thickness", "substructures.reed.length",
                 "substructures.reed.material.density", "drive.load"}},
               {"eig",
                "disc_and_pads.yaml",
                {"substructures.disc.spin", "substructures.disc.thickness"}},
               {"eig", "examples/flutter.yaml", {"parameters.load"}}};
  for (const auto& [verb, scene, keys] : cases) {
    for (const char* key : keys) {
      for (const char* value : {"1e-300", "1e-29", "1e29", "1e99"}) {
        const ProgramResult result =
            Program({verb, scene_path(scene), "--set", std::string(key) + "=" + value}).run();
        EXPECT_THAT(result.exit_code, AnyOf(0, 2, 3)) << key << "=" << value << ": " << result.err;
      }
    }
  }
}

TEST(Robustness, ABrokenLinkIsCalledThat) {
  const TemporaryFolder folder;
  fs::create_symlink("nowhere/at_all.h5", folder / "link.h5");
  for (const char* force : {"--force", "--json"}) {
    const ProgramResult result =
        Program({"run", scene_path("examples/landing.yaml"), "-o", folder / "link.h5", force})
            .run();
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.err, HasSubstr("link.h5: is a broken link, to 'nowhere/at_all.h5'; remove"));
  }
}

TEST(Robustness, AnHdf5FileAsASceneIsCalledThat) {
  const TemporaryFolder folder;
  write_bytes(folder / "run.h5", "\x89HDF\r\n\x1a\n" + std::string(100, '\0'));
  for (const char* verb : {"check", "eig", "compare"}) {
    const ProgramResult result = Program({verb, folder / "run.h5"}).run();
    EXPECT_EQ(result.exit_code, 2) << verb;
    EXPECT_THAT(result.err, HasSubstr("is an HDF5 file, not a scene (YAML); `stridor info` says"));
  }
}

TEST(Robustness, UnknownOptionsGetASuggestion) {
  const ProgramResult result = Program({"eig", rubber_scene, "--coutn=3", "--json"}).run();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("eig has no option '--coutn', did you mean '--count'?"));
}

TEST(Robustness, EveryFailureWithJsonIsOneObject) {
  const TemporaryFolder folder;
  const std::string beams = scene_path("beam_on_beam.yaml");
  const std::string runs_off = scene_path("extreme/runs_off.yaml");
  const std::string missing = folder / "missing";
  const struct {
    Arguments arguments;
    int exit_code;
    const char* key;
    const char* message;
  } cases[] = {
      {{"eig", beams, "--set", "time.stepp=1"}, 2, "time.stepp", "did you mean 'step'"},
      {{"run", beams, "-o", missing + "/x.h5"}, 4, "", "missing"},
      {{"run", beams}, 2, "", "--output is required"},
      {{"locus", beams, "--nope"}, 2, "", "locus has no option '--nope'"},
      {{"infoo", missing}, 2, "", "there is no verb 'infoo', did you mean 'info'"},
      {{"info", missing}, 4, "", "missing"},
      {{"check", missing}, 4, "", "missing"},
      {{"compare", missing}, 4, "", "missing"},
      {{"spectrogram", missing}, 4, "", "missing"},
      {{"plot", missing, "--kind", "history", "-o", folder / "a.png"}, 4, "", "missing"},
      {{"threshold", rubber_scene, "--parameter", "parameters.taw0", "--from", "0", "--to", "1"},
       2,
       "",
       "taw0"},
      {{"map", missing, "--x", "a", "0", "1", "3", "--y", "b", "0", "1", "3"}, 4, "", "missing"},
      {{"cycle", missing}, 4, "", "missing"},
      {{"sweep", missing, "--parameter", "a", "--from", "0", "--to", "1"}, 4, "", "missing"},
      {{"precision", missing}, 4, "", "missing"},
      {{"contact", missing}, 4, "", "missing"}};
  for (const auto& [arguments, exit_code, key, message] : cases) {
    Arguments with_json = arguments;
    with_json.emplace_back("--json");
    const ProgramResult result = Program(with_json).run();
    EXPECT_EQ(result.exit_code, exit_code) << arguments[0] << ": " << result.err;
    const auto object = nlohmann::json::parse(result.out, nullptr, false);
    ASSERT_TRUE(object.is_object()) << arguments[0] << ": " << result.out;
    ASSERT_EQ(object["errors"].size(), 1u) << result.out;
    const auto& error = object["errors"][0];
    EXPECT_EQ(error["key"], *key != '\0' ? key : error["key"]);
    // Messages about a file leave its name out.
    EXPECT_THAT(exit_code == 4
                    ? error["file"].get<std::string>()
                    : error["key"].get<std::string>() + error["message"].get<std::string>(),
                HasSubstr(message));
  }
  // Where there are results, they are beside the errors.
  const ProgramResult result = Program({"run", runs_off, "-o", folder / "off.h5", "--json"}).run();
  EXPECT_EQ(result.exit_code, 3);
  const auto object = nlohmann::json::parse(result.out);
  EXPECT_EQ(object["status"], "failed");
  EXPECT_THAT(object["errors"][0]["message"].get<std::string>(),
              HasSubstr("has left the end of the surface"));
}

TEST(Robustness, TheEnvironmentIsReadOrRefused) {
  const auto with = [](const char* name, const char* value) {
    setenv(name, value, 1);
    // A unit that is not among the common ones.
    const ProgramResult result =
        Program({"check", scene_path("beam_on_beam.yaml"), "--set", "time.end=0.05 min"}).run();
    unsetenv(name);
    return result;
  };
  ProgramResult result = with("UDUNITS2_XML_PATH", "/nowhere.xml");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("udunits2.xml: the database of units cannot be read"));
  EXPECT_EQ(with("STRIDOR_KERNELS", "portable").exit_code, 0);
  result = with("STRIDOR_KERNELS", "v5");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("STRIDOR_KERNELS is 'v5', but may be portable or v3"));
}

TEST(Robustness, PathsWithSpacesAndUnicodeWorkEverywhere) {
  const TemporaryFolder folder;
  const fs::path place = folder / "Räume & 'Größen' 日本";
  fs::create_directory(place);
  fs::copy_file(rough_scene, place / "Kontakt é.yaml");
  fs::copy_file(rubber_scene, place / "Kugel é.yaml");
  const std::string law = place / "Gesetz é.h5";
  EXPECT_EQ(
      Program({"contact", place / "Kontakt é.yaml", "--set", "contacts.tip.normal.solver.grid=16",
               "--table", law, "--speeds", "0.01", "1", "4", "--indentations", "0.01", "0.1", "4"})
          .run()
          .exit_code,
      0);
  const std::string figure = place / "Bild é.png";
  const ProgramResult cycle =
      Program({"cycle", place / "Kugel é.yaml", "--set", "contact.normal.form=" + law, "--set",
               "parameters.v=0.05", "--set", "cycle.settle=0.5", "-o", place / "Zyklus é.h5",
               "--figure", figure})
          .run();
  EXPECT_EQ(cycle.exit_code, 0) << cycle.err;
  EXPECT_GT(fs::file_size(figure), 1000u);
}

/// A file system of its own, of 16 kB, where the system lets us make one.
class SmallDisk {
 public:
  explicit SmallDisk(const fs::path& place) : place_(place) {
    fs::create_directory(place_);
    is_mounted_ = mount("tmpfs", place_.c_str(), "tmpfs", 0, "size=16k") == 0;
  }
  ~SmallDisk() {
    if (is_mounted_) umount2(place_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool is_mounted() const { return is_mounted_; }

 private:
  fs::path place_;
  bool is_mounted_ = false;
};

TEST(Robustness, FullDisksAreReportedAndLeaveNoHalfFile) {
  const TemporaryFolder folder;
  const SmallDisk disk(folder / "disk");
  if (!disk.is_mounted()) GTEST_SKIP() << "needs the right to mount a file system";
  const std::string at = folder / "disk" / "a";
  for (const Arguments& arguments :
       {Arguments{"contact", rough_scene, "-o", at + ".h5"},
        {"cycle", rubber_scene, "--set", "cycle.settle=0.5", "-o", at + ".h5"},
        {"map", rubber_scene, "--x", "parameters.v", "1e-3", "1", "100", "--y", "parameters.tau0",
         "0.01", "0.1", "100", "-o", at + ".h5"}}) {
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 4) << arguments[0] << ": " << result.err;
    EXPECT_THAT(result.err, HasSubstr("No space left on device")) << arguments[0];
    EXPECT_TRUE(fs::is_empty(folder / "disk")) << arguments[0];
  }
  // A run keeps what it could write.
  const ProgramResult run =
      Program({"run", scene_path("beam_on_beam.yaml"), "-o", at + ".h5"}).run();
  EXPECT_EQ(run.exit_code, 4) << run.err;
}

}  // namespace
}  // namespace stridor
