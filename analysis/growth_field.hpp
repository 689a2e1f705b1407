// Stability over one or two parameters where the growth rate is cheap to compute.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analysis/stability_map.hpp"

namespace stridor {

/// Stability margin at one place: unstable where it is positive. NaN: undecided.
using StabilityMargin = std::function<double(double)>;

/// All sign changes of a margin between neighbours of a list of values.
///
/// Within an interval the change is found by regula falsi with bisection, to 1e-14 of the value.
/// Two in one interval are found where the values come close to zero, by the parabola through
/// three.
/// @param values ascending
std::vector<double> sign_changes(const StabilityMargin& margin, const std::vector<double>& values);

/// Growth rates and margins of a family of systems with one or two parameters. Not to be shared by
/// threads; a call may begin from what the last one found.
class GrowthField {
 public:
  virtual ~GrowthField() = default;
  /// Forgets what earlier calls have found.
  virtual void restart() = 0;
  /// The eigenvalue with the largest real part, and of two conjugate ones that with Im s >= 0; NaN
  /// where there is no equilibrium.
  /// @param y without meaning where there is one parameter
  virtual std::complex<double> leading(double x, double y) = 0;
  /// Positive where unstable; changes sign at the boundary.
  virtual double margin(double x, double y) = 0;
  /// Why the last call of leading() gave NaN.
  virtual std::string failure() const { return "no sliding equilibrium"; }
};

/// Why points of a line of a grid have no growth rate, by their indices.
using PointFailures = std::map<std::size_t, std::string>;

/// Growth over a grid, and the boundary of stability.
struct GrowthMap {
  std::vector<std::vector<double>> growth;  ///< Re s, a row per y
  std::vector<BoundaryLine> boundary;       ///< its points solved for on the lines of the grid
  std::vector<PointFailures> failures{};    ///< of each row
};

/// @param make_field makes the field of a thread; called by several threads
/// @param x, y       strictly ascending, at least two each
/// @param report     called with the share that is done, by one thread at a time; may be empty
/// @throws Interrupted where a stop was requested
GrowthMap make_growth_map(const std::function<std::unique_ptr<GrowthField>()>& make_field,
                          const std::vector<double>& x, const std::vector<double>& y,
                          int num_threads, const std::function<void(double)>& report = {});

}  // namespace stridor
