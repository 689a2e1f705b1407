#include "app/results/burst_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace stridor {

std::string burst_text(const Json& burst) {
  const auto value = [&](const char* name) {
    const Json& number = burst.at(name);
    return number.is_null() ? std::numeric_limits<double>::quiet_NaN() : number.get<double>();
  };
  const Json harmonic = burst.value("harmonic", Json(nullptr));
  return fmt::format("{:.3f} to {:.3f} s, {:.0f} Hz{}, peak {:.4g} m/s^2, gain {:.2f}",
                     value("start"), value("end"), value("frequency"),
                     harmonic.is_null()
                         ? ""
                         : fmt::format(" ({} times that of burst {})", harmonic["order"].get<int>(),
                                       harmonic["of"].get<int>()),
                     value("peak"), value("gain"));
}

std::string lasting_tone_text(const Json& tone) {
  const auto value = [&](const char* name) { return tone.at(name).get<double>(); };
  return fmt::format("{:.0f} Hz, {:.4g} m/s^2 r.m.s. throughout, {:.0f} % of the power in the band",
                     value("frequency"), value("rms"), 100.0 * value("share"));
}

std::vector<std::pair<std::string, std::string>> burst_lines(const Json& bursts) {
  constexpr std::size_t most_listed = 20;
  std::vector<std::size_t> listed(bursts.size());
  std::iota(listed.begin(), listed.end(), std::size_t{0});
  const auto peak_of = [&](std::size_t i) {
    const Json& peak = bursts[i].at("peak");
    return peak.is_null() ? std::numeric_limits<double>::infinity() : peak.get<double>();
  };
  double loudest_left = 0.0;
  if (listed.size() > most_listed) {
    std::stable_sort(listed.begin(), listed.end(),
                     [&](std::size_t a, std::size_t b) { return peak_of(a) > peak_of(b); });
    loudest_left = peak_of(listed[most_listed]);
    listed.resize(most_listed);
    std::sort(listed.begin(), listed.end());
  }
  std::vector<std::pair<std::string, std::string>> lines;
  // Harmonics name their bursts by number.
  const bool are_all = listed.size() == bursts.size();
  for (const std::size_t i : listed)
    lines.emplace_back(are_all ? "burst" : fmt::format("burst {}", i + 1), burst_text(bursts[i]));
  if (!are_all)
    lines.emplace_back("more bursts",
                       fmt::format("{}, none with a peak above {:.4g} m/s^2 (--json lists all)",
                                   bursts.size() - listed.size(), loudest_left));
  return lines;
}

std::string doubtful_text(const Json& bursts, const Json& tone, const Json& trusted) {
  if (trusted.is_null()) return {};
  const auto is_above = [&](const Json& sound) {
    const Json& frequency = sound.at("frequency");
    return frequency.is_number() && frequency.get<double>() > trusted.get<double>();
  };
  const auto num_bursts =
      bursts.is_array() ? std::count_if(bursts.begin(), bursts.end(), is_above) : 0;
  const bool has_tone = tone.is_object() && is_above(tone);
  if (num_bursts == 0 && !has_tone) return {};
  std::string which = has_tone ? "the lasting tone" : "";
  if (num_bursts > 0)
    which += fmt::format("{}{} {}", has_tone ? " and " : "", num_bursts,
                         num_bursts == 1 ? "burst" : "bursts");
  return fmt::format(
      "{} above {:.6g} Hz, more than the bodies resolve (docs/theory/07_stability.md): keep more "
      "modes",
      which, trusted.get<double>());
}

}  // namespace stridor
