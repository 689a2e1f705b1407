// Processor time of the calling thread, without other load on the machine.
#pragma once

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <limits>

namespace stridor::bench {

inline double processor_seconds() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Times a march in equal stretches. The other thread of a core slows this one down without that
/// showing in processor time, so the fastest stretch says most about the program.
class StretchClock {
 public:
  static constexpr std::int64_t num_stretches = 20;

  /// @param num_samples that the march passes
  explicit StretchClock(std::int64_t num_samples)
      : num_samples_(num_samples),
        stretch_(std::max<std::int64_t>(1, num_samples / num_stretches)) {}

  void pass(std::int64_t sample) {
    if (sample % stretch_ != 0) return;
    const double now = processor_seconds();
    if (sample > 0) least_ = std::min(least_, now - last_);
    last_ = now;
  }

  /// Of the whole march at the pace of its fastest stretch, s.
  double least() const {
    return least_ * static_cast<double>(num_samples_) / static_cast<double>(stretch_);
  }

 private:
  std::int64_t num_samples_;
  std::int64_t stretch_;
  double last_ = 0.0;
  double least_ = std::numeric_limits<double>::infinity();
};

}  // namespace stridor::bench
