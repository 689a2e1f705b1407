// Kinds of refusals and failures, each with a code that stays.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stridor {

/// Why stridor refuses or fails. docs/refusals.md has a section for each, headed by its code.
enum class Refusal {
  // The scene or the command line is wrong (exit code 2).
  wrong_value,     ///< out of range, or not of the form that is expected
  wrong_unit,      ///< a unit of another kind
  wrong_size,      ///< not as many numbers, rows or columns as expected
  unknown_key,     ///< a key that the scene does not have
  unknown_name,    ///< no body, point, surface, channel ... is called like this
  unknown_option,  ///< a verb or option that is not there
  doubled_name,    ///< a name or place that is taken
  missing,         ///< a key, section, option or part that is needed
  contradiction,   ///< keys or options that do not go together
  expression,      ///< an expression or parameter that has no value
  not_yaml,        ///< text that is not the YAML of a scene
  former_format,   ///< a key or scene of an earlier version
  wrong_text,      ///< a line of an imported file that cannot be understood
  wrong_matrix,    ///< not symmetric, or not definite
  wrong_mesh,      ///< elements, groups or materials that make no body
  off_the_surface,     ///< a contact that does not start on its master, or a place beside a body
  motion_is_held,      ///< supports leave no motion where one is needed
  not_of_revolution,   ///< a body that is to spin and is not alike around its axis
  cannot_reduce,       ///< a body that cannot be reduced as asked, or must be
  too_large,           ///< more memory, time or numbers than there is room for
  step_too_large,      ///< of the time step
  interval,            ///< recording interval and step do not fit
  not_recorded,        ///< a file of results does not hold what is asked for
  // The computation failed (exit code 3).
  contact_pulls,
  sliding_turns,
  contact_jams,
  left_the_surface,
  substrate_too_stiff,
  indentation_too_deep,
  diverged,
  no_equilibrium,
  eigenvalues_incomplete,
  singular,
  no_convergence,
  expectation_missed,
  // Files (exit code 4).
  file_exists,
  file_is_written,
  file_damaged,
  other_kind_of_file,
  cannot_read,
  cannot_write,
  helper_program,
  // Neither input, numbers nor files (exit codes 1 and 5).
  interrupted,
  out_of_memory,
  internal_error,
};

/// The code: the name of the enumerator with hyphens, as "off-the-surface".
std::string_view code_of(Refusal refusal);

/// Every kind, in the order of the enumeration.
std::span<const Refusal> all_refusals();

/// `text` with " [code]" at the end of its first line, before a colon there.
std::string with_code(std::string_view text, Refusal refusal);

}  // namespace stridor
