#include "core/stop_token.hpp"

#include <atomic>
#include <csignal>

namespace stridor {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "needed inside a signal handler");

extern "C" void on_signal(int) {
  stop.store(true, std::memory_order_relaxed);
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

}  // namespace

void install_stop_signals() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

bool stop_requested() {
  return stop.load(std::memory_order_relaxed);
}

void request_stop(bool value) {
  stop.store(value, std::memory_order_relaxed);
}

}  // namespace stridor
