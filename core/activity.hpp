// What a long computation is at, for whoever shows it.
#pragma once

#include <cstdint>
#include <string>

namespace stridor {

/// Names what the main thread is at while it exists; nothing else depends on it. They may be
/// nested. Those of other threads are not told: their tasks are counted by who shares
/// them out.
class Activity {
 public:
  explicit Activity(std::string what);
  ~Activity();
  Activity(const Activity&) = delete;
  Activity& operator=(const Activity&) = delete;

  /// @param fraction done of it, 0 to 1
  void report(double fraction);

 private:
  bool is_told_;
};

/// What Activity says, for another thread.
struct CurrentActivity {
  std::string what;         ///< the outermost first; empty: nothing is known
  double fraction = 0.0;    ///< of the innermost; 0 also where it is not told
  std::uint64_t count = 0;  ///< changes with every activity that begins or ends
};
CurrentActivity current_activity();

/// What to do whenever the outermost one ends, on the main thread; null: nothing.
void on_idle(void (*act)());

}  // namespace stridor
