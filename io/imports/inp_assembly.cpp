#include "io/imports/inp_assembly.hpp"

#include <fmt/format.h>

namespace stridor {
namespace {

constexpr const char* one_body =
    "expected one part with one instance at its place: export every body by itself";

std::string value_or_empty(const InpKeyword& keyword, std::string_view parameter) {
  const InpParameter* found = keyword.find(parameter);
  return found == nullptr ? "" : found->value;
}

}  // namespace

void InpAssembly::enter_part(const InpKeyword& keyword) {
  const std::string name = value_or_empty(keyword, "NAME");
  if (name.empty()) refuse_at(keyword.place, "*PART without NAME=");
  if (!part_.empty()) {
    refuse_at(keyword.place, fmt::format("a second part, '{}' beside '{}'; {}", shown(name),
                                         shown(part_), one_body));
  }
  part_ = name;
}

void InpAssembly::enter_instance(const InpKeyword& keyword) {
  const std::string name = value_or_empty(keyword, "NAME");
  const std::string part = value_or_empty(keyword, "PART");
  if (name.empty()) {
    refuse_at(keyword.place,
              fmt::format("*INSTANCE without NAME=, as for results of another run; {}", one_body));
  }
  if (!instance_.empty()) {
    refuse_at(keyword.place, fmt::format("a second instance, '{}' beside '{}'; {}", shown(name),
                                         shown(instance_), one_body));
  }
  if (lower_case_of(part) != lower_case_of(part_)) {
    refuse_at(keyword.place,
              fmt::format("an instance of the part '{}', which is not defined above", shown(part)));
  }
  instance_ = name;
  is_in_instance_ = true;
}

bool InpAssembly::enter(const InpKeyword& keyword) {
  if (keyword.name == "PART") {
    enter_part(keyword);
  } else if (keyword.name == "ASSEMBLY") {
    is_in_assembly_ = true;
  } else if (keyword.name == "INSTANCE") {
    enter_instance(keyword);
  } else if (keyword.name == "END INSTANCE") {
    is_in_instance_ = false;
  } else if (keyword.name == "END ASSEMBLY") {
    is_in_assembly_ = false;
  } else {
    return keyword.name == "END PART";
  }
  return true;
}

void InpAssembly::check_position(InpFields& fields, const TextPlace& line) const {
  bool is_first = true;
  bool is_moved = false;
  while (const auto field = fields.next()) {
    const auto value = field->text.empty() ? std::optional(0.0) : real_in(field->text);
    if (!value) {
      refuse_at(field->place,
                fmt::format("expected a number of the position of the instance, got '{}'",
                            shown(field->text)));
    }
    is_moved = is_moved || *value != 0.0;
    is_first = false;
  }
  if (is_moved && !is_first) {
    refuse_at(line,
              fmt::format("the instance '{}' is moved or turned; {}", shown(instance_), one_body));
  }
}

void InpAssembly::check_instance(const InpKeyword& keyword) const {
  const InpParameter* found = keyword.find("INSTANCE");
  if (found == nullptr || lower_case_of(found->value) == lower_case_of(instance())) return;
  refuse_at(keyword.place,
            fmt::format("the instance '{}' is not defined above", shown(found->value)));
}

InpAssembly::Name InpAssembly::resolved(const InpField& field) const {
  const std::size_t size = instance().size();
  if (size > 0 && field.text.size() > size && field.text[size] == '.' &&
      lower_case_of(field.text.substr(0, size)) == lower_case_of(instance()))
    return {field.text.substr(size + 1), true};
  return {field.text, false};
}

}  // namespace stridor
