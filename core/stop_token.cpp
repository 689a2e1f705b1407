#include "core/stop_token.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <mutex>
#include <set>

#include "core/errors.hpp"

namespace stridor {
namespace {

// Flags that the handler reads. It may run at any moment, in any thread.
std::atomic<bool> stop{false};
std::atomic<int> num_orderly{0};
std::atomic<bool> is_told_as_json{false};
std::atomic<bool> has_written{false};
std::atomic<pid_t> helper{0};
std::array<std::atomic<const char*>, 64> unfinished{};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<pid_t>::is_always_lock_free &&
                  std::atomic<const char*>::is_always_lock_free,
              "needed inside a signal handler");

void say(int descriptor, const char* text) {
  // A failure to write here is of no interest: the reader is gone.
  if (write(descriptor, text, std::strlen(text)) < 0) return;
}

/// Only calls that a signal handler may make.
[[noreturn]] void leave() {
  if (const pid_t process = helper; process > 0) kill(process, SIGKILL);
  for (const auto& slot : unfinished) {
    if (const char* path = slot) unlink(path);
  }
  for (const auto& slot : unfinished) {
    if (const char* path = slot) rmdir(path);
  }
  const char* const fate = has_written ? "files written before are whole; no other is left behind\n"
                                       : "nothing has been written\n";
  if (isatty(STDERR_FILENO) == 1) say(STDERR_FILENO, "\r\033[K");  // the bar of progress
  say(STDERR_FILENO, "stridor: stopped on request\n");
  say(STDERR_FILENO, fate);
  if (is_told_as_json) {
    say(STDOUT_FILENO, has_written ? "{\"errors\": [{\"code\": \"interrupted\", \"message\": "
                                     "\"stopped on request; files written before are "
                                     "whole\"}]}\n"
                                   : "{\"errors\": [{\"code\": \"interrupted\", \"message\": "
                                     "\"stopped on request; nothing has been "
                                     "written\"}]}\n");
  }
  _exit(stopped_exit_code);
}

extern "C" void on_signal(int) {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  if (num_orderly == 0) leave();
  stop.store(true, std::memory_order_relaxed);
}

/// A path that stays where it is for ever: the handler may be reading it.
const char* lasting(const std::string& path) {
  static std::mutex changing;
  static std::set<std::string> paths;
  const std::lock_guard lock(changing);
  return paths.insert(path).first->c_str();
}

}  // namespace

void install_stop_signals() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

void tell_stop_as_json() {
  is_told_as_json = true;
}

bool stop_requested() {
  return stop.load(std::memory_order_relaxed);
}

void request_stop(bool value) {
  stop.store(value, std::memory_order_relaxed);
}

void throw_if_stopped() {
  if (stop_requested()) throw Interrupted("nothing has been written");
}

OrderlyStop::OrderlyStop() {
  ++num_orderly;
}

OrderlyStop::~OrderlyStop() {
  --num_orderly;
}

UnfinishedFile::UnfinishedFile(const std::string& path) : slot_(-1) {
  const char* const name = lasting(path);
  for (std::size_t i = 0; i < unfinished.size() && slot_ < 0; ++i) {
    const char* none = nullptr;
    if (unfinished[i].compare_exchange_strong(none, name)) slot_ = static_cast<int>(i);
  }
}

UnfinishedFile::~UnfinishedFile() {
  if (slot_ >= 0) unfinished[static_cast<std::size_t>(slot_)] = nullptr;
}

HelperProcess::HelperProcess(pid_t process) {
  helper = process;
}

HelperProcess::~HelperProcess() {
  helper = 0;
}

void note_written_file() {
  has_written = true;
}

}  // namespace stridor
