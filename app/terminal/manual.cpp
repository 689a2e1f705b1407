#include "app/terminal/manual.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <regex>
#include <sstream>

#include "core/version.hpp"

namespace stridor {
namespace {

/// Text of a page: what man(7) would read as its own is written out.
std::string escaped(const std::string& text) {
  std::string safe;
  for (const char one : text) {
    if (one == '\\') safe += "\\e";
    else if (one == '-') safe += "\\-";
    else safe += one;
  }
  if (!safe.empty() && (safe[0] == '.' || safe[0] == '\'')) safe.insert(0, "\\&");
  return safe;
}

std::string bold(const std::string& text) {
  return "\\fB" + escaped(text) + "\\fR";
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char one) { return static_cast<char>(std::toupper(one)); });
  return text;
}

/// Of the source where SOURCE_DATE_EPOCH says so (reproducible-builds.org), else of today.
std::string date() {
  const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
  std::time_t moment = std::time(nullptr);
  if (epoch != nullptr) std::from_chars(epoch, epoch + std::strlen(epoch), moment);
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(moment));
}

std::string head(const std::string& name, const std::string& section, const std::string& summary) {
  return fmt::format(".TH {} {} {} \"stridor {}\"\n.SH NAME\n{} \\- {}\n", upper(escaped(name)),
                     section, date(), version, escaped(name), escaped(summary));
}

/// A summary for apropos: one line that begins as a word does.
std::string summary_of(const CLI::App& verb) {
  std::string text = verb.get_description();
  if (text.size() > 1 && std::islower(static_cast<unsigned char>(text[1])) != 0)
    text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

/// "SCENE", "FILE ...": how a value is called.
std::string value_name(const CLI::Option& option) {
  std::string name = option.get_positional() ? upper(option.get_single_name()) : option.get_type_name();
  if (!option.get_positional()) {
    const std::size_t colon = name.find(':');
    if (colon != std::string::npos) name = name.substr(0, colon);
    if (name.empty()) name = "VALUE";
  }
  return name;
}

bool is_flag(const CLI::Option& option) {
  return option.get_items_expected_max() == 0;
}

std::string names_of(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames())
    names += (names.empty() ? "" : ", ") + bold("-" + name);
  for (const std::string& name : option.get_lnames())
    names += (names.empty() ? "" : ", ") + bold("--" + name);
  if (!is_flag(option)) names += " \\fI" + escaped(value_name(option)) + "\\fR";
  return names;
}

std::string entry_of(const CLI::Option& option) {
  std::string text = option.get_positional() ? "\\fI" + escaped(value_name(option)) + "\\fR"
                                             : names_of(option);
  text = ".TP\n" + text + "\n" + escaped(option.get_description());
  const std::string type = option.get_type_name();
  if (const std::size_t brace = type.find('{'); brace != std::string::npos)
    text += ". One of " +
            escaped(std::regex_replace(type.substr(brace + 1, type.rfind('}') - brace - 1),
                                       std::regex(","), ", "));
  if (!option.get_default_str().empty()) text += ". Default: " + escaped(option.get_default_str());
  if (option.get_required() && !option.get_positional()) text += ". Required";
  return text + ".\n";
}

/// With a capital at its start.
std::string sentence_of(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

constexpr const char* exit_codes =
    ".SH EXIT STATUS\n.TP\n0\nDone.\n.TP\n1\nInternal error, or out of memory.\n.TP\n2\nThe scene or "
    "the command line is wrong.\n.TP\n3\nThe computation failed, or expectations were not met.\n.TP\n4\n"
    "A file cannot be read or written, or is damaged.\n.TP\n5\nStopped on request; runs go on with "
    "\\fBstridor run \\-\\-resume\\fR.\n";

/// Whether a letter follows a place, before which a word has ended.
bool starts_word(const std::string& text, std::size_t at) {
  const auto is_letter = [&](std::size_t i) {
    return i < text.size() && std::isalpha(static_cast<unsigned char>(text[i])) != 0;
  };
  return is_letter(at + 1) && (at == 0 || !is_letter(at - 1));
}

/// Markdown within a line.
std::string inline_text(const std::string& line) {
  static const std::regex link(R"(!?\[([^\]]*)\]\([^)]*\))");
  const std::string plain = std::regex_replace(line, link, "$1");
  std::string text;
  bool is_code = false;
  bool is_emphasis = false;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const char one = plain[i];
    if (one == '`') {
      is_code = !is_code;
      text += is_code ? "\\fB" : "\\fR";
    } else if (one == '\\' && i + 1 < plain.size() && std::ispunct(static_cast<unsigned char>(plain[i + 1])) != 0) {
      text += plain[++i] == '-' ? "\\-" : std::string(1, plain[i]);
    } else if (one == '*' && !is_code && i + 1 < plain.size() && plain[i + 1] == '*') {
      ++i;  // bold in Markdown; plain here
    } else if (one == '*' && !is_code && (is_emphasis || starts_word(plain, i))) {
      is_emphasis = !is_emphasis;
      text += is_emphasis ? "\\fI" : "\\fR";
    } else {
      text += one == '-' ? std::string("\\-") : one == '\\' ? std::string("\\e") : std::string(1, one);
    }
  }
  if (!text.empty() && (text[0] == '.' || text[0] == '\'')) text.insert(0, "\\&");
  return text;
}

std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  std::string cell;
  for (std::size_t i = 1; i < row.size(); ++i) {
    if (row[i] == '|' && row[i - 1] != '\\') {
      const std::size_t begin = cell.find_first_not_of(' ');
      const std::size_t end = cell.find_last_not_of(' ');
      cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
      cell.clear();
    } else {
      cell += row[i];
    }
  }
  return cells;
}

/// A line of text as lines of at most 80 bytes, as far as it has spaces; what is no ASCII is
/// counted as man(7) spells it, "\\[u2212]".
std::string broken_line(const std::string& line) {
  std::istringstream words(line);
  std::string lines;
  std::size_t length = 0;
  for (std::string word; words >> word;) {
    std::size_t width = 0;
    for (const char one : word)
      width += static_cast<unsigned char>(one) < 0x80   ? 1
               : static_cast<unsigned char>(one) < 0xC0 ? 0
                                                        : 8;
    const bool is_first = lines.empty();
    const bool is_next_line = !is_first && length + 1 + width > 78;
    if (is_next_line && (word[0] == '.' || word[0] == '\'')) word.insert(0, "\\&");
    lines += (is_first ? "" : is_next_line ? "\n" : " ") + word;
    length = is_first || is_next_line ? width : length + 1 + width;
  }
  return lines + "\n";
}

/// A page in short lines; tags and what is set as it is written stay whole.
std::string in_short_lines(const std::string& page) {
  std::istringstream lines(page);
  std::string broken;
  bool is_tag = false;
  bool is_code = false;
  for (std::string line; std::getline(lines, line);) {
    const bool is_macro = line.starts_with(".");
    broken += is_macro || is_tag || is_code ? line + "\n" : broken_line(line);
    is_tag = line == ".TP";
    if (is_macro) is_code = line == ".nf" || (is_code && line != ".fi");
  }
  return broken;
}

/// Documents of Markdown as pages, line by line.
class DocumentPage {
 public:
  std::string text_of(const std::string& markdown) {
    std::istringstream lines(markdown);
    for (std::string line; std::getline(lines, line);) take(line);
    if (is_code_) page_ += ".fi\n";
    return page_;
  }

 private:
  void take(const std::string& line) {
    if (line.starts_with("```")) {
      is_code_ = !is_code_;
      page_ += !is_code_ ? ".fi\n" : is_first_ ? ".nf\n" : ".PP\n.nf\n";
      is_first_ = false;
    } else if (is_code_) {
      page_ += escaped(line) + "\n";
    } else if (line.starts_with("# ")) {
      page_ += ".SH DESCRIPTION\n";
      is_first_ = true;
    } else if (line.starts_with("## ") || line.starts_with("### ")) {
      page_ += ".SH " + upper(inline_text(line.substr(line.find(' ') + 1))) + "\n";
      is_first_ = true;
      header_.clear();
    } else if (line.starts_with("|")) {
      take_row(line);
    } else if (line.starts_with("- ")) {
      page_ += ".IP \\(bu 2\n" + inline_text(line.substr(2)) + "\n";
      needs_break_ = is_first_ = false;
    } else if (line.empty()) {
      needs_break_ = true;
      header_.clear();
    } else {
      if (needs_break_ && !is_first_) page_ += ".PP\n";
      needs_break_ = is_first_ = false;
      const std::size_t begin = line.find_first_not_of(' ');
      page_ += inline_text(line.substr(begin == std::string::npos ? 0 : begin)) + "\n";
    }
  }

  void take_row(const std::string& line) {
    const std::vector<std::string> cells = cells_of(line);
    if (header_.empty()) {
      header_ = cells.empty() ? std::vector<std::string>{""} : cells;
      return;
    }
    if (line.find("|---") == 0 || cells.empty()) return;
    page_ += ".TP\n" + (cells[0].empty() ? std::string("\\&") : inline_text(cells[0])) + "\n";
    std::string rest;
    for (std::size_t i = 1; i < cells.size(); ++i) {
      if (cells[i].empty()) continue;
      const bool is_named = i < header_.size() && !header_[i].empty() && i + 1 < cells.size();
      rest += (rest.empty() ? "" : "; ") + (is_named ? header_[i] + ": " : std::string()) + cells[i];
    }
    page_ += rest.empty() ? "\\&\n" : inline_text(rest) + "\n";
    needs_break_ = true;
    is_first_ = false;
  }

  std::string page_;
  std::vector<std::string> header_;  ///< of the table being read
  bool is_code_ = false;
  bool needs_break_ = false;
  bool is_first_ = false;  ///< of a section: no break before it
};

}  // namespace

std::vector<const CLI::App*> verbs_of(const CLI::App& program) {
  std::vector<const CLI::App*> verbs;
  for (const CLI::App* verb : program.get_subcommands([](const CLI::App*) { return true; }))
    if (!verb->get_group().empty()) verbs.push_back(verb);
  return verbs;
}

std::vector<Example> examples_of(const std::string& verb, const std::string& markdown) {
  const std::string start = "stridor " + verb + " ";
  std::istringstream lines(markdown);
  std::vector<Example> examples;
  bool is_code = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) is_code = !is_code;
    if (!is_code || !line.starts_with(start)) continue;
    const std::size_t sign = line.find(" # ");
    Example one{line.substr(0, sign), sign == std::string::npos ? "" : line.substr(sign + 3)};
    one.command.erase(one.command.find_last_not_of(' ') + 1);
    examples.push_back(std::move(one));
  }
  return examples;
}

std::string manual_of_verb(const CLI::App& verb, const std::vector<std::string>& verbs,
                           const std::vector<Example>& examples) {
  const std::string name = "stridor-" + verb.get_name();
  std::string page = head(name, "1", summary_of(verb));
  page += ".SH SYNOPSIS\n" + bold("stridor " + verb.get_name());
  std::string positionals;
  std::string options;
  for (const CLI::Option* option : verb.get_options()) {
    if (option->get_positional()) {
      page += " \\fI" + escaped(value_name(*option)) + "\\fR";
      if (option->get_expected_max() > 1) page += " ...";
      positionals += entry_of(*option);
    } else {
      options += entry_of(*option);
    }
  }
  page += " [\\fIoptions\\fR]\n";
  if (!positionals.empty()) page += ".SH ARGUMENTS\n" + positionals;
  page += ".SH OPTIONS\n" + options;
  if (!examples.empty()) page += ".SH EXAMPLES\n";
  for (const Example& one : examples) {
    if (&one != &examples.front()) page += ".PP\n";
    if (!one.says.empty()) page += inline_text(sentence_of(one.says)) + ":\n.PP\n";
    page += ".nf\n" + escaped(one.command) + "\n.fi\n";
  }
  page += exit_codes;
  page += ".SH SEE ALSO\n" + bold("stridor") + "(1), " + bold("stridor-scene") + "(5), " +
          bold("stridor-files") + "(5)";
  for (const std::string& other : verbs)
    if (other != verb.get_name()) page += ",\n" + bold("stridor-" + other) + "(1)";
  return in_short_lines(page + "\n");
}

std::string manual_of_program(const CLI::App& program) {
  std::string page = head("stridor", "1", "friction-induced vibration of sliding flexible bodies");
  page += ".SH SYNOPSIS\n" + bold("stridor") + " \\fIverb\\fR [\\fIarguments\\fR] [\\fIoptions\\fR]\n";
  page +=
      ".SH DESCRIPTION\nComputes when and why bodies that slide on each other squeal: transients, sliding "
      "equilibria, complex eigenvalues and their loci, stability maps, limit cycles and frequency "
      "responses of the bodies, contacts and drives that a scene describes.\n.PP\nOptions that all verbs "
      "have: " +
      bold("--help") + "; " + bold("--json") +
      " prints one JSON object on the standard output, of a failure {\"errors\": [...]}.\n.SH VERBS\n";
  for (const CLI::App* verb : verbs_of(program))
    page += ".TP\n" + bold(verb->get_name()) + "\n" + escaped(verb->get_description()) + ".\n";
  page += exit_codes;
  page += ".SH ENVIRONMENT\n.TP\n" + bold("STRIDOR_PROGRAM") +
          "\nThe program that the Python package calls.\n.TP\n" + bold("STRIDOR_KERNELS") +
          "\n\\fBportable\\fR or \\fBv3\\fR: kernels of an older processor than the present one.\n";
  page += ".SH SEE ALSO\n" + bold("stridor-scene") + "(5), " + bold("stridor-files") + "(5)\n";
  return in_short_lines(page);
}

std::string manual_of_document(const std::string& name, const std::string& section,
                               const std::string& summary, const std::string& markdown) {
  // How a page was made is for those who keep it.
  static const std::regex generated(R"(Generated by[^\n]*\n([^\n]+\n)*\n)");
  const std::string text = std::regex_replace(markdown, generated, "");
  return in_short_lines(head(name, section, summary) + DocumentPage().text_of(text) +
                        ".SH SEE ALSO\n" + bold("stridor") + "(1)\n");
}

}  // namespace stridor
