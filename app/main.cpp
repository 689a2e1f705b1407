// The command line of stridor.
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "app/command.hpp"
#include "app/progress.hpp"
#include "app/sphere_commands.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "core/suggestion.hpp"
#include "core/version.hpp"
#include "io/damage_guard.hpp"

namespace stridor {
namespace {

static_assert(static_cast<int>(ExitCode::file_trouble) == DamageGuard::exit_code);
static_assert(static_cast<int>(ExitCode::stopped) == stopped_exit_code);

int report(const char* kind, const std::string& message, ExitCode code) {
  fmt::print(stderr, "stridor: {}\n{}\n", kind, message);
  return static_cast<int>(code);
}

std::string joined_arguments(int argc, char** argv) {
  std::string command;
  for (int i = 0; i < argc; ++i) {
    if (i > 0) command += ' ';
    command += argv[i];
  }
  return command;
}

/// What is wrong with the verb that the user wrote, or "".
std::string verb_problem(CLI::App& program, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return "";
  std::vector<std::string> verbs;
  for (const CLI::App* verb : program.get_subcommands([](const CLI::App*) { return true; }))
    verbs.push_back(verb->get_name());
  if (std::find(verbs.begin(), verbs.end(), argv[1]) != verbs.end()) return "";
  return fmt::format("there is no verb '{}'{} (there are: {})", argv[1],
                     did_you_mean(argv[1], verbs), fmt::join(verbs, ", "));
}

int run_verb(int argc, char** argv) {
  CLI::App program{"stridor: friction-induced vibration of sliding flexible bodies", "stridor"};
  program.set_version_flag("--version", fmt::format("stridor {} ({})", version, commit));
  program.require_subcommand(1);
  program.failure_message(CLI::FailureMessage::help);
  Action action;
  const std::string command = joined_arguments(argc, argv);
  add_run_command(program, action, command);
  add_check_command(program, action);
  add_info_command(program, action);
  add_plot_command(program, action);
  add_schema_command(program, action);
  add_compare_command(program, action, command);
  add_precision_command(program, action, command);
  add_spectrogram_command(program, action);
  add_eig_command(program, action);
  add_locus_command(program, action, command);
  add_threshold_command(program, action);
  add_map_command(program, action, command);
  add_contact_command(program, action, command);
  add_fit_command(program, action);
  add_cycle_command(program, action, command);
  add_sweep_command(program, action, command);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool is_failure = error.get_exit_code() != 0;
    if (is_failure) {
      const std::string verb = verb_problem(program, argc, argv);
      fmt::print(stderr, "stridor: {}\nTry 'stridor --help' or 'stridor VERB --help'.\n",
                 verb.empty() ? error.what() : verb);
      return static_cast<int>(ExitCode::bad_input);
    }
    return program.exit(error);
  }
  // Shown while nothing of the verb's own is, as during set-up.
  const Progress whole(argv[1]);
  return static_cast<int>(action());
}

int run_program(int argc, char** argv) {
  try {
    if (std::any_of(argv, argv + argc,
                    [](const char* word) { return std::string_view(word) == "--json"; }))
      tell_stop_as_json();
    install_stop_signals();
    // A reader that goes away, or a file that may not grow, are errors to report, not deaths.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    return run_verb(argc, argv);
  } catch (const ConfigError& error) {
    return report("the input is wrong", error.report(), ExitCode::bad_input);
  } catch (const FileError& error) {
    return report("file trouble", error.what(), ExitCode::file_trouble);
  } catch (const NumericalError& error) {
    return report("the computation failed", error.what(), ExitCode::numbers_failed);
  } catch (const Interrupted& error) {
    return report("stopped on request", error.what(), ExitCode::stopped);
  } catch (const std::bad_alloc& error) {
    return report("out of memory", error.what(), ExitCode::internal);
  } catch (const std::exception& error) {
    return report("internal error; please report it", error.what(), ExitCode::internal);
  }
}

}  // namespace
}  // namespace stridor

int main(int argc, char** argv) {
  return stridor::run_program(argc, argv);
}
