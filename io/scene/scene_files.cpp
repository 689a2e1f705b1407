#include "io/scene/scene_files.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <sstream>

#include "core/checksum.hpp"
#include "core/errors.hpp"
#include "io/hdf5/regular_file.hpp"
#include "io/scene/body_reader.hpp"

namespace stridor {
namespace {

constexpr const char* initial_state_key = "initial.state";
/// Stands for the scene itself in the list of digests; no file is named by a key like this.
constexpr const char* text_key = "/scene/text";

std::string digits(std::uint64_t sum) {
  return fmt::format("{:016x}", sum);
}

std::string digest_of_file(const std::string& path) {
  refuse_irregular_file(path);
  const OpenFile file(std::fopen(path.c_str(), "rbe"));
  if (!file)
    throw FileError(Refusal::cannot_read, path, "",
                    fmt::format("cannot be opened: {}", std::strerror(errno)));
  std::vector<char> buffer(std::size_t{1} << 18);
  std::uint64_t sum = fnv1a(std::string_view());
  for (std::size_t count = buffer.size(); count == buffer.size();) {
    count = std::fread(buffer.data(), 1, buffer.size(), file.get());
    sum = fnv1a(std::string_view(buffer.data(), count), sum);
  }
  if (std::ferror(file.get()) != 0)
    throw FileError(Refusal::cannot_read, path, "",
                    fmt::format("cannot be read: {}", std::strerror(errno)));
  return digits(sum);
}

void add_file(std::vector<SceneFile>& files, const SceneNode& tree, const std::string& key,
              const std::string& name) {
  const std::string path =
      std::filesystem::absolute(path_of_file(tree, key, name)).lexically_normal().string();
  files.push_back({key, path, digest_of_file(path)});
}

/// A path in one line.
std::string escaped(const std::string& path) {
  std::string text;
  for (const char c : path) {
    if (c == '\n') {
      text += "\\n";
    } else if (c == '\\') {
      text += "\\\\";
    } else {
      text += c;
    }
  }
  return text;
}

std::string unescaped(const std::string& text) {
  std::string path;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      ++i;
      path += text[i] == 'n' ? '\n' : text[i];
    } else {
      path += text[i];
    }
  }
  return path;
}

std::string digest_line(const SceneFile& file) {
  return fmt::format("{} {} {}\n", file.digest, file.key, escaped(file.path));
}

/// The lines of scene_digests(), that of the text first.
std::vector<SceneFile> read_digests(const std::string& digests) {
  std::vector<SceneFile> files;
  std::istringstream lines(digests);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    SceneFile file;
    words >> file.digest >> file.key;
    words.get();
    std::getline(words, file.path);
    file.path = unescaped(file.path);
    files.push_back(std::move(file));
  }
  return files;
}

/// A resolved scene without the paths of the files that it names: what they hold counts, not where
/// they are.
std::string without_paths(std::string resolved, const std::vector<SceneFile>& files) {
  for (const SceneFile& file : files) {
    if (file.path.empty()) continue;
    const std::string quoted = '"' + file.path + '"';
    for (std::size_t at = resolved.find(quoted); at != std::string::npos;
         at = resolved.find(quoted, at))
      resolved.replace(at, quoted.size(), "\"\"");
  }
  return resolved;
}

/// Of a text and the contents of files. Of a resolved scene with its paths it is what the hash of
/// scenes was before these were left out.
std::string hash_of(const std::string& resolved, const std::vector<SceneFile>& files) {
  std::uint64_t sum = fnv1a(resolved);
  for (const SceneFile& file : files) sum = fnv1a(digest_line({file.key, "", file.digest}), sum);
  return digits(sum);
}

}  // namespace

std::vector<SceneFile> scene_files(const LoadedScene& loaded) {
  std::vector<SceneFile> files;
  const ModelParameters& model = loaded.scene.model;
  for (const auto& [body, parameters] : model.substructures) {
    const std::unique_ptr<BodyParameters> named = parameters->clone();
    for (const NamedFile& file : named->files())
      add_file(files, loaded.tree, "substructures." + body + "." + file.key, *file.name);
  }
  for (const auto& [name, pair] : model.pairs()) {
    const std::string key = model.contact ? name : "contacts." + name;
    if (pair.normal.has_table())
      add_file(files, loaded.tree, key + ".normal.form", pair.normal.form);
  }
  const InitialParameters& initial = model.initial;
  if (initial.is_file()) add_file(files, loaded.tree, initial_state_key, initial.state);
  return files;
}

std::string scene_hash(const std::string& resolved, const std::vector<SceneFile>& files) {
  return hash_of(without_paths(resolved, files), files);
}

std::string scene_digests(const std::string& text, const std::vector<SceneFile>& files) {
  std::string lines = digest_line({text_key, "", digits(fnv1a(text))});
  for (const SceneFile& file : files) lines += digest_line(file);
  return lines;
}

void check_unchanged(const KeptScene& scene, const std::string& run_file) {
  std::vector<SceneFile> files = read_digests(scene.digests);
  const bool has_text = !files.empty() && files.front().key == text_key;
  if (!has_text || files.front().digest != digits(fnv1a(scene.text))) {
    throw FileError(Refusal::file_damaged, run_file, "/scene/text",
                    "is not the scene with which the run began: the text or its digest "
                    "(/scene/digests) has been changed or damaged since; run the scene anew");
  }
  files.erase(files.begin());
  if (scene_hash(scene.resolved, files) != scene.hash &&
      hash_of(scene.resolved, files) != scene.hash) {
    throw FileError(Refusal::file_damaged, run_file, "/scene/resolved",
                    "is not the scene with which the run began: it, the digests of the files that "
                    "it names (/scene/digests) or the attribute scene_hash has been changed or "
                    "damaged since; run the scene anew");
  }
  std::string changed;
  for (const SceneFile& file : files) {
    std::error_code ignored;
    if (!std::filesystem::exists(file.path, ignored) || digest_of_file(file.path) == file.digest)
      continue;
    changed += fmt::format("{}{} ({})", changed.empty() ? "" : ", ", file.path, file.key);
  }
  if (changed.empty()) return;
  throw FileError(
      Refusal::other_kind_of_file, run_file, "",
      fmt::format("files that its scene names have changed since the run began: {}; put "
                  "the former ones back, or run the scene anew",
                  changed));
}

}  // namespace stridor
