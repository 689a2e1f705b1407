#include "app/terminal/command_problem.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/terminal/manual.hpp"
#include "core/suggestion.hpp"

namespace stridor {
namespace {

/// Without a verb nothing else can be told of the words.
CommandProblem problem_of_verb(CLI::App& program, const std::vector<std::string>& words) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : verbs_of(program)) verbs.push_back(verb->get_name());
  const std::string list = fmt::format("{}", fmt::join(verbs, ", "));
  if (words.empty()) return {Refusal::missing, fmt::format("a verb is required: {}", list), ""};
  const bool is_option = words.front().starts_with('-');
  return {Refusal::unknown_option,
          fmt::format("there is no {} '{}'{} (verbs: {})", is_option ? "option" : "verb",
                      words.front(), is_option ? "" : did_you_mean(words.front(), verbs), list),
          ""};
}

/// Error of an option that the verb does not have, or "".
std::string option_problem(const CLI::App& verb, const std::vector<std::string>& words) {
  std::vector<std::string> known;
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (!name.starts_with("--") || std::find(known.begin(), known.end(), name) != known.end())
      continue;
    return fmt::format("{} has no option '{}'{}", verb.get_name(), name, did_you_mean(name, known));
  }
  return "";
}

Refusal kind_of(const CLI::ParseError& error) {
  const auto is = [&](const char* name) { return error.get_name() == name; };
  if (is("RequiredError") || is("RequiresError")) return Refusal::missing;
  if (is("ValidationError") || is("ConversionError")) return Refusal::wrong_value;
  // "--count: 1 required INT missing", or "At least 4 required but received 3".
  if (is("ArgumentMismatch"))
    return std::string(error.what()).ends_with("missing") ? Refusal::missing : Refusal::wrong_size;
  if (is("ExcludesError")) return Refusal::contradiction;
  return Refusal::unknown_option;
}

}  // namespace

CommandProblem problem_of_command(CLI::App& program, const CLI::ParseError& error,
                                  const std::vector<std::string>& words) {
  const auto verbs = program.get_subcommands(
      [&](const CLI::App* verb) { return !words.empty() && verb->get_name() == words.front(); });
  if (verbs.empty()) return problem_of_verb(program, words);
  const CLI::App& verb = *verbs.front();
  CommandProblem found{kind_of(error), error.what(), verb.get_name()};
  if (const std::string unknown = option_problem(verb, words); !unknown.empty())
    return {Refusal::unknown_option, unknown, found.verb};
  if (found.refusal == Refusal::missing) {
    // "--kind is required": with its meaning.
    const CLI::Option* option =
        verb.get_option_no_throw(found.message.substr(0, found.message.find(' ')));
    if (option != nullptr) found.message += ": " + option->get_description();
  }
  return found;
}

}  // namespace stridor
