#include "app/terminal/value_names.hpp"

#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace stridor {
namespace {

using Names = std::map<std::string, const char*>;

/// By the name of the option. A QUANTITY is a number, or a text with a number and a unit.
const Names names{{"scene", "FILE"},
                  {"file", "FILE"},
                  {"files", "FILE"},
                  {"output", "FILE"},
                  {"o", "FILE"},
                  {"resume", "FILE"},
                  {"predict", "FILE"},
                  {"compare", "FILE"},
                  {"uff", "FILE"},
                  {"data", "FILE"},
                  {"table", "FILE"},
                  {"master-curve", "FILE"},
                  {"figure", "FILE"},
                  {"history", "FILE"},
                  {"pressure", "FILE"},
                  {"edges", "FILE"},
                  {"vtu", "FOLDER"},
                  {"shapes", "FOLDER"},
                  {"figures", "FOLDER"},
                  {"folder", "FOLDER"},
                  {"documents", "FOLDER"},
                  {"vtu-interval", "QUANTITY"},
                  {"length", "QUANTITY"},
                  {"overlap", "NUMBER"},
                  {"max-frequency", "QUANTITY"},
                  {"reference", "QUANTITY"},
                  {"range", "QUANTITY"},
                  {"band", "LOWER,UPPER"},
                  {"from", "QUANTITY"},
                  {"to", "QUANTITY"},
                  {"until", "QUANTITY"},
                  {"retain", "QUANTITY,..."},
                  {"frequencies", "QUANTITY,..."},
                  {"below", "QUANTITY"},
                  {"at", "QUANTITY"},
                  {"budget", "SIZE"},
                  {"tune", "NUMBER"},
                  {"channel", "CHANNEL"},
                  {"parameter", "KEY"},
                  {"contact", "NAME"},
                  {"input", "BODY.POINT.AXIS"},
                  {"node", "NUMBER=BODY.POINT"},
                  {"unknowns", "WORD"},
                  {"length-unit", "UNIT"},
                  {"force-unit", "UNIT"},
                  {"time-unit", "UNIT"},
                  {"progress", "WORD"},
                  {"kind", "WORD"},
                  {"window", "WORD"},
                  {"scale", "WORD"},
                  {"x-scale", "WORD"},
                  {"y-scale", "WORD"},
                  {"norm", "WORD"},
                  {"assumptions", "WORD,..."},
                  {"about", "WORD"},
                  {"method", "WORD"}};

/// Those that mean something else in one verb.
const std::map<std::pair<std::string, std::string>, const char*> of_verbs{
    {{"compare", "output"}, "FOLDER"},
    {{"precision", "output"}, "FOLDER"},
    {{"frf", "output"}, "BODY.POINT.AXIS.MOTION"}};

std::string name_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_single_name();
  return option.get_lnames().empty() ? option.get_snames().front() : option.get_lnames().front();
}

}  // namespace

void name_values(CLI::App& program) {
  for (CLI::App* verb : program.get_subcommands([](CLI::App*) { return true; })) {
    for (CLI::Option* option : verb->get_options([](CLI::Option*) { return true; })) {
      // Numbers, and words with a name already, say themselves what they are.
      if (!option->get_type_name().starts_with("TEXT")) continue;
      const std::string name = name_of(*option);
      const auto own = of_verbs.find({verb->get_name(), name});
      const auto shared = names.find(name);
      if (own == of_verbs.end() && shared == names.end())
        throw std::logic_error("the value of --" + name + " of " + verb->get_name() +
                               " has no name in value_names.cpp");
      option->type_name(own != of_verbs.end() ? own->second : shared->second);
    }
  }
}

}  // namespace stridor
