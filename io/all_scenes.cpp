#include "io/all_scenes.hpp"

#include <nlohmann/json.hpp>

#include "io/disc_scene.hpp"
#include "io/scene.hpp"
#include "io/scene_reference.hpp"
#include "io/schema_json.hpp"

namespace stridor {

std::string all_scenes_json_schema() {
  return json_schema(Scene::schema(), {{&DiscScene::schema(), {"disc"}}}).dump(2) + "\n";
}

std::string all_scenes_reference() {
  return scene_reference({&Scene::schema(), &DiscScene::schema()});
}

}  // namespace stridor
