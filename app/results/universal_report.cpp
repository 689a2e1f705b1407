#include "app/results/universal_report.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>

namespace stridor {
namespace {

/// Modes or functions that are printed; all are in the JSON.
constexpr std::size_t most_shown = 20;

std::string quantity_words(int quantity) {
  switch (static_cast<UffQuantity>(quantity)) {
    case UffQuantity::displacement:
      return "displacement";
    case UffQuantity::velocity:
      return "velocity";
    case UffQuantity::acceleration:
      return "acceleration";
    case UffQuantity::reaction_force:
    case UffQuantity::excitation_force:
      return "force";
    case UffQuantity::time:
      return "time";
    case UffQuantity::frequency:
      return "frequency";
    case UffQuantity::general:
      return "unknown";
  }
  return fmt::format("quantity {}", quantity);
}

std::string type_words(int type) {
  switch (type) {
    case 0:
      return "general";
    case 1:
      return "time response";
    case 2:
      return "auto spectrum";
    case 3:
      return "cross spectrum";
    case 4:
      return "frequency response";
    case 6:
      return "coherence";
    case 9:
      return "power spectral density";
    case 12:
      return "spectrum";
    default:
      return fmt::format("function of type {}", type);
  }
}

/// "12 -y"; rotations about x, y, z are 4 to 6.
std::string dof_words(const UffDof& dof) {
  const int along = std::abs(dof.direction);
  if (along < 1 || along > 6) return fmt::format("{}", dof.node);
  return fmt::format("{} {}{}{}", dof.node, along > 3 ? "about " : "", dof.direction < 0 ? "-" : "",
                     "xyz"[(along - 1) % 3]);
}

Json dof_json(const UffDof& dof) {
  return {{"node", dof.node}, {"direction", dof.direction}};
}

Json function_json(const UffFunction& function) {
  Json object = {{"id", function.id},
                 {"note", function.note},
                 {"units", function.units},
                 {"type", type_words(function.type)},
                 {"response", dof_json(function.response)},
                 {"reference", dof_json(function.reference)},
                 {"quantity", quantity_words(function.ordinate_quantity)},
                 {"per", quantity_words(function.denominator_quantity)},
                 {"over", quantity_words(function.abscissa_quantity)},
                 {"complex", function.is_complex},
                 {"values", function.values.size()},
                 {"missing", function.num_missing}};
  if (!function.abscissa.empty())
    object.update(
        {{"from", number(function.abscissa.front())}, {"to", number(function.abscissa.back())}});
  return object;
}

/// The corners of the box around all nodes.
std::pair<Eigen::Vector3d, Eigen::Vector3d> box_of(const ModalTest& test) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Eigen::Vector3d lowest = Eigen::Vector3d::Constant(far);
  Eigen::Vector3d highest = Eigen::Vector3d::Constant(-far);
  for (const auto& [label, place] : test.nodes) {
    lowest = lowest.cwiseMin(place);
    highest = highest.cwiseMax(place);
  }
  return {lowest, highest};
}

void print_line(const std::string& name, const std::string& value) {
  fmt::print("{:<26} {}\n", name, value);
}

void print_modes(const std::vector<TestMode>& modes) {
  if (modes.empty()) return;
  print_line("modes", fmt::format("{}", modes.size()));
  for (std::size_t i = 0; i < std::min(most_shown, modes.size()); ++i) {
    const TestMode& mode = modes[i];
    print_line(
        fmt::format("  mode {}", mode.number),
        fmt::format("{:.6g} Hz, damping ratio {:.3g}, {}, at {} nodes", mode.frequency,
                    mode.damping_ratio, mode.is_complex ? "complex" : "real", mode.shape.size()));
  }
  if (modes.size() > most_shown)
    print_line("  ...", fmt::format("{} more", modes.size() - most_shown));
}

void print_functions(const std::vector<UffFunction>& functions) {
  if (functions.empty()) return;
  print_line("functions", fmt::format("{}", functions.size()));
  for (std::size_t i = 0; i < std::min(most_shown, functions.size()); ++i) {
    const UffFunction& one = functions[i];
    const bool is_ratio = one.denominator_quantity != 0 || one.reference.node != 0;
    std::string text = fmt::format(
        "{}, {}{}, {} {} values", type_words(one.type), quantity_words(one.ordinate_quantity),
        is_ratio ? " per " + quantity_words(one.denominator_quantity) : "", one.values.size(),
        one.is_complex ? "complex" : "real");
    if (!one.abscissa.empty())
      text += fmt::format(" at a {} of {:g} to {:g}", quantity_words(one.abscissa_quantity),
                          one.abscissa.front(), one.abscissa.back());
    const std::string response = one.response.node == 0 && !one.id.empty() && one.id != "NONE"
                                     ? one.id
                                     : dof_words(one.response);
    print_line("  " + response + (is_ratio ? " per " + dof_words(one.reference) : ""), text);
  }
  if (functions.size() > most_shown)
    print_line("  ...", fmt::format("{} more", functions.size() - most_shown));
}

void print_use(const UffHoldings& held, const std::string& file) {
  if (!held.shapes.modes.empty()) {
    fmt::print(
        "\nIn a scene:\n\nsubstructures:\n  part:\n    type: modes\n    file: {}\n    ports:\n"
        "      tip: {{node: {}}}\n\nBeside the modes of a scene: stridor eig SCENE.yaml --compare "
        "{}\n",
        file, held.shapes.nodes.empty() ? 1 : held.shapes.nodes.begin()->first, file);
  }
  const auto response = std::ranges::find(
      held.functions, static_cast<int>(UffFunctionType::frequency_response), &UffFunction::type);
  if (response == held.functions.end()) return;
  fmt::print(
      "\nBeside the responses of a scene: stridor frf SCENE.yaml --input BODY.POINT.AXIS --from "
      "... "
      "--to ... --compare {} --node {}=BODY.POINT\n",
      file, response->response.node);
}

}  // namespace

Json universal_json(const UffHoldings& held) {
  Json object = {{"format", "universal file"},
                 {"datasets", Json::array()},
                 {"units", nullptr},
                 {"nodes", held.shapes.nodes.size()},
                 {"lines", held.shapes.lines.size()},
                 {"elements", held.shapes.elements.size()},
                 {"modes", Json::array()},
                 {"functions", Json::array()},
                 {"remarks", held.remarks}};
  for (const auto& [type, count] : held.datasets)
    object["datasets"].push_back(
        {{"number", type}, {"count", count}, {"holds", dataset_words(type)}});
  if (held.units.is_given) {
    object["units"] = {{"name", held.units.name},
                       {"length", number(1.0 / held.units.length)},
                       {"force", number(1.0 / held.units.force)}};
  }
  for (const TestMode& mode : held.shapes.modes) {
    object["modes"].push_back({{"number", mode.number},
                               {"frequency", number(mode.frequency)},
                               {"damping_ratio", number(mode.damping_ratio)},
                               {"complex", mode.is_complex},
                               {"nodes", mode.shape.size()}});
  }
  for (const UffFunction& function : held.functions)
    object["functions"].push_back(function_json(function));
  return object;
}

void print_universal(const UffHoldings& held, const std::string& file) {
  print_line("format", "universal file");
  for (const auto& [type, count] : held.datasets)
    print_line(fmt::format("  dataset {}", type),
               fmt::format("{} of {}", count, dataset_words(type)));
  if (held.units.is_given) {
    print_line("units", fmt::format("{}: lengths of {:.6g} m, forces of {:.6g} N",
                                    held.units.name.empty() ? "no name" : held.units.name,
                                    1.0 / held.units.length, 1.0 / held.units.force));
  }
  if (!held.shapes.nodes.empty()) {
    const auto [lowest, highest] = box_of(held.shapes);
    print_line("nodes",
               fmt::format("{}, from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) m",
                           held.shapes.nodes.size(), lowest.x(), lowest.y(), lowest.z(),
                           highest.x(), highest.y(), highest.z()));
  }
  if (!held.shapes.lines.empty()) print_line("lines", fmt::format("{}", held.shapes.lines.size()));
  if (!held.shapes.elements.empty())
    print_line("elements", fmt::format("{}", held.shapes.elements.size()));
  print_modes(held.shapes.modes);
  print_functions(held.functions);
  for (const std::string& remark : held.remarks) fmt::print("{}\n", remark);
  print_use(held, file);
}

}  // namespace stridor
