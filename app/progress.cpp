#include "app/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "app/remark.hpp"

namespace stridor {
namespace {

constexpr auto line_interval = std::chrono::seconds(10);

std::string duration_text(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 3600.0)
    return fmt::format("{:.0f} min {:02.0f} s", std::floor(seconds / 60.0),
                       std::fmod(seconds, 60.0));
  return fmt::format("{:.0f} h {:02.0f} min", std::floor(seconds / 3600.0),
                     std::fmod(seconds, 3600.0) / 60.0);
}

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)),
      is_terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      next_line_(start_ + line_interval) {}

Progress::~Progress() {
  finish();
}

void Progress::report(double fraction, const std::string& detail) {
  const auto now = Clock::now();
  if (!is_terminal_ && now < next_line_) return;
  next_line_ = now + line_interval;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const std::string left =
      fraction > 0.0 ? duration_text(elapsed * (1.0 - fraction) / fraction) + " left" : "";
  if (is_terminal_) {
    constexpr int width = 30;
    const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * width);
    print_remark("\r{} [{}{}] {:3.0f} %  {}, {}\033[K", what_,
                 std::string(static_cast<std::size_t>(filled), '#'),
                 std::string(static_cast<std::size_t>(width - filled), ' '), 100.0 * fraction,
                 detail, left);
    std::fflush(stderr);
    is_drawn_ = true;
  } else {
    print_remark("{}: {:.0f} %, {}, {}\n", what_, 100.0 * fraction, detail, left);
  }
}

void Progress::finish() {
  if (is_drawn_) print_remark("\r\033[K");
  is_drawn_ = false;
}

}  // namespace stridor
