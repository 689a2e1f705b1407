// A universal file as one text.
#pragma once

#include <string>
#include <string_view>

#include "io/results/uff_writer.hpp"

namespace stridor::test {

inline std::string uff_text(const UffContents& contents, const std::string& key,
                            UffNumbers numbers = {}) {
  std::string text;
  write_uff(
      contents, key, [&](std::string_view piece) { text += piece; }, numbers);
  return text;
}

}  // namespace stridor::test
