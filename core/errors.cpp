#include "core/errors.hpp"

#include <fmt/format.h>

namespace stridor {
namespace {

std::string join(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& problem : problems) {
    if (!text.empty()) text += '\n';
    text += problem.text();
  }
  return text;
}

}  // namespace

std::string Problem::text() const {
  std::string place = source;
  if (line > 0 && !place.empty()) place += fmt::format(":{}", line);
  if (line > 0 && column > 0 && !place.empty()) place += fmt::format(":{}", column);
  if (!place.empty()) place += ": ";
  if (!key.empty()) place += key + ": ";
  return place + message;
}

ConfigError::ConfigError(std::vector<Problem> problems)
    : std::runtime_error(join(problems)), problems_(std::move(problems)) {}

ConfigError::ConfigError(Refusal refusal, std::string key, std::string message)
    : ConfigError(std::vector<Problem>{{refusal, std::move(key), std::move(message)}}) {}

std::string ConfigError::report() const {
  std::string text;
  for (const Problem& problem : problems_) {
    if (!text.empty()) text += '\n';
    text += with_code(problem.text(), problem.refusal);
    if (!problem.excerpt.empty()) text += '\n' + problem.excerpt;
  }
  return text;
}

FileError::FileError(Refusal refusal, const std::string& path, const std::string& dataset,
                     const std::string& cause)
    : FileError(Problem{
          .refusal = refusal,
          .key = "",
          .message = dataset.empty() ? cause : fmt::format("dataset {}: {}", dataset, cause),
          .source = path,
          .dataset = dataset}) {}

FileError::FileError(Problem problem)
    : std::runtime_error(problem.text()), problem_(std::move(problem)) {}

}  // namespace stridor
