// Remarks on stderr, apart from the results.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace stridor {

/// Prints on stderr. If stderr is closed (fmt::print throws then) the work continues: results and
/// exit code matter.
template <class... Values>
void print_remark(fmt::format_string<Values...> format, Values&&... values) {
  std::fputs(fmt::format(format, std::forward<Values>(values)...).c_str(), stderr);
}

}  // namespace stridor
