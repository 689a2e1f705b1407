#include "app/results/file_attributes.hpp"

#include "core/version.hpp"

namespace stridor {

Attributes source_attributes(const LoadedScene& loaded, const std::string& command_line) {
  return {{"scene", loaded.path},
          {"scene_hash", loaded.hash()},
          {"scene_resolved", loaded.resolved()},
          {"command", command_line},
          {"version", std::string(version)},
          {"commit", std::string(commit)},
          {"date", utc_now()}};
}

void append_results(const Json& results, Attributes& attributes) {
  for (const auto& [name, value] : results.items()) {
    if (value.is_string()) attributes.emplace_back(name, value.get<std::string>());
    if (value.is_number()) attributes.emplace_back(name, value.get<double>());
    if (!value.is_object()) continue;
    Attributes inner;
    append_results(value, inner);
    for (auto& [last, content] : inner)
      attributes.emplace_back(name + "." + last, std::move(content));
  }
}

}  // namespace stridor
