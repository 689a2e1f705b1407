#include "io/hdf5/damage_guard.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <nlohmann/json.hpp>

#include "core/refusals.hpp"

namespace stridor {
namespace {

// Read by the handler, which may call next to nothing.
struct LastWords {
  std::atomic<const char*> text{nullptr};
  std::atomic<std::size_t> num_bytes{0};

  void set(const std::string* words) {
    num_bytes = words != nullptr ? words->size() : 0;
    text = words != nullptr ? words->data() : nullptr;
  }
  /// @return whether there was nothing that could not be written
  bool write_to(int descriptor) const {
    const char* const bytes = text;
    return bytes == nullptr || write(descriptor, bytes, num_bytes) >= 0;
  }
};
LastWords message_words;
LastWords json_words;
std::atomic<bool> is_json_wanted{false};
const DamageGuard* innermost = nullptr;

// Damage may also let the library recurse until the stack is used up.
alignas(16) std::array<char, 16384> handler_stack;

void leave(int) {
  const bool is_told = message_words.write_to(STDERR_FILENO);
  if (is_json_wanted && !json_words.write_to(STDOUT_FILENO)) _exit(1);
  if (!is_told) _exit(1);
  _exit(DamageGuard::exit_code);
}

constexpr const char* crash_message =
    "is damaged, as it seems: the program crashed while it had this file open";

std::string crash_json(const std::string& path) {
  using Json = nlohmann::json;
  const Json error = {{"code", code_of(Refusal::file_damaged)},
                      {"file", path},
                      {"line", 0},
                      {"column", 0},
                      {"key", ""},
                      {"message", crash_message}};
  const Json object = {{"errors", Json::array({error})}};
  // Names of files need not be UTF-8.
  return object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

void DamageGuard::tell_as_json() {
  is_json_wanted = true;
}

DamageGuard::DamageGuard(const std::string& path)
    : last_words_(fmt::format(
          "stridor: I/O error\n{}\n",
          with_code(fmt::format("{}: {}", path, crash_message), Refusal::file_damaged))),
      json_(crash_json(path)),
      outer_(innermost) {
  innermost = this;
  message_words.set(&last_words_);
  json_words.set(&json_);
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
  message_words.set(outer_ != nullptr ? &outer_->last_words_ : nullptr);
  json_words.set(outer_ != nullptr ? &outer_->json_ : nullptr);
}

}  // namespace stridor
