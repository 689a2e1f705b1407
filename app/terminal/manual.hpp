// Manual pages in the language of man(7).
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace stridor {

/// A page of one verb: synopsis, what it does, every option, exit codes, other pages.
/// @param verbs names of all verbs, for references
std::string manual_of_verb(const CLI::App& verb, const std::vector<std::string>& verbs);

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
