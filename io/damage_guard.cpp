#include "io/damage_guard.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>

namespace stridor {
namespace {

// Read by the handler, which may call next to nothing.
std::atomic<const char*> message_words{nullptr};
std::atomic<std::size_t> num_bytes{0};
const DamageGuard* innermost = nullptr;

// Damage may also let the library recurse until the stack is used up.
alignas(16) std::array<char, 16384> handler_stack;

void leave(int) {
  const char* text = message_words;
  if (text != nullptr && write(STDERR_FILENO, text, num_bytes) < 0) _exit(1);
  _exit(DamageGuard::exit_code);
}

}  // namespace

DamageGuard::DamageGuard(const std::string& path)
    : last_words_(fmt::format("stridor: I/O error\n{}: is damaged, as it seems: the program "
                              "crashed while it had this file open\n",
                              path)),
      outer_(innermost) {
  innermost = this;
  num_bytes = last_words_.size();
  message_words = last_words_.data();
  stack_t stack{};
  stack.ss_sp = handler_stack.data();
  stack.ss_size = handler_stack.size();
  sigaltstack(&stack, &former_stack_);
  struct sigaction action {};
  action.sa_handler = leave;
  action.sa_flags = SA_ONSTACK;
  for (std::size_t i = 0; i < crashes.size(); ++i)
    sigaction(crashes[i], &action, &former_actions_[i]);
}

DamageGuard::~DamageGuard() {
  for (std::size_t i = 0; i < crashes.size(); ++i)
    sigaction(crashes[i], &former_actions_[i], nullptr);
  sigaltstack(&former_stack_, nullptr);
  innermost = outer_;
  message_words = outer_ != nullptr ? outer_->last_words_.data() : nullptr;
  num_bytes = outer_ != nullptr ? outer_->last_words_.size() : 0;
}

}  // namespace stridor
