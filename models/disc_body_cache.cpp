#include "models/disc_body_cache.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "models/keys_text.hpp"

namespace stridor {
namespace {

constexpr std::size_t capacity = 8;

/// The body of a key, moved to the end, made where there is none.
template <class Entry, class Make>
const auto& keep(std::vector<Entry>& entries, const std::string& key, Make&& make) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const Entry& entry) { return entry.key == key; });
  if (found != entries.end()) {
    std::rotate(found, found + 1, entries.end());
  } else {
    Entry made{key, make()};
    if (entries.size() == capacity) entries.erase(entries.begin());
    entries.push_back(std::move(made));
  }
  return entries.back().body;
}

}  // namespace

const AnnularPlate& DiscBodyCache::plate(const AnnularPlateParameters& parameters,
                                         double prestress_speed) {
  const std::string key = fmt::format(
      "{}{}", keys_text(AnnularPlateParameters::schema(), &parameters), prestress_speed);
  return keep(plates_, key, [&] { return AnnularPlate(parameters, prestress_speed); });
}

const PadBody& DiscBodyCache::pad(const PadsParameters& parameters,
                                  const std::vector<double>& offsets) {
  const std::string springs = keys_text(PadStiffness::schema(), &parameters.stiffness);
  const std::string body =
      parameters.elastic
          ? keys_text(ElasticPadParameters::schema(), &*parameters.elastic)
          : fmt::format("{}", *parameters.mass);
  return keep(pads_, fmt::format("{}{}{}", springs, body, fmt::join(offsets, ",")), [&] {
    ++num_pads_;
    return parameters.elastic
               ? make_elastic_pad(*parameters.elastic, parameters.stiffness, offsets)
               : make_rigid_pad(*parameters.mass, parameters.stiffness, offsets.size());
  });
}

}  // namespace stridor
