// Eigenvalues along a parameter as HDF5 files, for programs that go on with the numbers.
//
//     /                       attributes: what was computed, of what and how
//     /values                 of the parameter
//     /eigenvalues/number     1, 2, …
//     /eigenvalues/growth     1/s, [value][eigenvalue], ascending frequency; NaN where fewer
//     /eigenvalues/frequency  Hz, likewise
//     /branches/              value, growth, frequency of every eigenvalue that was followed,
//                             [number][point]; NaN behind the end of a branch
//     /unstable/              one entry per window: from, to, frequency, growth_max,
//                             growth_integral, value_max, from_time, to_time, gain
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "analysis/locus.hpp"
#include "analysis/stability_map.hpp"
#include "io/hdf5/output_options.hpp"

namespace stridor {

/// An unstable window and when a run passes it. Times are NaN where no run does.
struct TimedWindow {
  UnstableWindow window;
  double from_time = 0.0;  ///< when the run comes into it, s
  double to_time = 0.0;    ///< when it leaves it, or ends, s
  double gain = 0.0;       ///< ∫ Re s dt from one to the other
};

/// Writes a locus to a file of its own; the file takes its name when it is whole.
///
/// @param path       final name; an existing file is replaced only with Overwrite::yes
/// @param units      of the parameter, "1" where dimensionless
/// @param attributes of the root
/// @throws FileError if the file exists ("exists; use --force to overwrite it"), its folder is not
///         writable, or anything cannot be written
void write_locus_file(const std::string& path, Overwrite overwrite, const Locus& locus,
                      const std::vector<TimedWindow>& windows, const std::string& units,
                      const Attributes& attributes);

/// The unstable windows of a file of write_locus_file().
/// @throws FileError if it cannot be read or is no such file
std::vector<TimedWindow> read_locus_windows(const std::string& path);

/// Over which key a locus was taken: attribute `parameter`; "" where the file does not say.
/// @throws FileError if the file cannot be read
std::string read_locus_parameter(const std::string& path);

/// Growth rates over two parameters, and where stability changes.
struct StabilityMap {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<std::vector<double>> growth;  ///< largest Re s, 1/s, a row per y; NaN: no equilibrium
  std::vector<BoundaryLine> boundary;
  /// The eigenvalues looked at are all up to this frequency, Hz.
  double highest_frequency = std::numeric_limits<double>::infinity();
  /// Why a point has no growth rate, a row per y: 0 where it has one, else the number, from 1, of
  /// one of `reasons`. Both are empty where nothing failed.
  std::vector<std::vector<std::size_t>> failure{};
  std::vector<std::string> reasons{};
};

/// Writes a map to a file of its own: /x, /y, /growth [y][x], /boundary/x and y [number][point],
/// NaN behind the end of a line; where points failed /failure [y][x] and /failures/reason.
/// Parameters and throws as write_locus_file().
void write_map_file(const std::string& path, Overwrite overwrite, const StabilityMap& map,
                    const std::string& x_units, const std::string& y_units,
                    const Attributes& attributes);

}  // namespace stridor
