#include "core/suggestion.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace stridor {
namespace {

/// Lower case, and '-' for '_': neither is a difference worth counting.
std::string folded(const std::string& text) {
  std::string result = text;
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == '-') c = '_';
  }
  return result;
}

/// Insertions, deletions, replacements and swaps of neighbours that lead from a to b
/// (Damerau-Levenshtein, optimal string alignment). O(|a| |b|) time, O(|b|) memory.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> before_last(width), last(width), row(width);
  for (std::size_t j = 0; j < width; ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j < width; ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest(const std::string& written, const std::vector<std::string>& candidates) {
  // Words beyond this length are not misspelt keys, and the distance costs the product of the
  // lengths.
  constexpr std::size_t longest = 64;
  // One slip in three letters; short words need all but one of theirs right.
  const std::size_t allowed = (written.size() + 1) / 3;
  if (written.empty() || written.size() > longest) return {};

  const std::string word = folded(written);
  std::string best;
  std::size_t best_distance = allowed + 1;
  std::size_t best_same = word.size();  // more than any has that is too far away
  for (const std::string& candidate : candidates) {
    const std::string known = folded(candidate);
    const std::size_t distance = edit_distance(word, known);
    // Of equals the one that begins likewise: "xyx" is rather "xy" than "xx".
    const std::size_t same = static_cast<std::size_t>(
        std::mismatch(word.begin(), word.end(), known.begin(), known.end()).first - word.begin());
    if (distance < best_distance || (distance == best_distance && same > best_same)) {
      best = candidate;
      best_distance = distance;
      best_same = same;
    }
  }
  if (!best.empty() || written.size() < 3) return best;
  for (const std::string& candidate : candidates) {  // "coeff" for "coefficient"
    if (folded(candidate).starts_with(word)) return candidate;
  }
  return {};
}

std::string did_you_mean(const std::string& written, const std::vector<std::string>& candidates) {
  const std::string candidate = nearest(written, candidates);
  return candidate.empty() ? std::string() : ", did you mean '" + candidate + "'?";
}

}  // namespace stridor
