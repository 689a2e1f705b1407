// The command line of stridor.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/terminal/command.hpp"
#include "app/terminal/command_problem.hpp"
#include "app/terminal/manual.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/remark.hpp"
#include "app/terminal/value_names.hpp"
#include "core/blas_memory.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "core/version.hpp"
#include "io/hdf5/damage_guard.hpp"

namespace stridor {
namespace {

static_assert(static_cast<int>(ExitCode::file_trouble) == DamageGuard::exit_code);
static_assert(static_cast<int>(ExitCode::stopped) == stopped_exit_code);

bool wants_json = false;

/// Tells of a failure on stderr, and with --json as the one object on stdout.
int report(const char* kind, const std::string& message, ExitCode code,
           const std::vector<Problem>& problems) {
  print_remark("stridor: {}\n{}\n", kind, message);
  if (wants_json) finish_json(problems);
  return static_cast<int>(code);
}

int report(const char* kind, const std::string& message, ExitCode code, Refusal refusal) {
  return report(kind, with_code(message, refusal), code, {{refusal, "", message}});
}

/// A file that is opened takes the lowest free number: where input or output are closed it would
/// get theirs, and what is printed would go into it.
void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) == -1 && errno == EBADF &&
        open("/dev/null", stream == STDIN_FILENO ? O_RDONLY : O_WRONLY) != stream)
      _exit(static_cast<int>(ExitCode::internal));
  }
}

/// Flushes the output. @return 4, reported on stderr, where a command that is done could not
///         print; else `code`
int with_output_written(int code) {
  errno = 0;
  const bool is_written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (is_written || code != static_cast<int>(ExitCode::done)) return code;
  return report("I/O error",
                errno != 0
                    ? fmt::format("the standard output cannot be written: {}", std::strerror(errno))
                    : std::string("the standard output cannot be written"),
                ExitCode::file_trouble, Refusal::cannot_write);
}

std::string joined_arguments(int argc, char** argv) {
  std::string command;
  for (int i = 0; i < argc; ++i) {
    if (i > 0) command += ' ';
    command += argv[i];
  }
  return command;
}

void add_verbs(CLI::App& program, Action& action, const std::string& command) {
  add_run_command(program, action, command);
  add_check_command(program, action);
  add_draw_command(program, action);
  add_import_command(program, action);
  add_info_command(program, action);
  add_plot_command(program, action, command);
  add_schema_command(program, action);
  add_compare_command(program, action, command);
  add_precision_command(program, action, command);
  add_spectrogram_command(program, action, command);
  add_sound_command(program, action);
  add_report_command(program, action, command);
  add_eig_command(program, action, command);
  add_locus_command(program, action, command);
  add_frf_command(program, action, command);
  add_threshold_command(program, action, command);
  add_map_command(program, action, command);
  add_contact_command(program, action, command);
  add_fit_command(program, action);
  add_cycle_command(program, action, command);
  add_sweep_command(program, action, command);
  add_hidden_commands(program, action);
}

int run_verb(int argc, char** argv) {
  CLI::App program{"stridor: friction-induced vibration of sliding flexible bodies", "stridor"};
  program.set_version_flag("--version", fmt::format("stridor {} ({})", version, commit));
  program.require_subcommand(1);
  program.failure_message(CLI::FailureMessage::help);
  Action action;
  const std::string command = joined_arguments(argc, argv);
  add_verbs(program, action, command);
  std::string progress;
  for (CLI::App* verb : program.get_subcommands([](const CLI::App*) { return true; })) {
    verb->add_option("--progress", progress,
                     "Tell progress on stderr as JSON, a line each, for programs")
        ->check(CLI::IsMember({"json"}));
  }
  name_values(program);
  // Words that are being typed need not make a command yet.
  if (argc > 2 && std::string_view(argv[1]) == "complete") {
    // First the words behind the one that is being typed, then "--", then the words up to it.
    char** const sign = std::find(argv + 2, argv + argc, std::string_view("--"));
    if (sign != argv + argc) {
      print_candidates(program, {sign + 1, argv + argc}, {argv + 2, sign});
      return static_cast<int>(ExitCode::done);
    }
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      const CommandProblem found = problem_of_command(program, error, {argv + 1, argv + argc});
      print_remark("stridor: {}\nTry 'stridor {}--help'.\n",
                   with_code(found.message, found.refusal),
                   found.verb.empty() ? "" : found.verb + " ");
      if (wants_json) finish_json({{found.refusal, "", found.message}});
      return static_cast<int>(ExitCode::bad_input);
    }
    return program.exit(error);
  }
  if (!progress.empty()) Progress::tell_as_json();
  reserve_blas_memory();
  // Shown while nothing of the verb's own is, as during set-up.
  const Progress whole(argv[1]);
  const ExitCode code = action();
  finish_json({});
  return static_cast<int>(code);
}

int run_program(int argc, char** argv) {
  wants_json = std::any_of(argv, argv + argc, [](const char* argument) {
    return std::string_view(argument) == "--json";
  });
  try {
    if (wants_json) {
      tell_stop_as_json();
      DamageGuard::tell_as_json();
    }
    install_stop_signals();
    // A reader that goes away, or a file that may not grow, are errors to report, not deaths.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    return run_verb(argc, argv);
  } catch (const ConfigError& error) {
    return report("the input is wrong", error.report(), ExitCode::bad_input, error.problems());
  } catch (const FileError& error) {
    return report("I/O error", with_code(error.what(), error.refusal()), ExitCode::file_trouble,
                  {error.problem()});
  } catch (const NumericalError& error) {
    return report("the computation failed", error.what(), ExitCode::numbers_failed,
                  error.refusal());
  } catch (const Interrupted& error) {
    // Without its code: the message ends with a command to copy.
    return report("stopped on request", error.what(), ExitCode::stopped,
                  {{Refusal::interrupted, "", error.what()}});
  } catch (const std::system_error& error) {
    // fmt says like this that a stream took no more.
    if (std::ferror(stdout) == 0)
      return report("internal error; please report it", error.what(), ExitCode::internal,
                    Refusal::internal_error);
    return report("I/O error",
                  fmt::format("the standard output cannot be written: {}", error.code().message()),
                  ExitCode::file_trouble, Refusal::cannot_write);
  } catch (const std::bad_alloc& error) {
    return report("out of memory", error.what(), ExitCode::internal, Refusal::out_of_memory);
  } catch (const std::exception& error) {
    return report("internal error; please report it", error.what(), ExitCode::internal,
                  Refusal::internal_error);
  }
}

}  // namespace
}  // namespace stridor

int main(int argc, char** argv) {
  stridor::occupy_closed_streams();
  return stridor::with_output_written(stridor::run_program(argc, argv));
}
