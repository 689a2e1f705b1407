// What is said of scenes outside the program: the JSON Schema, the reference page, and the copies
// of both that are kept in docs/.
#include "io/scene/schema_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "core/units.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_reference.hpp"
#include "tests/io/example_scene.hpp"

namespace stridor {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

const std::string kNames = "^[A-Za-z_][A-Za-z0-9_-]*$";
const std::string kTable = "| key | type | allowed | default | meaning |";

/// The definition that a `$ref` names, else the node itself.
const Json& resolved(const Json& root, const Json& node) {
  if (!node.contains("$ref")) return node;
  return root.at(Json::json_pointer(node.at("$ref").get<std::string>().substr(1)));
}

/// The declaration of a key by its path; NAME is any entry of named maps, N any of a list.
Json declaration(const Json& root, const std::vector<std::string>& path) {
  Json node = root;
  for (const std::string& key : path) {
    node = resolved(root, node);
    if (key == "NAME") {
      node = node.at("patternProperties").at(kNames);
      while (node.contains("else")) node = Json(node.at("else"));  // the first of several forms
    } else if (key == "N") {
      node = node.at("items");
    } else {
      node = node.at("properties").at(key);
    }
  }
  return node;
}

Json scene_key(const std::vector<std::string>& path) {
  return declaration(json_schema(Scene::schema()), path);
}

Json example_key(const std::vector<std::string>& path) {
  return declaration(json_schema(test::Example::schema()), path);
}

bool matches(const Json& declared, const std::string& text) {
  return std::regex_search(text, std::regex(declared.at("pattern").get<std::string>()));
}

TEST(JsonSchema, IsADraft202012SchemaOfOneClosedMap) {
  const Json schema = Json::parse(json_schema_text(Scene::schema()));
  EXPECT_EQ(schema, json_schema(Scene::schema()));
  EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
  EXPECT_EQ(schema["title"], "scene");
  EXPECT_EQ(schema["type"], "object");
  EXPECT_EQ(schema["additionalProperties"], false);
  EXPECT_THAT(schema["required"], Contains("format"));
  EXPECT_THAT(schema["required"], Not(Contains("substructures")));
  EXPECT_THAT(schema["required"], Not(Contains("record")));
}

TEST(JsonSchema, RealIsANumberInItsRangeOrAStringWithUnit) {
  const Json length = scene_key({"substructures", "NAME", "length"});
  EXPECT_EQ(length["title"], "length");
  EXPECT_EQ(length["description"], "Length along the axis. Unit: m. Range: > 0.");
  EXPECT_EQ(length["type"], Json::array({"number", "string"}));
  EXPECT_EQ(length["exclusiveMinimum"], 0);
  EXPECT_FALSE(length.contains("default"));

  const Json ratio = scene_key({"substructures", "NAME", "material", "poissons_ratio"});
  EXPECT_EQ(ratio["exclusiveMinimum"], -1);
  EXPECT_EQ(ratio["exclusiveMaximum"], 0.5);
  EXPECT_THAT(ratio["description"].get<std::string>(), Not(HasSubstr("Unit")));
  const Json angle = scene_key({"substructures", "NAME", "angle"});
  EXPECT_EQ(angle["minimum"], -7);
  EXPECT_EQ(angle["maximum"], 7);
}

TEST(JsonSchema, OptionalKeysCarryTheirDefaults) {
  EXPECT_EQ(scene_key({"measure", "from"})["default"], 0);
  EXPECT_EQ(scene_key({"measure", "band"})["default"], Json::array());
  EXPECT_FALSE(scene_key({"measure", "to"}).contains("default"));
  EXPECT_EQ(scene_key({"time", "integrator"})["default"], "central_difference");
  EXPECT_EQ(scene_key({"substructures", "NAME", "supports", "end"})["default"], "free");
  EXPECT_EQ(example_key({"bodies"})["patternProperties"].size(), 1u);
  EXPECT_EQ(example_key({"energy"})["default"], true);
  EXPECT_EQ(example_key({"channels"})["default"], Json::array({"force"}));
}

TEST(JsonSchema, IntegersHoldTheTighterOfRangeAndStorage) {
  const Json format = scene_key({"format"});
  EXPECT_EQ(format["type"], Json::array({"integer", "string"}));
  EXPECT_TRUE(matches(format, "=2*n"));
  EXPECT_FALSE(matches(format, "1"));
  EXPECT_EQ(format["minimum"], 2);
  EXPECT_EQ(format["maximum"], 2);
  EXPECT_EQ(scene_key({"substructures", "NAME", "mesh", "along"})["maximum"], 1'000'000);
  const Json byte = example_key({"format"});  // std::uint8_t, declared > 0
  EXPECT_EQ(byte["exclusiveMinimum"], 0);
  EXPECT_EQ(byte["maximum"], 255);
}

TEST(JsonSchema, ExpressionsStandWhereNumbersDo) {
  for (const Json& number :
       {scene_key({"substructures", "NAME", "length"}), scene_key({"measure", "band"})["items"],
        scene_key({"drive", "velocity"})["oneOf"][0], scene_key({"contact", "friction", "static"})}) {
    EXPECT_TRUE(matches(number, "=2*mu")) << number;
    EXPECT_TRUE(matches(number, "=-(a + b)^2")) << number;
    EXPECT_FALSE(matches(number, "2*mu")) << number;
    EXPECT_FALSE(matches(number, "=")) << number;
  }
  const Json parameters = scene_key({"parameters"});
  EXPECT_EQ(parameters["type"], "object");
  EXPECT_EQ(parameters["additionalProperties"], false);
  ASSERT_EQ(parameters["patternProperties"].size(), 1u);
  const auto form = parameters["patternProperties"].begin();
  EXPECT_TRUE(std::regex_search("k_x", std::regex(form.key())));
  EXPECT_FALSE(std::regex_search("k-x", std::regex(form.key())));
  for (const char* text : {"0.3", "30 %", "75 mm", "=sqrt(k/m)"})
    EXPECT_TRUE(matches(form.value(), text)) << text;
  EXPECT_FALSE(matches(form.value(), "fast"));
}

TEST(JsonSchema, ChoicesTextsAndListsHaveTheirTypes) {
  EXPECT_EQ(scene_key({"substructures", "NAME", "supports", "end"})["enum"],
            Json::array({"free", "clamped", "pinned", "guided"}));
  EXPECT_EQ(scene_key({"contact", "master"})["type"], "string");
  EXPECT_EQ(scene_key({"contact", "slave"})["type"], Json::array({"string", "array"}));
  EXPECT_EQ(scene_key({"contact", "slave"})["items"]["type"], "string");
  const Json band = scene_key({"measure", "band"});
  EXPECT_EQ(band["type"], "array");
  EXPECT_EQ(band["items"]["exclusiveMinimum"], 0);
  EXPECT_EQ(example_key({"energy"})["type"], "boolean");
}

TEST(JsonSchema, CurveIsARealOrATable) {
  const Json velocity = example_key({"velocity"});
  ASSERT_EQ(velocity["oneOf"].size(), 2u);
  EXPECT_EQ(velocity["oneOf"][0]["maximum"], 10);
  const Json& table = velocity["oneOf"][1];
  EXPECT_EQ(table["required"], Json::array({"times", "values"}));
  EXPECT_EQ(table["additionalProperties"], false);
  EXPECT_EQ(table["properties"]["times"]["minItems"], 1);
  EXPECT_FALSE(table["properties"]["times"]["items"].contains("maximum"));
  EXPECT_EQ(table["properties"]["values"]["items"]["maximum"], 10);
  EXPECT_EQ(scene_key({"drive", "load"})["oneOf"].size(), 2u);
}

TEST(JsonSchema, AlternativesAreToldApartByTheirDiscriminator) {
  const Json schema = json_schema(test::Example::schema());
  const Json bodies = schema["properties"]["bodies"];
  EXPECT_EQ(bodies["additionalProperties"], false);
  const Json form = bodies["patternProperties"][kNames];
  EXPECT_EQ(form["if"]["properties"]["type"]["const"], "lumped");
  EXPECT_EQ(form["if"]["required"], Json::array({"type"}));
  const Json& lumped = resolved(schema, form["then"]);
  EXPECT_EQ(lumped["properties"]["type"]["const"], "lumped");
  EXPECT_EQ(lumped["required"], Json::array({"type", "mass"}));
  EXPECT_TRUE(resolved(schema, form["else"])["properties"].contains("length"));

  EXPECT_EQ(scene_key({"substructures", "NAME", "type"})["const"], "beam");
}

TEST(JsonSchema, DescribesAMapOnce) {
  const Json schema = json_schema(Scene::schema());
  EXPECT_EQ(schema["properties"]["contact"]["$ref"], "#/$defs/contact");
  EXPECT_EQ(schema["properties"]["contacts"]["patternProperties"][kNames]["$ref"],
            "#/$defs/contact");
  EXPECT_FALSE(schema["$defs"].contains("contact_2"));
}

struct Small {
  double a = 0.0;
  static const Schema& schema() {
    static const Schema keys = SchemaOf<Small>("part").real("a", &Small::a, {.doc = "A."});
    return keys;
  }
};
struct Large {
  double b = 0.0;
  static const Schema& schema() {
    static const Schema keys = SchemaOf<Large>("part").real("b", &Large::b, {.doc = "B."});
    return keys;
  }
};
struct Both {
  Small small;
  Large large;
  static const Schema& schema() {
    static const Schema keys = SchemaOf<Both>("both")
                                   .section("small", &Both::small, {.doc = "<S>|*"})
                                   .section("large", &Both::large, {.doc = "`<L>|*`"});
    return keys;
  }
};

TEST(JsonSchema, MapsOfTheSameNameStayApart) {
  const Json schema = json_schema(Both::schema());
  EXPECT_TRUE(declaration(schema, {"small", "a"}).is_object());
  EXPECT_TRUE(declaration(schema, {"large", "b"}).is_object());
}

TEST(JsonSchema, PatternHoldsForWhateverTheReaderTakesForANumber) {
  const Json length = scene_key({"substructures", "NAME", "length"});
  const Json velocity = scene_key({"drive", "velocity"})["oneOf"][0];
  const Json alpha = scene_key({"substructures", "NAME", "damping", "alpha"});
  const Json friction = scene_key({"contact", "friction", "coefficient"});
  const auto both_take = [](const Json& declared, const std::string& unit,
                            const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      EXPECT_NO_THROW(parse_quantity(text, unit)) << text;
      EXPECT_TRUE(matches(declared, text)) << text;
    }
  };
  both_take(length, "m", {"75 mm", "75mm", "0.075", "+.5 m", "1.e-3 km", " 2 m ", "3 µm", "1e-3m"});
  both_take(velocity, "m s-1", {"-30 mm/s", "30 mm s-1", "-1", "2 m.s-1", "3 (km)/h"});
  both_take(alpha, "s-1", {"40", "40 1/s", "40 /s", "0.04 ms-1", "-0", "-0.0 1/s", "-.0"});
  both_take(friction, "", {"0.3", "30 %", "30%", "0.3 1", "3e-1"});

  const auto both_refuse = [](const Json& declared, const std::string& unit,
                              const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      EXPECT_THROW(parse_quantity(text, unit), std::invalid_argument) << text;
      EXPECT_FALSE(matches(declared, text)) << text;
    }
  };
  both_refuse(velocity, "m s-1",
              {"", "fast", "mm/s 30", "30 40 mm/s", "+-1", ".", "e3", "1,5 m/s"});
  both_refuse(friction, "", {"0.3 mm", "30 % 2", "thirty", "-"});
  // Of a range, the sign.
  EXPECT_FALSE(matches(length, "-75 mm"));
  EXPECT_FALSE(matches(length, "-0 mm"));
  EXPECT_FALSE(matches(alpha, "-40 1/s"));
  EXPECT_FALSE(matches(alpha, "-0.01"));
}

/// Every map of a schema, once, with its path as the reference page writes it.
void walk(const Schema& schema, const std::string& path, std::set<const Schema*>& seen,
          const std::function<void(const std::string&, const Schema&)>& see) {
  if (!seen.insert(&schema).second) return;
  see(path.empty() ? schema.name : path, schema);
  for (const Key& key : schema.keys) {
    std::string below = path.empty() ? key.name : path + "." + key.name;
    if (key.kind == KeyKind::named_sections) below += ".NAME";
    if (key.kind == KeyKind::section_list) below += ".N";
    for (const Alternative& alternative : key.alternatives) {
      const std::string kind =
          key.discriminator.empty() ? "" : " (" + key.discriminator + ": " + alternative.name + ")";
      const std::size_t suffix = path.find(" (");
      walk(alternative.schema(),
           suffix == std::string::npos
               ? below + kind
               : path.substr(0, suffix) + below.substr(path.size()) + path.substr(suffix) + kind,
           seen, see);
    }
  }
}

TEST(JsonSchema, HasEveryKeyOfScenes) {
  const Json root = json_schema(Scene::schema());
  std::map<std::string, Json> maps{{"scene", root}};
  for (const auto& [name, definition] : root["$defs"].items()) maps[name] = definition;
  std::set<const Schema*> seen;
  int num_keys = 0;
  walk(Scene::schema(), "", seen, [&](const std::string& path, const Schema& schema) {
    ASSERT_TRUE(maps.contains(schema.name)) << path;
    const Json& map = maps[schema.name];
    const Json required = map.value("required", Json::array());
    for (const Key& key : schema.keys) {
      ++num_keys;
      ASSERT_TRUE(map["properties"].contains(key.name)) << path << "." << key.name;
      EXPECT_THAT(map["properties"][key.name]["description"].get<std::string>(),
                  HasSubstr(key.doc));
      const bool is_required =
          std::find(required.begin(), required.end(), Json(key.name)) != required.end();
      EXPECT_EQ(is_required, !key.is_optional) << path << "." << key.name;
    }
  });
  EXPECT_GT(num_keys, 50);
}

/// The sections of the page by heading.
std::map<std::string, std::string> sections_of(const std::string& page) {
  std::map<std::string, std::string> sections;
  std::istringstream lines(page);
  std::string heading;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) {
      heading = line.substr(3);
      EXPECT_FALSE(sections.contains(heading)) << heading << " occurs twice";
    }
    sections[heading] += line + "\n";
  }
  return sections;
}

TEST(SceneReference, HasEveryKeyOfScenes) {
  for (const Schema* schema : {&Scene::schema(), &test::Example::schema()}) {
    const auto sections = sections_of(scene_reference(*schema));
    std::set<const Schema*> seen;
    walk(*schema, "", seen, [&](const std::string& path, const Schema& map) {
      ASSERT_TRUE(sections.contains(path)) << path;
      for (const Key& key : map.keys) {
        EXPECT_THAT(sections.at(path), HasSubstr("\n| `" + key.name + "` | ")) << path;
      }
    });
  }
}

TEST(SceneReference, SaysTypeUnitRangeAndDefault) {
  const auto sections = sections_of(scene_reference(Scene::schema()));
  const auto& beam = sections.at("substructures.NAME (type: beam)");
  EXPECT_THAT(beam, HasSubstr("| `type` | choice | `beam` | required |"));
  EXPECT_THAT(beam,
              HasSubstr("| `length` | number, m | `> 0` | required | Length along the axis. |"));
  EXPECT_THAT(beam, HasSubstr("| `material` | [map](#substructuresnamematerial-type-beam) |  | "
                              "required | Isotropic"));
  EXPECT_THAT(sections.at("measure"),
              HasSubstr("| `from` | number, s | `>= 0` | `0` | Start of the window"));
  EXPECT_THAT(sections.at("measure"), HasSubstr("| `to` | number, s | `> 0` | optional | "));
  EXPECT_THAT(sections.at("contact"),
              HasSubstr("| `sliding` | choice | `moving`, `frozen` | `moving` | "));
  EXPECT_THAT(sections.at("drive"), HasSubstr("| `load` | curve, N |  | `0` | "));
  EXPECT_THAT(sections.at("contacts.NAME"), HasSubstr("The keys of [contact](#contact)."));
  EXPECT_THAT(sections.at("contacts.NAME"), Not(HasSubstr(kTable)));
}

TEST(SceneReference, KeepsDocsOutOfTheMarkup) {
  const std::string page = scene_reference(Both::schema());
  EXPECT_THAT(page, HasSubstr("| &lt;S>\\|\\* |\n"));
  EXPECT_THAT(page, HasSubstr("| `<L>\\|*` |\n"));
}

TEST(SceneReference, EveryLinkLeadsToAHeading) {
  for (const Schema* schema : {&Scene::schema(), &test::Example::schema()}) {
    const std::string page = scene_reference(*schema);
    std::set<std::string> anchors;
    for (const auto& [heading, text] : sections_of(page)) {
      // As GitHub makes them: punctuation goes, blanks become hyphens.
      std::string anchor = std::regex_replace(heading, std::regex("[^A-Za-z0-9_ -]"), "");
      std::replace(anchor.begin(), anchor.end(), ' ', '-');
      for (char& c : anchor) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      anchors.insert(anchor);
    }
    int num_links = 0;
    const std::regex link(R"(\]\(#([^)]*)\))");
    for (std::sregex_iterator found(page.begin(), page.end(), link), end; found != end; ++found) {
      EXPECT_TRUE(anchors.contains((*found)[1])) << (*found)[1];
      ++num_links;
    }
    EXPECT_GT(num_links, 3);
  }
}

void expect_current(const std::string& name, const std::string& made, const std::string& command) {
  std::ifstream file(std::string(STRIDOR_SOURCE_DIR) + "/" + name, std::ios::binary);
  ASSERT_TRUE(file) << name << " is missing; make it with: " << command;
  const std::string kept{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(kept == made) << name << " is stale; make it anew with: " << command;
}

TEST(SceneReference, PageOnDiskIsCurrent) {
  expect_current("docs/scene_reference.md", scene_reference(Scene::schema()),
                 "build/release/stridor schema --reference > docs/scene_reference.md");
}

TEST(JsonSchema, FileOnDiskIsCurrent) {
  expect_current("docs/scene.schema.json", json_schema_text(Scene::schema()),
                 "build/release/stridor schema > docs/scene.schema.json");
}

TEST(JsonSchema, EveryShippedSceneNamesItForEditors) {
  const std::filesystem::path source = STRIDOR_SOURCE_DIR;
  int num_scenes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source / "scenes")) {
    const std::filesystem::path& path = entry.path();
    if (path.extension() != ".yaml") continue;
    ++num_scenes;
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    const auto schema =
        (source / "docs" / "scene.schema.json").lexically_relative(path.parent_path());
    EXPECT_EQ(line, "# yaml-language-server: $schema=" + schema.string()) << path;
  }
  EXPECT_GE(num_scenes, 60);
}

}  // namespace
}  // namespace stridor
