// Columns of a file over one of them, as curves of a report.
#pragma once

#include <string>
#include <vector>

#include "app/report/report_section.hpp"

namespace stridor {

/// A quantity, a number for each value that another has.
struct CurveColumn {
  std::string name;
  std::string units;
  std::vector<double> values;  ///< those that are not finite are left out
};

/// Words in the place of numbers: what a state is called at each value.
struct WordColumn {
  std::string name;
  std::vector<std::string> texts;
};

/// A value at which nothing was found.
struct FailedValue {
  std::size_t index = 0;
  std::string reason;
};

/// Columns over values that were passed one after the other.
struct CurveSet {
  std::string name;  ///< where there are several: "up"
  std::vector<double> over;
  std::vector<CurveColumn> columns;
  std::vector<WordColumn> words;
  std::vector<FailedValue> failed;

  /// Takes a column out of the set. @return its values; none where there is no such column
  std::vector<double> take(const std::string& name);
};

/// All columns of a group as long as one of them, which the others are over.
/// @throws FileError if that one is missing
CurveSet curve_set(const ResultFile& file, const std::string& group, const std::string& over);

/// The sets in one picture: a panel for each quantity, with a curve of every set. The quantities
/// that are wanted first come first: amplitudes, then frequencies; counts of steps last.
/// @param name, units of what the columns are over
/// @param sets  at least one
Json curves_view(const std::string& name, const std::string& units,
                 const std::vector<CurveSet>& sets, ReportPage& page);

/// One column over another as a single panel.
Json curve_of_columns(const CurveColumn& over, const CurveColumn& column, ReportPage& page);

}  // namespace stridor
