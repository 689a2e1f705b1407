// Manual pages in the language of man(7).
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace stridor {

/// A command that a document shows, and what is said of it behind.
struct Example {
  std::string command;
  std::string says;
};

/// The commands of one verb in a document of Markdown: lines "stridor VERB ...   # what it does" of
/// its blocks of code.
std::vector<Example> examples_of(const std::string& verb, const std::string& markdown);

/// A page of one verb: synopsis, what it does, every option, examples, exit codes, other pages.
/// @param verbs names of all verbs, for references
std::string manual_of_verb(const CLI::App& verb, const std::vector<std::string>& verbs,
                           const std::vector<Example>& examples);

/// The page of the program: its verbs.
std::string manual_of_program(const CLI::App& program);

/// A page made of a document in Markdown: headings, paragraphs, tables, lists, code.
/// @param name    of the page, "stridor-scene"
/// @param section of the manual, "5"
/// @param summary one line, for apropos
std::string manual_of_document(const std::string& name, const std::string& section,
                               const std::string& summary, const std::string& markdown);

/// The verbs that users see, in the order in which they were declared.
std::vector<const CLI::App*> verbs_of(const CLI::App& program);

}  // namespace stridor
