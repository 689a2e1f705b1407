#include "core/refusals.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace stridor {
namespace {

constexpr auto codes = std::to_array<std::pair<Refusal, std::string_view>>({
    {Refusal::wrong_value, "wrong-value"},
    {Refusal::wrong_unit, "wrong-unit"},
    {Refusal::wrong_size, "wrong-size"},
    {Refusal::unknown_key, "unknown-key"},
    {Refusal::unknown_name, "unknown-name"},
    {Refusal::unknown_option, "unknown-option"},
    {Refusal::doubled_name, "doubled-name"},
    {Refusal::missing, "missing"},
    {Refusal::contradiction, "contradiction"},
    {Refusal::expression, "expression"},
    {Refusal::not_yaml, "not-yaml"},
    {Refusal::former_format, "former-format"},
    {Refusal::wrong_text, "wrong-text"},
    {Refusal::wrong_matrix, "wrong-matrix"},
    {Refusal::wrong_mesh, "wrong-mesh"},
    {Refusal::off_the_surface, "off-the-surface"},
    {Refusal::motion_is_held, "motion-is-held"},
    {Refusal::not_of_revolution, "not-of-revolution"},
    {Refusal::cannot_reduce, "cannot-reduce"},
    {Refusal::too_large, "too-large"},
    {Refusal::step_too_large, "step-too-large"},
    {Refusal::interval, "interval"},
    {Refusal::not_recorded, "not-recorded"},
    {Refusal::contact_pulls, "contact-pulls"},
    {Refusal::sliding_turns, "sliding-turns"},
    {Refusal::contact_jams, "contact-jams"},
    {Refusal::left_the_surface, "left-the-surface"},
    {Refusal::substrate_too_stiff, "substrate-too-stiff"},
    {Refusal::indentation_too_deep, "indentation-too-deep"},
    {Refusal::diverged, "diverged"},
    {Refusal::no_equilibrium, "no-equilibrium"},
    {Refusal::eigenvalues_incomplete, "eigenvalues-incomplete"},
    {Refusal::singular, "singular"},
    {Refusal::no_convergence, "no-convergence"},
    {Refusal::expectation_missed, "expectation-missed"},
    {Refusal::file_exists, "file-exists"},
    {Refusal::file_is_written, "file-is-written"},
    {Refusal::file_damaged, "file-damaged"},
    {Refusal::other_kind_of_file, "other-kind-of-file"},
    {Refusal::cannot_read, "cannot-read"},
    {Refusal::cannot_write, "cannot-write"},
    {Refusal::helper_program, "helper-program"},
    {Refusal::interrupted, "interrupted"},
    {Refusal::out_of_memory, "out-of-memory"},
    {Refusal::internal_error, "internal-error"},
});

constexpr bool are_in_order() {
  for (std::size_t k = 0; k < codes.size(); ++k)
    if (static_cast<std::size_t>(codes[k].first) != k) return false;
  return true;
}
static_assert(are_in_order());

constexpr auto kinds = [] {
  std::array<Refusal, codes.size()> all{};
  for (std::size_t k = 0; k < codes.size(); ++k) all[k] = codes[k].first;
  return all;
}();

}  // namespace

std::string_view code_of(Refusal refusal) {
  return codes[static_cast<std::size_t>(refusal)].second;
}

std::span<const Refusal> all_refusals() {
  return kinds;
}

std::string with_code(std::string_view text, Refusal refusal) {
  std::string result(text);
  std::size_t end = std::min(result.find('\n'), result.size());
  if (end > 0 && result[end - 1] == ':') --end;
  result.insert(end, " [" + std::string(code_of(refusal)) + "]");
  return result;
}

}  // namespace stridor
