// Checks on the source text itself: which folder may include which, and what must not appear where.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <regex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

/// The folders of the program; each includes only from itself and from those before it.
const Strings folders_in_order{"core",   "substructures", "coupling", "solvers",
                               "models", "analysis",      "io",       "app"};

/// The rooms of a folder; each includes only from itself and from those before it. What stands in
/// none, as main.cpp, may include from all of its folder.
const std::map<std::string, Strings> rooms_in_order{
    {"substructures", {"matrices", "elements", "reduction", "bodies"}},
    {"coupling", {"kinematics", "laws", "system"}},
    {"solvers",
     {"algebra", "half_space", "eigenvalues", "equilibrium", "integrators", "contact",
      "transient"}},
    {"io", {"hdf5", "imports", "scene", "run_file", "results", "figures", "report"}},
    {"app", {"terminal", "results", "stability", "runs", "report", "verbs"}}};
/// The files that stand in no room of a folder that has rooms.
const Strings files_without_room{"app/main.cpp"};

/// Only these know in which formats scenes and runs are stored.
constexpr std::array<std::string_view, 2> storage_folders{"io", "app"};
/// These work on any system, so no model is named in them.
constexpr std::array<std::string_view, 2> model_free_folders{"solvers", "analysis"};
constexpr std::array<std::string_view, 8> model_words{
    "sphere", "spheres", "disc", "discs", "cantilever", "cantilevers", "oblique", "obliques"};

template <class Range>
bool contains(const Range& range, std::string_view value) {
  return std::find(std::begin(range), std::end(range), value) != std::end(range);
}

struct SourceLine {
  std::string text;                ///< without comments
  bool starts_in_literal = false;  ///< the line before it left a raw string open
};

/// The lines of a C++ text with every comment blanked out. String and character literals stay, so
/// that a comment sign inside them is not taken for one.
std::vector<SourceLine> lines_without_comments(std::string_view text) {
  enum class State { code, line_comment, block_comment, string, character, raw_string };
  std::vector<SourceLine> lines(1);
  State state = State::code;
  std::string raw_end;  // )delimiter" of the raw string being read
  const auto is_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
  };

  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const char next = i + 1 < text.size() ? text[i + 1] : '\0';
    const char previous = i > 0 ? text[i - 1] : '\0';
    if (c == '\n') {
      if (state == State::line_comment && previous != '\\') state = State::code;
      lines.push_back({"", state == State::raw_string});
      continue;
    }
    std::string& line = lines.back().text;
    switch (state) {
      case State::code:
        if (c == '/' && (next == '/' || next == '*')) {
          state = next == '/' ? State::line_comment : State::block_comment;
          line += "  ";
          ++i;
          continue;
        }
        if (c == '"' && previous == 'R') {
          const std::size_t open = text.find('(', i);
          if (open != std::string_view::npos) {
            raw_end = ')';
            raw_end += text.substr(i + 1, open - i - 1);
            raw_end += '"';
            state = State::raw_string;
          }
        } else if (c == '"') {
          state = State::string;
        } else if (c == '\'' && !is_word(previous)) {  // the ' in 1'000 opens nothing
          state = State::character;
        }
        line += c;
        break;
      case State::line_comment:
        break;
      case State::block_comment:
        if (c == '*' && next == '/') {
          state = State::code;
          ++i;
        }
        break;
      case State::string:
      case State::character:
        line += c;
        if (c == '\\' && next != '\n' && next != '\0') {
          line += next;
          ++i;
        } else if (c == (state == State::string ? '"' : '\'')) {
          state = State::code;
        }
        break;
      case State::raw_string:
        line += c;
        if (text.substr(i, raw_end.size()) == raw_end) {
          line += raw_end.substr(1);
          i += raw_end.size() - 1;
          state = State::code;
        }
        break;
    }
  }
  return lines;
}

/// The first model word in a text. Words end where letters end and where case changes, so that
/// SphereDrag and sphere_mass hold one and `discrete` does not.
std::optional<std::string> model_word_in(const std::string& text) {
  static const std::regex word("[A-Z]+(?![a-z])|[A-Z]?[a-z]+");
  for (std::sregex_iterator match(text.begin(), text.end(), word), end; match != end; ++match) {
    std::string lower = match->str();
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (contains(model_words, lower)) return lower;
  }
  return std::nullopt;
}

/// File name without the ".in" of a template that CMake fills in.
fs::path compiled_name(const fs::path& file) {
  return file.extension() == ".in" ? file.stem() : file.filename();
}
bool is_header(const fs::path& file) {
  constexpr std::array<std::string_view, 4> extensions{".hpp", ".h", ".ipp", ".inl"};
  return contains(extensions, compiled_name(file).extension().string());
}
bool is_source(const fs::path& file) {
  constexpr std::array<std::string_view, 3> extensions{".cpp", ".cc", ".c"};
  return contains(extensions, compiled_name(file).extension().string());
}

bool is_storage_header(const std::string& header) {
  static const std::regex storage("(.*/)?(hdf5(_hl)?\\.h|H5[A-Za-z]*\\.h)|yaml-cpp/.*");
  return std::regex_match(header, storage);
}

/// The room of a file, or nothing where its folder has none or it stands outside of them.
std::optional<std::size_t> room_of(const fs::path& file) {
  const auto rooms = rooms_in_order.find(file.begin()->string());
  if (rooms == rooms_in_order.end()) return std::nullopt;
  const std::string name = std::next(file.begin())->string();
  const auto room = std::find(rooms->second.begin(), rooms->second.end(), name);
  if (room == rooms->second.end()) return std::nullopt;
  return static_cast<std::size_t>(room - rooms->second.begin());
}

/// Problems of one #include of a file, both with their paths from the root.
Strings problems_of_include(const fs::path& file, const std::string& header, bool is_quoted,
                            const Strings& folders) {
  const std::string folder = file.begin()->string();
  Strings problems;
  if (is_storage_header(header)) {
    if (!contains(storage_folders, folder)) {
      problems.push_back("includes " + header + ", which only io and app may");
    }
    return problems;
  }
  const fs::path path(header);
  const std::string from = path.begin()->string();
  const bool is_plain = std::none_of(
      path.begin(), path.end(), [](const fs::path& part) { return part == "." || part == ".."; });
  const auto place = std::find(folders.begin(), folders.end(), from);
  if (place == folders.end() || std::next(path.begin()) == path.end() || !is_plain) {
    if (is_quoted) problems.push_back("\"" + header + "\" is not written from the root");
    return problems;
  }
  if (!is_quoted)
    problems.push_back("<" + header + "> is a header of this program; write it in quotes");
  if (place > std::find(folders.begin(), folders.end(), folder)) {
    problems.push_back(folder + " includes \"" + header + "\", but " + from +
                       " does not stand above it");
  }
  const auto room = room_of(file);
  const auto other = room_of(path);
  if (from == folder && room && other && *other > *room) {
    problems.push_back(file.parent_path().generic_string() + " includes \"" + header +
                       "\", but that room does not stand above it");
  }
  return problems;
}

/// Files that stand in no room though their folder has rooms.
Strings files_outside_rooms(const fs::path& root) {
  Strings outside;
  for (const auto& [folder, rooms] : rooms_in_order) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!is_header(entry.path()) && !is_source(entry.path())) continue;
      const fs::path file = entry.path().lexically_relative(root);
      if (!room_of(file) && !contains(files_without_room, file.generic_string()))
        outside.push_back(file.generic_string());
    }
  }
  std::sort(outside.begin(), outside.end());
  return outside;
}

/// Checks every C++ file below the folders of `root`.
/// @param folders names of the folders, each of which may include from itself and those before it
/// @return "file:line: what is wrong", in the order of the folders, then of the file names
/// @throws std::invalid_argument where one of the folders does not exist
Strings check_tree(const fs::path& root, const Strings& folders) {
  static const std::regex include_line("^\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  static const std::regex pragma_once("^\\s*#\\s*pragma\\s+once\\s*$");
  Strings problems;
  for (const std::string& folder : folders) {
    if (!fs::is_directory(root / folder)) {
      throw std::invalid_argument("no folder '" + folder + "' in " + root.string());
    }
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (is_header(entry.path()) || is_source(entry.path())) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());

    for (const fs::path& file : files) {
      const std::string name = file.lexically_relative(root).generic_string();
      const auto report = [&](std::size_t line, const std::string& problem) {
        problems.push_back(name + ":" + std::to_string(line) + ": " + problem);
      };
      const bool is_model_free = contains(model_free_folders, folder);
      if (is_model_free) {
        if (const auto word = model_word_in(name)) report(1, "names a model: " + *word);
      }

      std::ifstream stream(file, std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(stream),
                             std::istreambuf_iterator<char>()};
      const std::vector<SourceLine> lines = lines_without_comments(text);
      bool has_pragma_once = false;
      for (std::size_t i = 0; i < lines.size(); ++i) {
        std::string line = lines[i].text;
        if (!line.empty() && line.back() == '\r') line.pop_back();
        std::smatch match;
        if (!lines[i].starts_in_literal && std::regex_match(line, match, include_line)) {
          for (const std::string& problem :
               problems_of_include(name, match[2], match[1] == "\"", folders)) {
            report(i + 1, problem);
          }
          continue;
        }
        if (!lines[i].starts_in_literal && std::regex_match(line, pragma_once))
          has_pragma_once = true;
        if (is_model_free) {
          if (const auto word = model_word_in(line)) report(i + 1, "names a model: " + *word);
        }
      }
      if (is_header(file) && !has_pragma_once) report(1, "header without #pragma once");
    }
  }
  return problems;
}

/// Sources below a folder that its CMakeLists.txt does not name: nobody compiles them.
/// @throws std::invalid_argument where the folder has none
Strings unlisted_sources(const fs::path& folder) {
  std::ifstream stream(folder / "CMakeLists.txt");
  if (!stream) throw std::invalid_argument("no CMakeLists.txt in " + folder.string());
  std::string list{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  std::replace_if(
      list.begin(), list.end(),
      [](unsigned char c) { return std::isspace(c) || c == '(' || c == ')'; }, ' ');
  list = ' ' + list + ' ';
  Strings unlisted;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path& file = entry.path();
    // Folders with a list of their own.
    if (file.parent_path() != folder && fs::exists(file.parent_path() / "CMakeLists.txt")) continue;
    const std::string name = file.lexically_relative(folder).generic_string();
    if (is_source(file) && list.find(' ' + name + ' ') == std::string::npos)
      unlisted.push_back(name);
  }
  std::sort(unlisted.begin(), unlisted.end());
  return unlisted;
}

/// A name, as of the struct of a type of body, and the files that may use it.
struct OwnedName {
  std::string name;
  Strings files;
};

/// Lines of code that use a name outside its own files and its registration.
/// @return "file:line: names <name>"
Strings strangers_to(const fs::path& root, const std::vector<OwnedName>& types) {
  Strings found;
  for (const std::string& folder : folders_in_order) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!is_header(entry.path()) && !is_source(entry.path())) continue;
      const std::string name = entry.path().lexically_relative(root).generic_string();
      std::ifstream stream(entry.path(), std::ios::binary);
      const std::string text{std::istreambuf_iterator<char>(stream),
                             std::istreambuf_iterator<char>()};
      const std::vector<SourceLine> lines = lines_without_comments(text);
      for (const OwnedName& type : types) {
        if (contains(type.files, name)) continue;
        const std::regex word("\\b" + type.name + "\\b");
        for (std::size_t i = 0; i < lines.size(); ++i) {
          if (std::regex_search(lines[i].text, word))
            found.push_back(name + ":" + std::to_string(i + 1) + ": names " + type.name);
        }
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// A source tree in a temporary folder, removed at the end of the test.
class SourceText : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    root_ = fs::path(testing::TempDir()) /
            ("stridor_" + std::string(test->name()) + "_" + std::to_string(getpid()));
    fs::remove_all(root_);
    for (const std::string& folder : folders_in_order) fs::create_directories(root_ / folder);
  }
  void TearDown() override { fs::remove_all(root_); }

  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream stream(root_ / name);
    stream << text;
    ASSERT_TRUE(stream.flush()) << "cannot write " << root_ / name;
  }
  Strings problems() const { return check_tree(root_, folders_in_order); }

  fs::path root_;
};

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(IncludeOrder, HoldsInThisSourceTree) {
  EXPECT_THAT(check_tree(STRIDOR_SOURCE_DIR, folders_in_order), IsEmpty());
}

TEST(Rooms, HoldEveryFile) {
  EXPECT_THAT(files_outside_rooms(STRIDOR_SOURCE_DIR), IsEmpty());
}

TEST_F(SourceText, RoomsIncludeFromThoseAboveThem) {
  write("coupling/laws/friction.hpp", "#pragma once\n#include \"coupling/kinematics/gap.hpp\"\n");
  write("coupling/kinematics/gap.hpp", "#pragma once\n#include \"coupling/laws/friction.hpp\"\n");
  write("app/main.cpp", "#include \"app/verbs/run.hpp\"\n#include \"app/terminal/bar.hpp\"\n");
  write("coupling/lost.cpp", "");
  EXPECT_THAT(problems(),
              ElementsAre("coupling/kinematics/gap.hpp:2: coupling/kinematics includes "
                          "\"coupling/laws/friction.hpp\", but that room does not stand above it"));
  EXPECT_THAT(files_outside_rooms(root_), ElementsAre("coupling/lost.cpp"));
}

TEST(BodyTypes, AreNamedInTheirOwnFilesAndWhereTheyAreRegisteredOnly) {
  const std::string list = "substructures/bodies/body_types.cpp";
  const std::vector<OwnedName> types{
      {"BeamParameters",
       {list, "substructures/bodies/beam.hpp", "substructures/bodies/beam.cpp", "substructures/bodies/beam_keys.cpp",
        "substructures/bodies/beam_additions.hpp", "substructures/bodies/beam_additions.cpp"}},
      {"LumpedParameters",
       {list, "substructures/bodies/lumped_body.hpp", "substructures/bodies/lumped_body.cpp"}},
      {"TouchedMatrixBodyParameters",
       {list, "substructures/bodies/matrix_body.hpp", "substructures/bodies/matrix_body.cpp",
        "substructures/bodies/matrix_keys.cpp", "substructures/bodies/nodal_body.hpp",
        "substructures/bodies/nodal_body.cpp"}},
      {"MeshBodyParameters",
       {list, "substructures/bodies/mesh_body.hpp", "substructures/bodies/mesh_body.cpp",
        "substructures/bodies/meshed_body.hpp", "substructures/bodies/meshed_body.cpp",
        "substructures/bodies/mesh_additions.hpp", "substructures/bodies/mesh_additions.cpp",
        "substructures/bodies/mesh_constraints.hpp", "substructures/bodies/mesh_constraints.cpp",
        "substructures/bodies/mesh_spin.hpp", "substructures/bodies/mesh_spin.cpp",
        "substructures/bodies/named_mesh.hpp", "substructures/bodies/named_mesh.cpp",
        "substructures/bodies/nodal_body.cpp"}}};
  EXPECT_THAT(strangers_to(STRIDOR_SOURCE_DIR, types), IsEmpty());
}

TEST(FrictionLaws, AreNamedInTheirOwnFilesAndWhereTheyAreRegisteredOnly) {
  const std::string list = "coupling/laws/friction_laws.cpp";
  std::vector<OwnedName> names;
  for (const std::string law : {"constant", "static_dynamic", "stribeck", "shear"}) {
    const Strings own{list, "coupling/laws/" + law + "_friction.hpp"};
    names.push_back({law + "_friction_type", own});
    // A constant coefficient is also what discs have and what a law without a section is.
    if (law != "constant") names.push_back({law + "_friction", own});
  }
  // As words of scenes; the other two are words of the language, too.
  names.push_back({"static_dynamic", {"coupling/laws/static_dynamic_friction.hpp"}});
  names.push_back({"stribeck", {"coupling/laws/stribeck_friction.hpp"}});
  names.push_back({"StribeckFriction", {"coupling/laws/stribeck_friction.hpp"}});
  EXPECT_THAT(strangers_to(STRIDOR_SOURCE_DIR, names), IsEmpty());
  // The words are where they should be, so that the search finds what there is.
  EXPECT_THAT(strangers_to(STRIDOR_SOURCE_DIR, {{"stribeck", {}}}), ::testing::SizeIs(1));
}

TEST(NormalLaws, AreNamedInTheirOwnFilesAndWhereTheyAreRegisteredOnly) {
  const std::string laws = "coupling/laws/";
  const std::string list = laws + "normal_laws.cpp";
  const Strings viscoelastic{laws + "viscoelastic_normal_law.hpp", laws + "viscoelastic_normal_law.cpp"};
  const std::vector<OwnedName> names{
      {"multiplier_law_type", {list, laws + "multiplier_law.hpp"}},
      {"penalty_law_type", {list, laws + "penalty_law.hpp"}},
      {"viscoelastic_law_type", {list, viscoelastic[0], viscoelastic[1]}},
      {"multiplier_law", {list, laws + "multiplier_law.hpp"}},
      {"penalty_law", {list, laws + "penalty_law.hpp"}},
      {"viscoelastic_normal_law", {list, viscoelastic[0], viscoelastic[1]}}};
  EXPECT_THAT(strangers_to(STRIDOR_SOURCE_DIR, names), IsEmpty());
  // They are where they should be, so that the search finds what there is.
  EXPECT_THAT(strangers_to(STRIDOR_SOURCE_DIR, {{"penalty_law_type", {}}}), ::testing::SizeIs(2));
}

TEST_F(SourceText, StrangersThatNameABodyAreFound) {
  write("substructures/rod.hpp", "#pragma once\nstruct RodParameters {};\n");
  write("models/model.cpp", "// RodParameters\nint RodParametersOfOld;\nRodParameters rod;\n");
  EXPECT_THAT(strangers_to(root_, {{"RodParameters", {"substructures/rod.hpp"}}}),
              ElementsAre("models/model.cpp:3: names RodParameters"));
}

TEST(SourceLists, NameEverySource) {
  const fs::path root = STRIDOR_SOURCE_DIR;
  for (const std::string& folder : folders_in_order)
    EXPECT_THAT(unlisted_sources(root / folder), IsEmpty()) << folder;
  EXPECT_THAT(unlisted_sources(root / "tests"), IsEmpty());
}

TEST_F(SourceText, SourcesThatNoListNamesAreFound) {
  write("tests/CMakeLists.txt", "test(a SOURCES a_test.cpp\n  io/b_test.cpp)\n");
  write("tests/a_test.cpp", "");
  write("tests/io/b_test.cpp", "");
  write("tests/b_test.cpp", "");
  write("tests/io/b_test.hpp", "");
  write("tests/io/lost_test.cpp", "");
  write("tests/fuzz/CMakeLists.txt", "");
  write("tests/fuzz/own.cpp", "");
  EXPECT_THAT(unlisted_sources(root_ / "tests"), ElementsAre("b_test.cpp", "io/lost_test.cpp"));
}

TEST_F(SourceText, MayIncludeFromItsOwnFolderAndThoseAbove) {
  write("coupling/gap.hpp", "#pragma once\n#include <vector>\n#include \"core/units.hpp\"\n");
  write("coupling/gap.cpp", "#include \"coupling/gap.hpp\"\n#include \"substructures/bodies/beam.hpp\"\n");
  write("app/main.cpp", "#include \"io/run_file/run_file.hpp\"\n#include \"core/version.hpp\"\n");
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(SourceText, MayNotIncludeFromAFolderBelow) {
  write("core/units.cpp", "\n#include \"coupling/gap.hpp\"\n");
  write("models/detail/drive.cpp", "  #  include \"analysis/locus.hpp\"  // for later\n");
  EXPECT_THAT(
      problems(),
      ElementsAre("core/units.cpp:2: core includes \"coupling/gap.hpp\", but coupling does not "
                  "stand above it",
                  "models/detail/drive.cpp:1: models includes \"analysis/locus.hpp\", but analysis "
                  "does not stand above it"));
}

TEST_F(SourceText, OrderIsThatOfTheListGiven) {
  write("io/a.cpp", "#include \"core/b.hpp\"\n");
  EXPECT_THAT(check_tree(root_, {"core", "io"}), IsEmpty());
  EXPECT_THAT(
      check_tree(root_, {"io", "core"}),
      ElementsAre("io/a.cpp:1: io includes \"core/b.hpp\", but core does not stand above it"));
}

TEST_F(SourceText, QuotedIncludesAreWrittenFromTheRoot) {
  write(
      "coupling/gap.cpp",
      "#include \"gap.hpp\"\n#include \"../core/units.hpp\"\n#include \"core/../core/units.hpp\"\n"
      "#include \"vendor/tool.hpp\"\n#include \"core\"\n");
  EXPECT_THAT(
      problems(),
      ElementsAre("coupling/gap.cpp:1: \"gap.hpp\" is not written from the root",
                  "coupling/gap.cpp:2: \"../core/units.hpp\" is not written from the root",
                  "coupling/gap.cpp:3: \"core/../core/units.hpp\" is not written from the root",
                  "coupling/gap.cpp:4: \"vendor/tool.hpp\" is not written from the root",
                  "coupling/gap.cpp:5: \"core\" is not written from the root"));
}

TEST_F(SourceText, AngleBracketsDoNotGetRoundTheOrder) {
  write("core/units.cpp", "#include <io/run_file/run_file.hpp>\n#include <fmt/core.h>\n");
  EXPECT_THAT(
      problems(),
      ElementsAre(
          "core/units.cpp:1: <io/run_file/run_file.hpp> is a header of this program; write it in quotes",
          "core/units.cpp:1: core includes \"io/run_file/run_file.hpp\", but io does not stand above it"));
}

TEST_F(SourceText, OnlyIoAndAppIncludeStorageHeaders) {
  const std::string text =
      "#include <hdf5.h>\n#include <hdf5_hl.h>\n#include \"hdf5/serial/H5Cpp.h\"\n"
      "#include <yaml-cpp/yaml.h>\n";
  write("analysis/ledger.cpp", text);
  write("app/main.cpp", text);
  write("io/run_file/run_file.cpp", text);
  EXPECT_THAT(
      problems(),
      ElementsAre("analysis/ledger.cpp:1: includes hdf5.h, which only io and app may",
                  "analysis/ledger.cpp:2: includes hdf5_hl.h, which only io and app may",
                  "analysis/ledger.cpp:3: includes hdf5/serial/H5Cpp.h, which only io and app may",
                  "analysis/ledger.cpp:4: includes yaml-cpp/yaml.h, which only io and app may"));
}

TEST_F(SourceText, SolversAndAnalysisNameNoModel) {
  write("analysis/map.cpp", "const char* key = \"disc.speed\";\nint DISC_COUNT;\n");
  write("solvers/oblique_step.cpp", "");
  write("solvers/step.cpp", "struct SphereDrag {};\nint two_spheres;\ndouble cantilever_length;\n");
  EXPECT_THAT(problems(), ElementsAre("solvers/oblique_step.cpp:1: names a model: oblique",
                                      "solvers/step.cpp:1: names a model: sphere",
                                      "solvers/step.cpp:2: names a model: spheres",
                                      "solvers/step.cpp:3: names a model: cantilever",
                                      "analysis/map.cpp:1: names a model: disc",
                                      "analysis/map.cpp:2: names a model: disc"));
}

TEST_F(SourceText, CommentsLikeWordsAndOtherFoldersMayNameAModel) {
  write("solvers/step.cpp",
        "// as for the sphere \\\n   and the disc\nint discrete;  /* cantilever\n oblique */ int "
        "discard;\n"
        "double Discretisation, atmosphere;\nchar quote = '\"';  // sphere\nint many = 1'000;  // "
        "disc's\n");
  write("models/sphere.cpp", "struct Sphere {};\n");
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(SourceText, CommentSignsInLiteralsHideNothing) {
  write("solvers/step.cpp",
        "const char* a = \"http://\\\"\"; int sphere;\nconst char* b = R\"x(/* \" )\" )x\"; int "
        "disc;\n");
  EXPECT_THAT(problems(), ElementsAre("solvers/step.cpp:1: names a model: sphere",
                                      "solvers/step.cpp:2: names a model: disc"));
}

TEST_F(SourceText, IncludesInCommentsAndRawStringsDoNotCount) {
  write("core/units.cpp",
        "// #include \"io/a.hpp\"\n/*\n#include \"io/b.hpp\"\n*/\nconst char* c = R\"(\n#include "
        "\"io/c.hpp\"\n)\";\n");
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(SourceText, HeadersHavePragmaOnce) {
  write("core/good.hpp", "// First a comment.\n#pragma once\n");
  write("core/source.cpp", "int x;\n");
  write("core/version.hpp.in", "int version;\n");
  write("core/words.hpp", "// #pragma once\nint x;\n");
  EXPECT_THAT(problems(), ElementsAre("core/version.hpp.in:1: header without #pragma once",
                                      "core/words.hpp:1: header without #pragma once"));
}

TEST_F(SourceText, MissingFolderIsRejected) {
  try {
    check_tree(root_, {"core", "nowhere"});
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(error.what(), "no folder 'nowhere' in " + root_.string());
  }
}

}  // namespace
