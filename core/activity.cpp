#include "core/activity.hpp"

#include <mutex>
#include <thread>
#include <vector>

namespace stridor {
namespace {

const std::thread::id main_thread = std::this_thread::get_id();

struct Activities {
  std::mutex changing;
  std::vector<CurrentActivity> open;
  std::uint64_t count = 0;
  void (*on_idle)() = nullptr;
};

Activities& activities() {
  static Activities all;
  return all;
}

}  // namespace

Activity::Activity(std::string what) : is_told_(std::this_thread::get_id() == main_thread) {
  if (!is_told_) return;
  Activities& all = activities();
  const std::lock_guard lock(all.changing);
  all.open.push_back({std::move(what), 0.0, ++all.count});
}

Activity::~Activity() {
  if (!is_told_) return;
  Activities& all = activities();
  void (*act)() = nullptr;
  {
    const std::lock_guard lock(all.changing);
    all.open.pop_back();
    // The enclosing activity is timed anew afterwards.
    if (!all.open.empty()) all.open.back().count = ++all.count;
    if (all.open.empty()) act = all.on_idle;
  }
  if (act != nullptr) act();
}

void Activity::report(double fraction) {
  if (!is_told_) return;
  Activities& all = activities();
  const std::lock_guard lock(all.changing);
  all.open.back().fraction = fraction;
}

void on_idle(void (*act)()) {
  Activities& all = activities();
  const std::lock_guard lock(all.changing);
  all.on_idle = act;
}

CurrentActivity current_activity() {
  Activities& all = activities();
  const std::lock_guard lock(all.changing);
  if (all.open.empty()) return {"", 0.0, all.count};
  CurrentActivity innermost = all.open.back();
  innermost.what.clear();
  for (const CurrentActivity& one : all.open)
    innermost.what += (innermost.what.empty() ? "" : ": ") + one.what;
  return innermost;
}

}  // namespace stridor
