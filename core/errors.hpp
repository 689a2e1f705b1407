// Exceptions through which stridor reports errors.
//
//   ConfigError            wrong user input (scene, --set, command line)      exit 2
//   NumericalError         numerical failure: diverged, singular, lost        exit 3
//   FileError              a file cannot be read or written                   exit 4
//   Interrupted            stopped on request                                 exit 5
//   std::invalid_argument  a broken precondition of a C++ call (a bug)        exit 1
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "core/refusals.hpp"

namespace stridor {

/// One error in the user's input.
struct Problem {
  Refusal refusal;      ///< its kind
  std::string key;      ///< dotted path, e.g. "time.step"; empty where the file as a whole is meant
  std::string message;  ///< error, expected value and remedy; one line, no place
  /// File, or "--set key=value"; empty until the reader of the scene fills it in.
  std::string source{};
  int line = 0;    ///< 1-based; 0 where there is none
  int column = 0;  ///< 1-based; 0 where there is none
  std::string excerpt{};  ///< text written there, with a caret (core/excerpt.hpp); may be empty
  std::string dataset{};  ///< dataset or attribute of the file that is meant; may be empty

  /// "source:line:column: key: message", omitting unknown parts.
  std::string text() const;
};

/// The scene or the command line is wrong. Holds all problems found, in the order of the file.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<Problem> problems);
  ConfigError(Refusal refusal, std::string key, std::string message);

  const std::vector<Problem>& problems() const { return problems_; }
  /// The text of every problem with its code, each followed by its excerpt; `what()` is the texts
  /// alone.
  std::string report() const;

 private:
  std::vector<Problem> problems_;
};

/// A file cannot be opened, read or written, or has unexpected contents.
class FileError : public std::runtime_error {
 public:
  /// @param refusal its kind
  /// @param path    the file
  /// @param dataset dataset or attribute inside it; empty where the file as a whole is meant
  /// @param cause   cause and remedy, one line
  FileError(Refusal refusal, const std::string& path, const std::string& dataset,
            const std::string& cause);

  Refusal refusal() const { return problem_.refusal; }
  /// Path, dataset and cause apart; its text is `what()`.
  const Problem& problem() const { return problem_; }

 private:
  explicit FileError(Problem problem);

  Problem problem_;
};

/// The computation failed: singular, diverged, or left its range of validity.
class NumericalError : public std::runtime_error {
 public:
  NumericalError(Refusal refusal, const std::string& message)
      : std::runtime_error(message), refusal_(refusal) {}

  Refusal refusal() const { return refusal_; }
  /// What it says, with its code.
  std::string report() const { return with_code(what(), refusal_); }

 private:
  Refusal refusal_;
};

/// The user asked the program to stop (Ctrl-C, SIGTERM).
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stridor
