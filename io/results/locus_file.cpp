#include "io/results/locus_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/errors.hpp"
#include "io/hdf5/damage_guard.hpp"
#include "io/hdf5/hdf5_input.hpp"
#include "io/hdf5/hdf5_output.hpp"

namespace stridor {
namespace {

/// A column of /unstable: its name, unit and the member it holds.
struct WindowColumn {
  const char* name;
  const char* units;  ///< null: that of the parameter; per_second: that by a second
  double& (*of)(TimedWindow&);
};

constexpr const char* per_second = "/s";

const std::array<WindowColumn, 9> columns{{
    {"from", nullptr, [](TimedWindow& w) -> double& { return w.window.from; }},
    {"to", nullptr, [](TimedWindow& w) -> double& { return w.window.to; }},
    {"frequency", "Hz", [](TimedWindow& w) -> double& { return w.window.frequency; }},
    {"growth_max", "1/s", [](TimedWindow& w) -> double& { return w.window.growth_max; }},
    {"growth_integral", per_second,
     [](TimedWindow& w) -> double& { return w.window.growth_integral; }},
    {"value_max", nullptr, [](TimedWindow& w) -> double& { return w.window.value_max; }},
    {"from_time", "s", [](TimedWindow& w) -> double& { return w.from_time; }},
    {"to_time", "s", [](TimedWindow& w) -> double& { return w.to_time; }},
    {"gain", "1", [](TimedWindow& w) -> double& { return w.gain; }},
}};

/// The unit of a column of windows.
std::string units_of(const WindowColumn& column, const std::string& parameter) {
  if (column.units == nullptr) return parameter;
  if (column.units != per_second) return column.units;
  return parameter + "/s";
}

void write_eigenvalues(const Hdf5Writer& writer, const Locus& locus, const Handle& values) {
  std::size_t most = 0;
  for (const auto& list : locus.eigenvalues) most = std::max(most, list.size());
  std::vector<double> growth;
  std::vector<double> frequency;
  for (const auto& list : locus.eigenvalues) {
    for (std::size_t i = 0; i < most; ++i) {
      constexpr double none = std::numeric_limits<double>::quiet_NaN();
      growth.push_back(i < list.size() ? list[i].real() : none);
      frequency.push_back(i < list.size() ? list[i].imag() / (2.0 * std::numbers::pi) : none);
    }
  }
  const Handle number = writer.write_numbers("/eigenvalues/number", most);
  for (const auto& [path, numbers, units] :
       {std::tuple{"/eigenvalues/growth", &growth, "1/s"},
        std::tuple{"/eigenvalues/frequency", &frequency, "Hz"}}) {
    const Handle written =
        writer.write(path, {locus.eigenvalues.size(), most}, numbers->data(), units);
    writer.tie(written, path, values, 0);
    writer.tie(written, path, number, 1);  // netCDF wants all extents named, or none
  }
}

/// Lists of one quantity, as a dataset of a group.
struct QuantityLists {
  const char* name;
  std::string units;
  std::vector<std::vector<double>> lists{};
};

/// Writes lists of unlike length as rectangles, a row for each list, NaN behind its end: so all of
/// them are read at once.
/// @param quantities as many lists each, of the same lengths
void write_lists(const Hdf5Writer& writer, const std::string& group,
                 const std::vector<QuantityLists>& quantities) {
  const std::size_t num_lists = quantities.front().lists.size();
  std::size_t longest = 0;
  for (const auto& list : quantities.front().lists) longest = std::max(longest, list.size());
  const Handle number = writer.write_numbers(group + "/number", num_lists);
  const Handle point = writer.write_numbers(group + "/point", longest);
  for (const QuantityLists& quantity : quantities) {
    std::vector<double> rectangle;
    rectangle.reserve(num_lists * longest);
    for (const auto& list : quantity.lists) {
      rectangle.insert(rectangle.end(), list.begin(), list.end());
      rectangle.resize(rectangle.size() + longest - list.size(),
                       std::numeric_limits<double>::quiet_NaN());
    }
    const std::string path = group + "/" + quantity.name;
    const Handle written =
        writer.write(path, {num_lists, longest}, rectangle.data(), quantity.units);
    writer.tie(written, path, number, 0);
    writer.tie(written, path, point, 1);
  }
}

void write_branches(const Hdf5Writer& writer, const Locus& locus, const std::string& units) {
  QuantityLists value{"value", units};
  QuantityLists growth{"growth", "1/s"};
  QuantityLists frequency{"frequency", "Hz"};
  for (const Branch& branch : locus.branches) {
    value.lists.push_back(branch.values);
    growth.lists.emplace_back();
    frequency.lists.emplace_back();
    for (const std::complex<double>& s : branch.s) {
      growth.lists.back().push_back(s.real());
      frequency.lists.back().push_back(s.imag() / (2.0 * std::numbers::pi));
    }
  }
  write_lists(writer, "/branches", {std::move(value), std::move(growth), std::move(frequency)});
}

void write_boundary(const Hdf5Writer& writer, const std::vector<BoundaryLine>& boundary,
                    const std::string& x_units, const std::string& y_units) {
  QuantityLists x{"x", x_units};
  QuantityLists y{"y", y_units};
  for (const BoundaryLine& line : boundary) {
    x.lists.emplace_back();
    y.lists.emplace_back();
    for (const auto& point : line) {
      x.lists.back().push_back(point[0]);
      y.lists.back().push_back(point[1]);
    }
  }
  write_lists(writer, "/boundary", {std::move(x), std::move(y)});
}

/// Numbers of reasons at the points of a map, and the reasons.
void write_failures(const Hdf5Writer& writer, const StabilityMap& map, const Handle& x,
                    const Handle& y) {
  if (map.reasons.empty()) return;
  std::vector<double> numbers;
  for (const auto& row : map.failure) numbers.insert(numbers.end(), row.begin(), row.end());
  const Handle field = writer.write("/failure", {map.y.size(), map.x.size()}, numbers.data(), "1");
  writer.tie(field, "/failure", y, 0);
  writer.tie(field, "/failure", x, 1);
  const Handle number = writer.write_numbers("/failures/number", map.reasons.size());
  writer.tie(writer.write_texts("/failures/reason", map.reasons), "/failures/reason", number, 0);
}

/// The attributes of a file of a kind.
Attributes of_kind(const char* kind, const Attributes& attributes) {
  Attributes all{{"kind", std::string(kind)}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  return all;
}

}  // namespace

void write_locus_file(const std::string& path, Overwrite overwrite, const Locus& locus,
                      const std::vector<TimedWindow>& windows, const std::string& units,
                      const Attributes& attributes) {
  write_hdf5_file(path, overwrite, of_kind("locus", attributes), [&](const Hdf5Writer& writer) {
    const Handle values = writer.write("/values", locus.values, units);
    writer.make_scale(values, "/values");
    write_eigenvalues(writer, locus, values);
    write_branches(writer, locus, units);
    const Handle number = writer.write_numbers("/unstable/number", windows.size());
    for (const WindowColumn& column : columns) {
      std::vector<double> numbers;
      for (TimedWindow window : windows) numbers.push_back(column.of(window));
      const std::string dataset = std::string("/unstable/") + column.name;
      writer.tie(writer.write(dataset, numbers, units_of(column, units)), dataset, number, 0);
    }
    writer.make_default_plot("/eigenvalues/growth", {"/values", "/eigenvalues/number"});
  });
}

void write_map_file(const std::string& path, Overwrite overwrite, const StabilityMap& map,
                    const std::string& x_units, const std::string& y_units,
                    const Attributes& attributes) {
  write_hdf5_file(path, overwrite, of_kind("stability map", attributes),
                  [&](const Hdf5Writer& writer) {
                    const Handle x = writer.write("/x", map.x, x_units);
                    const Handle y = writer.write("/y", map.y, y_units);
                    writer.make_scale(x, "/x");
                    writer.make_scale(y, "/y");
                    std::vector<double> growth;
                    for (const auto& row : map.growth)
                      growth.insert(growth.end(), row.begin(), row.end());
                    const Handle field =
                        writer.write("/growth", {map.y.size(), map.x.size()}, growth.data(), "1/s");
                    writer.tie(field, "/growth", y, 0);
                    writer.tie(field, "/growth", x, 1);
                    writer.make_default_plot("/growth", {"/y", "/x"});
                    write_boundary(writer, map.boundary, x_units, y_units);
                    write_failures(writer, map, x, y);
                  });
}

std::vector<TimedWindow> read_locus_windows(const std::string& path) {
  const DamageGuard guard(path);
  const QuietErrors quiet;
  const Checker at(path);
  const Handle file = open_hdf5_file(at);
  if (H5Lexists(file.id(), "/unstable", H5P_DEFAULT) <= 0)
    throw FileError(Refusal::file_damaged, path, "/unstable",
                    "is missing; a file of `stridor locus -o` is needed");
  // A window takes the memory of all its columns: these are there before it is taken.
  std::vector<std::vector<double>> values;
  for (const WindowColumn& column : columns) {
    const std::string dataset = std::string("/unstable/") + column.name;
    values.push_back(read_array(at, open_array(at, file.id(), dataset, 1), dataset));
    if (values.back().size() != values.front().size()) {
      throw FileError(Refusal::file_damaged, path, dataset,
                      fmt::format("has {} entries, /unstable/from {}", values.back().size(),
                                  values.front().size()));
    }
  }
  std::vector<TimedWindow> windows(values.front().size());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    for (std::size_t k = 0; k < values.size(); ++k) columns[k].of(windows[i]) = values[k][i];
  }
  return windows;
}

std::string read_locus_parameter(const std::string& path) {
  constexpr const char* name = "parameter";
  const DamageGuard guard(path);
  const QuietErrors quiet;
  const Checker at(path);
  const Handle file = open_hdf5_file(at);
  if (H5Aexists(file.id(), name) <= 0) return "";
  const Handle attribute =
      at.own(H5Aopen(file.id(), name, H5P_DEFAULT), H5Aclose, "/", "cannot read an attribute");
  const Handle type =
      at.own(H5Aget_type(attribute.id()), H5Tclose, "/", "cannot read an attribute");
  const Handle space =
      at.own(H5Aget_space(attribute.id()), H5Sclose, "/", "cannot read an attribute");
  if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1)
    return "";
  return read_text(at, file.id(), type.id(), "/", [&](hid_t memory, void* target) {
    return H5Aread(attribute.id(), memory, target);
  });
}

}  // namespace stridor
