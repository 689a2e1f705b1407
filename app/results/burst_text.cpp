#include "app/results/burst_text.hpp"

#include <fmt/format.h>

#include <limits>

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

}  // namespace stridor
