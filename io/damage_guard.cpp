#include "app/damage_guard.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>

#include "app/command.hpp"

namespace stridor {
namespace {

constexpr std::array<int, 5> crashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
std::array<struct sigaction, crashes.size()> former_actions;
stack_t former_stack{};

// Read by the handler, which may call next to nothing.
std::atomic<const char*> words{nullptr};
std::atomic<std::size_t> num_bytes{0};

// Damage may also let the library recurse until the stack is used up.
alignas(16) std::array<char, 16384> handler_stack;

void leave(int) {
  const char* text = words;
  if (text != nullptr && write(STDERR_FILENO, text, num_bytes) < 0) _exit(1);
  _exit(static_cast<int>(ExitCode::file_trouble));
}

}  // namespace

DamageGuard::DamageGuard(const std::string& path)
    : last_words_(fmt::format("stridor: file trouble\n{}: is damaged, as it seems: the program "
                              "crashed while it had this file open\n",
                              path)) {
  words = last_words_.data();
  num_bytes = last_words_.size();
  stack_t stack{};
  stack.ss_sp = handler_stack.data();
  stack.ss_size = handler_stack.size();
  sigaltstack(&stack, &former_stack);
  struct sigaction action {};
  action.sa_handler = leave;
  action.sa_flags = SA_ONSTACK;
  for (std::size_t i = 0; i < crashes.size(); ++i)
    sigaction(crashes[i], &action, &former_actions[i]);
}

DamageGuard::~DamageGuard() {
  for (std::size_t i = 0; i < crashes.size(); ++i)
    sigaction(crashes[i], &former_actions[i], nullptr);
  sigaltstack(&former_stack, nullptr);
}

}  // namespace stridor
