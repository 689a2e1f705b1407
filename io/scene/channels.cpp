#include "io/scene/channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/suggestion.hpp"

namespace stridor {
namespace {

const std::vector<std::string> motions{"displacement", "velocity", "acceleration"};
const std::vector<std::string> quantities{"force",          "gap",   "slip_velocity", "position",
                                          "friction_force", "state", "area", "friction_across",
                                          "slip_across"};

constexpr EnergyEntry energy_entries[] = {
    {"kinetic", &EnergyBalance::kinetic,
     "kinetic energy of the motion relative to the drive, half a time step before the row"},
    {"strain", &EnergyBalance::strain, "strain energy, half a time step before the row"},
    {"damping_loss", &EnergyBalance::damping_loss,
     "taken out by the damping of the bodies since t = 0"},
    {"friction_loss", &EnergyBalance::friction_loss, "taken out by friction since t = 0"},
    {"contact_work", &EnergyBalance::contact_work,
     "work of the normal contact forces since t = 0, negative: taken out"},
    {"drive_work", &EnergyBalance::drive_work,
     "work of the drive since t = 0, without what moves the bodies rigidly"},
    {"load_work", &EnergyBalance::load_work, "work of the load since t = 0"},
    {"balance_error", &EnergyBalance::balance_error,
     "kinetic + strain - their initial value + damping_loss + friction_loss - contact_work - "
     "drive_work - load_work"}};

std::vector<std::string> split(const std::string& name) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t dot = name.find('.'); dot != std::string::npos; dot = name.find('.', from)) {
    parts.push_back(name.substr(from, dot - from));
    from = dot + 1;
  }
  parts.push_back(name.substr(from));
  return parts;
}

std::optional<std::size_t> index_in(const std::vector<std::string>& names,
                                    const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

std::string one_of(const std::string& what, const std::string& written,
                   const std::vector<std::string>& allowed) {
  return fmt::format("there is no {} '{}'{} (there are: {})", what, written,
                     did_you_mean(written, allowed), fmt::join(allowed, ", "));
}

/// @throws std::string with the error
Channel parse(const std::string& name, const ModelParameters& model) {
  Channel channel;
  channel.name = name;
  const std::vector<std::string> parts = split(name);
  if (parts.size() == 4) {
    std::vector<std::string> bodies;
    for (const auto& entry : model.substructures) bodies.push_back(entry.first);
    if (!index_in(bodies, parts[0])) throw one_of("substructure", parts[0], bodies);
    const auto direction = index_in({"x", "y", "z"}, parts[2]);
    if (!direction) throw fmt::format("'{}' is not a direction; take x, y or z", parts[2]);
    const auto motion = index_in(motions, parts[3]);
    if (!motion) throw one_of("motion", parts[3], motions);
    channel.point = PointName{parts[0], parts[1]};
    channel.direction = static_cast<int>(*direction);
    channel.derivative = static_cast<Derivative>(*motion);
    return channel;
  }
  if (parts.size() == 2) {
    std::vector<std::string> pairs;
    for (const auto& entry : model.pairs()) pairs.push_back(entry.first);
    if (!index_in(pairs, parts[0])) throw one_of("contact pair", parts[0], pairs);
    const auto quantity = index_in(quantities, parts[1]);
    if (!quantity) throw one_of("contact quantity", parts[1], quantities);
    channel.pair = parts[0];
    if (parts[1] == "area" && !model.pairs().at(parts[0]).normal.law->has_area()) {
      throw fmt::format(
          "the normal law of '{}' has no area; the law {} has", parts[0],
          normal_laws_with([](const NormalLawType& law) { return law.has_area(); }));
    }
    if (parts[1].ends_with("_across") && !has_two_tangents(model, model.pairs().at(parts[0])))
      throw fmt::format("'{}' slides along a curve and has one tangent only", parts[0]);
    channel.quantity = static_cast<ContactQuantity>(*quantity);
    return channel;
  }
  throw std::string(
      "is neither <body>.<point>.<x|y|z>.<displacement|velocity|acceleration> nor "
      "<contact>.<force|gap|slip_velocity|position|friction_force|state|area|friction_across|"
      "slip_across>");
}

}  // namespace

const std::string& name_of(ContactQuantity quantity) {
  return quantities[static_cast<std::size_t>(quantity)];
}

std::string Channel::units() const {
  if (point) {
    constexpr const char* units[] = {"m", "m/s", "m/s^2"};
    return units[static_cast<std::size_t>(derivative)];
  }
  if (energy != nullptr) return "J";
  constexpr const char* units[] = {"N", "m", "m/s", "m", "N", "1", "m^2", "N", "m/s"};
  return units[static_cast<std::size_t>(quantity)];
}

bool Channel::is_filtered() const {
  if (energy != nullptr) return false;
  return point || (quantity != ContactQuantity::state && quantity != ContactQuantity::force &&
                   quantity != ContactQuantity::friction_force);
}

Channel parse_channel(const std::string& name, const std::string& key,
                      const ModelParameters& model) {
  try {
    Channel channel = parse(name, model);
    channel.key = key;
    return channel;
  } catch (const std::string& wrong) {
    throw ConfigError(Refusal::unknown_name, key, fmt::format("channel '{}': {}", name, wrong));
  }
}

std::vector<Channel> parse_channels(const RecordParameters& record, const ModelParameters& model) {
  std::vector<Channel> channels;
  std::vector<Problem> problems;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    const std::string& name = record.channels[i];
    const std::string key = fmt::format("record.channels.{}", i);
    try {
      if (!seen.insert(name).second) throw std::string("is listed twice");
      channels.push_back(parse(name, model));
      channels.back().key = key;
    } catch (const std::string& wrong) {
      problems.push_back(
          {Refusal::unknown_name, key, fmt::format("channel '{}': {}", name, wrong)});
    }
  }
  if (!problems.empty()) throw ConfigError(std::move(problems));
  if (record.energy) {
    for (const EnergyEntry& entry : energy_entries) {
      Channel channel;
      channel.name = std::string("energy.") + entry.name;
      channel.key = "record.energy";
      channel.energy = &entry;
      channels.push_back(channel);
    }
  }
  return channels;
}

}  // namespace stridor
