#include "io/imports/uff_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "io/imports/uff_elements.hpp"
#include "io/imports/uff_lines.hpp"
#include "io/imports/uff_units.hpp"

namespace stridor {
namespace {

void add_node(ModalTest& test, std::int64_t label, const Eigen::Vector3d& at, const TextPlace& place) {
  const auto [node, is_new] = test.nodes.emplace(label, at);
  if (!is_new && (node->second - at).norm() > 1e-9 * (1.0 + at.norm()))
    refuse_at(place, fmt::format("node {} is given a second time, elsewhere", label));
}

void read_nodes(const UffDataset& dataset, const UffUnits& units, ModalTest& test) {
  UffReader reader(dataset);
  while (!reader.is_at_end()) {
    if (dataset.type == 15) {
      const UffLine& line = reader.line("a node");
      if (trimmed(line.text).empty()) continue;
      std::vector<double> numbers;
      if (const auto parted = uff_numbers_in(line.text, 13); parted && parted->size() == 7) {
        numbers = *parted;
      } else {
        // 4I10, 3E13.5.
        const std::size_t head = std::min<std::size_t>(40, line.text.size());
        numbers = uff_numbers({line.text.substr(0, head), line.place}, 10,
                              "a node: four integers and three coordinates");
        const std::vector<double> at =
            uff_numbers({line.text.substr(head), line.place}, 13, "three coordinates of a node");
        numbers.insert(numbers.end(), at.begin(), at.end());
      }
      if (numbers.size() != 7)
        refuse_at(line.place, fmt::format("expected a node: four integers and three coordinates, got {} numbers",
                                          numbers.size()));
      if (!(std::abs(numbers[0]) < 9e15)) refuse_at(line.place, "expected the label of a node");
      add_node(test, static_cast<std::int64_t>(numbers[0]),
               Eigen::Vector3d(numbers[4], numbers[5], numbers[6]) / units.length, line.place);
      continue;
    }
    const UffLine& line = reader.line("a node");
    if (trimmed(line.text).empty()) continue;
    const std::vector<double> head = uff_numbers(line, 10, "label, systems and colour of a node");
    if (head.empty() || !(std::abs(head[0]) < 9e15))
      refuse_at(line.place, "expected the label of a node");
    const std::vector<double> at = reader.reals(3, 25, "three coordinates of a node");
    add_node(test, static_cast<std::int64_t>(head[0]),
             Eigen::Vector3d(at[0], at[1], at[2]) / units.length, line.place);
  }
}

constexpr int normal_mode = 2;
constexpr int complex_mode_of_first_order = 3;
constexpr int complex_mode_of_second_order = 7;

/// Frequency, damping and scale of a mode from its record 8.
void read_scale(const std::vector<double>& values, int analysis, const UffUnits& units,
                const TextPlace& place, TestMode& mode) {
  const auto value = [&](std::size_t i) { return i < values.size() ? values[i] : 0.0; };
  if (analysis == normal_mode) {
    mode.frequency = value(0);
    mode.modal_mass = value(1) / units.mass();
    mode.damping_ratio = value(2) != 0.0 ? value(2) : 0.5 * value(3);
    if (!(mode.frequency >= 0.0))
      refuse_at(place, fmt::format("expected a frequency of at least 0 Hz, got {:g}", mode.frequency));
    return;
  }
  const std::complex<double> s(value(0), value(1));
  const std::complex<double> a(value(2), value(3));
  const double omega = std::abs(s);
  if (!(omega > 0.0))
    refuse_at(place, "expected a complex eigenvalue, got 0");
  mode.frequency = omega / (2.0 * std::numbers::pi);
  mode.damping_ratio = -s.real() / omega;
  if (s.imag() != 0.0) mode.modal_mass = std::abs(a) / (2.0 * std::abs(s.imag())) / units.mass();
}

void read_shape(UffReader& reader, std::size_t num_values, bool is_complex, TestMode& mode) {
  const std::size_t count = is_complex ? 2 * num_values : num_values;
  while (!reader.is_at_end()) {
    const UffLine& line = reader.line("a node");
    if (trimmed(line.text).empty()) continue;
    const std::vector<double> label = uff_numbers(line, 10, "the label of a node");
    if (label.size() != 1 || label[0] != std::round(label[0]) || !(std::abs(label[0]) < 9e15)) {
      refuse_at(line.place, fmt::format("expected the label of a node alone in its line, got '{}'",
                                        shown(line.text)));
    }
    const std::vector<double> data = reader.reals(count, 13, "the values at a node");
    std::array<std::complex<double>, 3>& at =
        mode.shape[static_cast<std::int64_t>(label[0])];
    for (std::size_t i = 0; i < 3; ++i)
      at[i] = is_complex ? std::complex<double>(data[2 * i], data[2 * i + 1]) : data[i];
  }
}

/// A dataset 55; others than modes at nodes are passed over.
void read_mode(const UffDataset& dataset, const UffUnits& units, ModalTest& test) {
  UffReader reader(dataset);
  reader.skip(5, "five lines of text before the data at nodes");
  const TextPlace place = dataset.place;
  const std::vector<std::int64_t> kind =
      reader.integers(6, "model, analysis, data and number of values (record 6)");
  const auto analysis = static_cast<int>(kind[1]);
  if (analysis != normal_mode && analysis != complex_mode_of_first_order &&
      analysis != complex_mode_of_second_order)
    return;
  const bool has_vectors = (kind[2] == 2 && kind[5] == 3) || (kind[2] == 3 && kind[5] == 6);
  if (!has_vectors) {
    refuse_at(place, fmt::format("expected three translations at each node, with or without three rotations, "
                                 "got kind {} with {} values",
                                 kind[2], kind[5]));
  }
  if (kind[4] != 2 && kind[4] != 5)
    refuse_at(place, fmt::format("expected real (2) or complex (5) values, got {}", kind[4]));
  TestMode mode;
  mode.is_complex = kind[4] == 5;
  const std::vector<std::int64_t> counts =
      reader.integers(4, "numbers of integers and reals, case and mode (record 7)");
  if (counts[0] < 2 || counts[0] > 8 || counts[1] < 1 || counts[1] > 12)
    refuse_at(place, "expected numbers of integers and reals of a mode in record 7");
  mode.number = counts[3];
  const auto num_reals = static_cast<std::size_t>(counts[1]);
  read_scale(reader.reals(num_reals, 13, "frequency, modal mass and damping, or eigenvalue and modal a"),
             analysis, units, place, mode);
  constexpr std::int64_t displacement = 8;
  if (kind[3] != displacement && kind[3] != 0) {
    test.remarks.push_back(fmt::format(
        "mode {} is of kind {} of data, not displacement (8); its modal mass is taken to belong to it",
        mode.number, kind[3]));
  }
  read_shape(reader, static_cast<std::size_t>(kind[5]), mode.is_complex, mode);
  if (mode.shape.empty()) refuse_at(place, "expected values at nodes, got none");
  mode.source = place_text(place);
  test.modes.push_back(std::move(mode));
}

}  // namespace

ModalTest modal_test_in(const std::vector<UffDataset>& datasets) {
  const UffUnits units = units_in(datasets);
  ModalTest test;
  for (const UffDataset& dataset : datasets) {
    if (dataset.data) continue;  // functions
    if (dataset.type == 15 || dataset.type == 2411) read_nodes(dataset, units, test);
    if (dataset.type == 82) read_trace_lines(dataset, test);
    if (dataset.type == 2412) read_elements(dataset, test);
    if (dataset.type == 55) read_mode(dataset, units, test);
  }
  if (!units.is_given) test.remarks.emplace_back(no_units);
  return test;
}

ModalTest read_uff(const SourceText& source) {
  const std::vector<UffDataset> datasets = uff_datasets(source);
  ModalTest test = modal_test_in(datasets);
  if (!test.modes.empty()) return test;
  const auto num_functions =
      std::ranges::count(datasets, 58, [](const UffDataset& dataset) { return dataset.type; });
  refuse_at(
      {&source, 0},
      fmt::format(
          "expected mode shapes (dataset 55, analysis 2, 3 or 7); there are {} datasets and "
          "none of these{}",
          datasets.size(),
          num_functions > 0 ? fmt::format(", but {} with functions (58), which `stridor frf "
                                          "SCENE --compare FILE` sets beside those of a scene",
                                          num_functions)
                            : ""));
}

ModalTest read_uff_file(const std::string& path) {
  return read_uff(read_source_text(path, "a universal file (.uff, .unv)"));
}

}  // namespace stridor
