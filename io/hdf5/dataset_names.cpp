#include "io/hdf5/dataset_names.hpp"

#include <algorithm>
#include <vector>

namespace stridor {
namespace {

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    if (end > begin) parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string spaced(std::string words) {
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

/// "cantilever.free_end.y.acceleration"; a name of the body may hold dots of its own.
std::string channel_text(const std::string& channel) {
  std::vector<std::string> parts = parts_of(channel, '.');
  if (parts.size() < 2) return spaced(channel);
  const std::string quantity = spaced(parts.back());
  parts.pop_back();
  std::string along;
  if (parts.size() > 1 && (parts.back() == "x" || parts.back() == "y" || parts.back() == "z")) {
    along = " along " + parts.back();
    parts.pop_back();
  }
  std::string place;
  for (const std::string& part : parts) place += (place.empty() ? "" : ".") + part;
  return quantity + " of " + place + along;
}

}  // namespace

std::string long_name_of(const std::string& path) {
  const std::vector<std::string> parts = parts_of(path, '/');
  if (parts.empty()) return "";
  const std::string name = spaced(parts.back());
  if (parts.size() == 1) return name;
  const std::string& group = parts.front();
  if (group == "channels") return channel_text(parts.back());
  if (group == "contact") return name + " of the contact " + parts[1];
  if (group == "modal") return name + " of the modes of " + parts[1] + " by itself";
  if (group == "final") return name + (parts.size() > 2 ? " of " + parts[1] : "") + " at the end";
  if (group == "bursts") return name + (parts.size() > 2 ? " on the courses" : "") + " of bursts";
  if (group == "windows") return name + " of predicted unstable windows";
  if (group == "unstable") return name + " of unstable windows";
  if (group == "responses" && parts.size() == 4)
    return name + " part of " + parts[1] + " per force at " + parts[2];
  std::string rest;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) rest += (i > 0 ? " " : "") + spaced(parts[i]);
  return name + ", " + rest;
}

}  // namespace stridor
