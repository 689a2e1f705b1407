#include "io/run_file/contact_intervals.hpp"

#include <fmt/format.h>

#include <span>
#include <stdexcept>
#include <tuple>

namespace stridor {
namespace {

constexpr std::size_t numbers_per_contact = std::tuple_size_v<ContactStatistics::Numbers>;
constexpr const char* unfiltered = "none";

double share(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

void append(std::vector<double>& numbers, const std::vector<ContactStatistics>& interval) {
  for (const ContactStatistics& one : interval) {
    const ContactStatistics::Numbers own = one.numbers();
    numbers.insert(numbers.end(), own.begin(), own.end());
  }
}

std::vector<ContactStatistics> take(const double* numbers, std::size_t num_contacts) {
  std::vector<ContactStatistics> interval;
  for (std::size_t i = 0; i < num_contacts; ++i, numbers += numbers_per_contact)
    interval.push_back(ContactStatistics::of(
        std::span<const double, numbers_per_contact>(numbers, numbers_per_contact)));
  return interval;
}

}  // namespace

std::vector<ContactSeries> contact_columns(const std::string& contact, const std::string& quantity,
                                           const std::string& units, const std::string& low_pass) {
  std::vector<ContactSeries> columns;
  const auto add = [&](const std::string& name, const std::string& of, const std::string& long_name,
                       const std::string& filter) -> ContactSeries& {
    columns.push_back(
        {{fmt::format("/contact/{}/{}", contact, name), of, SeriesKind::real, {{"filter", filter}}},
         filter != unfiltered});
    if (!long_name.empty()) columns.back().spec.attributes.emplace_back("long_name", long_name);
    return columns.back();
  };
  const bool is_force = quantity == "force" || quantity == "friction_force";
  const bool is_state = quantity == "state";
  if (!is_force && !is_state) {
    add(quantity, units, "", low_pass).is_low_passed = true;
    return columns;
  }
  const std::string words = quantity == "force" ? "contact force" : "friction force";
  SeriesSpec& own =
      add(quantity, units, is_force ? words + " at the time of the row" : "", unfiltered).spec;
  own.attributes.emplace_back("acts_at", "the time of the same row of /time");
  if (is_state) {
    own.kind = SeriesKind::state;
    own.attributes.emplace_back("meaning", "0 open, 1 stick, 2 slip");
    add("stick_fraction", "1", "share of the steps since the row before that ended in stick",
        unfiltered)
        .of_interval = [](const ContactStatistics& one) { return share(one.sticking, one.steps); };
    add("open_fraction", "1", "share of the steps since the row before without contact", unfiltered)
        .of_interval = [](const ContactStatistics& one) { return share(one.open, one.steps); };
    return columns;
  }
  const bool is_normal = quantity == "force";
  const auto add_extreme = [&](const char* suffix, const char* which,
                               double (*of_interval)(const ContactStatistics&)) {
    add(quantity + suffix, units,
        fmt::format("{} {} of all steps since the row before", which, words), unfiltered)
        .of_interval = of_interval;
  };
  using Statistics = const ContactStatistics&;
  add_extreme(
      "_min", "least",
      is_normal ? [](Statistics one) { return one.force_min; }
                : [](Statistics one) { return one.friction_min; });
  add_extreme(
      "_max", "largest",
      is_normal ? [](Statistics one) { return one.force_max; }
                : [](Statistics one) { return one.friction_max; });
  add(quantity + "_low_passed", units, words + ", low-passed before it is thinned: for spectra",
      low_pass)
      .is_low_passed = true;
  return columns;
}

void ContactIntervals::add(const std::vector<ContactStatistics>& since_last_look) {
  for (std::size_t i = 0; i < open_.size(); ++i) open_[i].add(since_last_look[i]);
  if (--looks_until_row_ > 0) return;
  looks_until_row_ = ratio_;
  closed_.push_back(open_);
  open_.assign(open_.size(), {});
}

void ContactIntervals::save(State& state, const std::string& prefix) const {
  std::vector<double> numbers;
  append(numbers, open_);
  for (const std::vector<ContactStatistics>& interval : closed_) append(numbers, interval);
  state.put(prefix + "intervals", numbers);
  state.put(prefix + "looks_until_row", static_cast<double>(looks_until_row_));
}

void ContactIntervals::load(const State& state, const std::string& prefix) {
  const std::vector<double>& numbers = state.array(prefix + "intervals");
  const double looks = state.get(prefix + "looks_until_row");
  const std::size_t per_interval = numbers_per_contact * open_.size();
  const bool fits =
      per_interval == 0 ? numbers.empty() : !numbers.empty() && numbers.size() % per_interval == 0;
  if (!fits || !(looks >= 1.0 && looks <= ratio_)) {
    throw std::invalid_argument(
        fmt::format("ContactIntervals: state '{}' is of other contacts", prefix));
  }
  looks_until_row_ = static_cast<int>(looks);
  closed_.clear();
  if (per_interval == 0) return;
  open_ = take(numbers.data(), open_.size());
  for (std::size_t from = per_interval; from < numbers.size(); from += per_interval)
    closed_.push_back(take(numbers.data() + from, open_.size()));
}

}  // namespace stridor
