#include "app/stability/locus_progress.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/activity.hpp"

namespace stridor {

LocusProgress::LocusProgress(const std::string& verb, StabilityFamily& family,
                             const KeyRange& range)
    : progress_(verb), family_(family), range_(range), reached_(range.values.front()) {
  family_.on_value([this](double value) { look_at(value); });
}

LocusProgress::~LocusProgress() {
  family_.on_value(nullptr);
}

void LocusProgress::look_at(double value) {
  const double first = range_.values.front();
  const double last = range_.values.back();
  const std::string place = value_text(range_.key, value);
  if (reached_ < last) {
    reached_ = std::max(reached_, value);
    progress_.report((reached_ - first) / (last - first), place);
    return;
  }
  if (num_refined_++ == 0) progress_.begin("refining windows");
  const CurrentActivity part = current_activity();
  if (part.what.empty()) {
    progress_.report(fmt::format("{} values, {}", num_refined_, place));
  } else if (part.fraction > 0.0) {
    progress_.report(part.fraction, fmt::format("{}, {}", part.what, place));
  } else {
    progress_.report(fmt::format("{}, {}", part.what, place));
  }
}

}  // namespace stridor
