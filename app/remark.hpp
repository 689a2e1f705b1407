// Remarks on stderr, apart from the results.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace stridor {

/// Prints on stderr. Where nobody listens any more (fmt::print throws there) the work goes on: what
/// counts are results and exit code.
template <class... Values>
void print_remark(fmt::format_string<Values...> format, Values&&... values) {
  std::fputs(fmt::format(format, std::forward<Values>(values)...).c_str(), stderr);
}

}  // namespace stridor
