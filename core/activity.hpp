// Current phase of a long computation, for display.
#pragma once

#include <cstdint>
#include <string>

namespace stridor {

/// Names the current phase of the main thread while it exists; nothing else depends on it. Objects
/// may be nested. Those of other threads are ignored: whoever shares out the tasks of those threads
/// counts them.
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

/// Phase named by Activity, for another thread.
struct CurrentActivity {
  std::string what;         ///< the outermost first; empty: nothing is known
  double fraction = 0.0;    ///< of the innermost; 0 also where it is not told
  std::uint64_t count = 0;  ///< changes with every activity that begins or ends
};
CurrentActivity current_activity();

/// Sets the action whenever the outermost one ends, on the main thread; null: none.
void on_idle(void (*act)());

}  // namespace stridor
