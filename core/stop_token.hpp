// Ctrl-C and SIGTERM: immediate end of the program, or a request to end in order.
#pragma once

#include <sys/types.h>

#include <string>

namespace stridor {

/// Exit code of a program that was stopped on request.
constexpr int stopped_exit_code = 5;

/// Routes SIGINT and SIGTERM.
///
/// Wherever nothing would be lost, a signal ends the program immediately: inside a factorisation or
/// an eigenvalue decomposition of a library too, which no loop of ours could leave. Unfinished
/// files are removed, a word goes to stderr, the exit code is 5. While an OrderlyStop exists, a
/// signal is a request that loops ask for, and a second one ends the program as if nobody had
/// listened.
void install_stop_signals();

/// When a signal ends the program immediately, it also prints one JSON object with the error to
/// stdout.
void tell_stop_as_json();

/// True once the user has asked the program to stop. Cheap; safe in any loop.
bool stop_requested();

/// As if the signal had come (tests, time limits); `false` takes the request back.
void request_stop(bool value = true);

/// @throws Interrupted if a stop was requested; for loops whose results are not kept
void throw_if_stopped();

/// While one exists, an immediate end of the program would lose data.
class OrderlyStop {
 public:
  OrderlyStop();
  ~OrderlyStop();
  OrderlyStop(const OrderlyStop&) = delete;
  OrderlyStop& operator=(const OrderlyStop&) = delete;
};

/// A file or folder that a signal removes where it ends the program at once. It need not exist yet,
/// or any more; a folder goes if nothing else is in it.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::string& path);
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

 private:
  int slot_;
};

/// A program that runs for this one, and is ended with it.
class HelperProcess {
 public:
  explicit HelperProcess(pid_t process);
  ~HelperProcess();
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;
};

/// Says that a file has got its final name: from then on the last word is not that nothing has been
/// written.
void note_written_file();

}  // namespace stridor
