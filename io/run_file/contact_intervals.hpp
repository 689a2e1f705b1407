// What contacts do between two rows of a run file, so that what is shorter than an interval is
// kept.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "core/state.hpp"
#include "io/run_file/run_file.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {

/// One of the series in which a quantity of a contact is recorded.
struct ContactSeries {
  SeriesSpec spec;
  bool is_low_passed = false;
  double (*of_interval)(const ContactStatistics&) = nullptr;  ///< null: of the row
};

/// The series of a quantity, `/contact/<contact>/<quantity>` first. Forces and states are those of
/// the step at the time of the row; beside a normal force stand its extremes over the interval and
/// its low-passed series, beside a state the shares of the interval. Other quantities are
/// low-passed.
/// @param quantity "force", "friction_force", "state" or another
/// @param low_pass DecimationFilter::description()
std::vector<ContactSeries> contact_columns(const std::string& contact, const std::string& quantity,
                                           const std::string& units, const std::string& low_pass);

/// Gathers what the contacts do into the intervals that end with a row, and keeps those whose rows
/// wait for the filters of other columns.
///
/// The interval of row k holds all steps after that of row k − 1 up to that of row k; that of the
/// first row holds the first step alone. So every step is in one interval.
class ContactIntervals {
 public:
  /// @param num_contacts whose statistics come in
  /// @param ratio        looks from row to row, at least 1
  ContactIntervals(std::size_t num_contacts, int ratio) : ratio_(ratio), open_(num_contacts) {}

  /// Takes the steps since the last look, of all contacts; the first look is that of row 0.
  void add(const std::vector<ContactStatistics>& since_last_look);
  /// The oldest interval that has not been dropped. At least one row's look has been added since.
  const std::vector<ContactStatistics>& oldest() const { return closed_.front(); }
  void drop_oldest() { closed_.pop_front(); }

  void save(State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if the state is of another number of contacts
  void load(const State& state, const std::string& prefix);

 private:
  int ratio_;
  int looks_until_row_ = 1;
  std::vector<ContactStatistics> open_;
  std::deque<std::vector<ContactStatistics>> closed_;
};

}  // namespace stridor
