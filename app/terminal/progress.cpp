#include "app/terminal/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "app/terminal/remark.hpp"
#include "core/activity.hpp"

namespace stridor {

/// Shows the newest of all Progress that are open, now and then.
class ProgressDisplay {
 public:
  static ProgressDisplay& one() {
    static ProgressDisplay display;
    return display;
  }
  ~ProgressDisplay() {
    on_idle(nullptr);
    {
      const std::lock_guard lock(changing_);
      is_over_ = true;
    }
    wake_.notify_all();
    if (ticker_.joinable()) ticker_.join();
  }

  void open(Progress& progress) {
    const std::lock_guard lock(changing_);
    open_.push_back(&progress);
    if (!ticker_.joinable()) start_ticker();
  }
  void close(Progress& progress) {
    const std::lock_guard lock(changing_);
    if (!progress.is_open_) return;
    progress.is_open_ = false;
    std::erase(open_, &progress);
    if (is_json_ && progress.pace_ && progress.pace_->fraction() >= 1.0) {
      print_remark("{}\n", progress.json_line(*progress.pace_, progress.detail_, Clock::now()));
      std::fflush(stderr);
    }
    clear();
  }
  template <class Change>
  void change(Change&& change) {
    const std::lock_guard lock(changing_);
    change();
    const auto now = Clock::now();
    if (draws_often() ? now >= next_drawing_ : now >= next_line_) show(now);
  }
  void tell_as_json() { is_json_ = true; }

 private:
  ProgressDisplay() {
    on_idle([] {
      const std::lock_guard lock(one().changing_);
      if (one().is_activity_drawn_) one().clear();
    });
  }

  void clear() {
    if (is_drawn_) {
      std::fputs("\r\033[K", stderr);
      std::fflush(stderr);
    }
    is_drawn_ = is_activity_drawn_ = false;
  }

  using Clock = std::chrono::steady_clock;
  static constexpr auto line_interval = std::chrono::seconds(10);
  static constexpr auto drawing_interval = std::chrono::milliseconds(100);
  static constexpr auto json_interval = std::chrono::milliseconds(250);
  static constexpr auto tick = std::chrono::milliseconds(500);
  /// Shorter phases need not be shown.
  static constexpr auto patience = std::chrono::seconds(1);

  /// Signals are for the main thread.
  void start_ticker() {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    ticker_ = std::thread([this] { run_ticker(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }
  void run_ticker() {
    std::unique_lock lock(changing_);
    while (!wake_.wait_for(lock, tick, [this] { return is_over_; })) {
      const auto now = Clock::now();
      if (now >= (is_json_ ? next_drawing_ : is_terminal_ ? start_ + patience : next_line_)) show(now);
    }
  }

  bool draws_often() const { return is_terminal_ || is_json_; }

  void show(Clock::time_point now) {
    if (open_.empty()) return;
    const Progress& newest = *open_.back();
    std::string detail = newest.detail_;
    Pace pace = newest.pace_.value_or(Pace(newest.start_));
    const CurrentActivity activity = current_activity();
    const bool is_activity = !newest.pace_ && !activity.what.empty();
    // The first one lasts as long as the program, which may be printing.
    if (!newest.pace_ && !is_activity && open_.size() == 1) return;
    next_drawing_ = now + (is_json_ ? json_interval : drawing_interval);
    next_line_ = now + line_interval;
    if (is_activity) {
      if (activity.count != activity_count_) {
        activity_pace_ = Pace(now);
        activity_count_ = activity.count;
      }
      activity_pace_.report(activity.fraction, now);
      detail = activity.what;
      pace = activity_pace_;
    }
    if (is_json_) {
      print_remark("{}\n", newest.json_line(pace, detail, now));
      std::fflush(stderr);
      return;
    }
    if (!is_terminal_) {
      print_remark("{}\n", newest.line(pace, detail, "", now));
      return;
    }
    // A line that wraps could not be taken back.
    winsize size{};
    const bool has_size = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    const std::string line = newest.line(pace, detail, bar(pace), now);
    print_remark("\r{}\033[K", line.substr(0, has_size ? size.ws_col - 1u : 79u));
    std::fflush(stderr);
    is_drawn_ = true;
    is_activity_drawn_ = is_activity;
  }

  static std::string bar(const Pace& pace) {
    if (!(pace.fraction() > 0.0)) return "";
    constexpr std::size_t width = 30;
    const auto filled = static_cast<std::size_t>(pace.fraction() * width);
    return fmt::format(" [{}{}]", std::string(filled, '#'), std::string(width - filled, ' '));
  }

  std::mutex changing_;
  std::condition_variable wake_;
  std::thread ticker_;
  std::vector<Progress*> open_;
  bool is_over_ = false;
  bool is_json_ = false;
  bool is_drawn_ = false;
  bool is_activity_drawn_ = false;
  const bool is_terminal_ = isatty(STDERR_FILENO) == 1;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point next_line_ = start_ + line_interval;
  Clock::time_point next_drawing_ = start_;
  Pace activity_pace_{start_};
  std::uint64_t activity_count_ = 0;
};

Progress::Progress(std::string what) : what_(std::move(what)) {
  ProgressDisplay::one().open(*this);
}

Progress::~Progress() {
  finish();
}

void Progress::tell_as_json() {
  ProgressDisplay::one().tell_as_json();
}

std::string Progress::json_line(const Pace& pace, const std::string& detail,
                                SteadyTime now) const {
  const std::optional<double> left = pace.left(now);
  return nlohmann::ordered_json{
      {"phase", phase_.empty() ? what_ : what_ + ", " + phase_},
      {"text", detail},
      {"fraction", pace.fraction() > 0.0 ? nlohmann::ordered_json(pace.fraction()) : nullptr},
      {"seconds_left", left ? nlohmann::ordered_json(*left) : nullptr}}
      .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string Progress::line(const Pace& pace, const std::string& detail, const std::string& bar,
                           SteadyTime now) const {
  return fmt::format("{}{}{}:{} {}{}{}", what_, phase_.empty() ? "" : ", ", phase_, bar, detail,
                     detail.empty() ? "" : ", ", pace_text(pace, now));
}

std::string Progress::text(SteadyTime now) const {
  return line(pace_.value_or(Pace(start_)), detail_, "", now);
}

void Progress::begin(std::string phase) {
  ProgressDisplay::one().change([&] {
    phase_ = std::move(phase);
    detail_.clear();
    pace_.emplace(std::chrono::steady_clock::now());
  });
}

void Progress::report(double fraction, const std::string& detail) {
  ProgressDisplay::one().change([&] {
    const auto now = std::chrono::steady_clock::now();
    if (!pace_) pace_.emplace(start_);
    pace_->report(fraction, now);
    detail_ = detail;
  });
}

void Progress::report(const std::string& detail) {
  ProgressDisplay::one().change([&] {
    if (!pace_) pace_.emplace(start_);
    detail_ = detail;
  });
}

void Progress::finish() {
  ProgressDisplay::one().close(*this);
}

}  // namespace stridor
