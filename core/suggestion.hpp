// "Did you mean …?"
#pragma once

#include <string>
#include <vector>

namespace stridor {

/// The candidate nearest to the word written (edit distance, case ignored), or "" where none is
/// near enough to be a misspelling of it.
std::string nearest(const std::string& written, const std::vector<std::string>& candidates);

/// ", did you mean 'x'?" or "" where nothing is near.
std::string did_you_mean(const std::string& written, const std::vector<std::string>& candidates);

}  // namespace stridor
