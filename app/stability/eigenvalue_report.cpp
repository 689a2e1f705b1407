#include "app/stability/eigenvalue_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/stability/lowest_eigenvalues.hpp"
#include "core/errors.hpp"

namespace stridor {

std::size_t chosen_mode(const std::vector<Eigenvalue>& eigenvalues, std::size_t num_real,
                        const std::optional<int>& mode) {
  const std::size_t num_modes = eigenvalues.size() - num_real;
  if (num_modes == 0)
    throw ConfigError(Refusal::wrong_value, "--mode", "there is no eigenvalue with a frequency");
  if (mode) {
    const auto number = static_cast<std::size_t>(*mode);
    if (number > num_modes) {
      throw ConfigError(
          Refusal::wrong_value, "--mode",
          fmt::format("there are {} modes, got {}; raise --count", num_modes, number));
    }
    return num_real + number - 1;
  }
  const auto fastest = std::max_element(
      eigenvalues.begin() + static_cast<std::ptrdiff_t>(num_real), eigenvalues.end(),
      [](const Eigenvalue& a, const Eigenvalue& b) { return a.growth() < b.growth(); });
  return static_cast<std::size_t>(fastest - eigenvalues.begin());
}

std::size_t num_real_of(const std::vector<Eigenvalue>& eigenvalues) {
  return static_cast<std::size_t>(
      std::count_if(eigenvalues.begin(), eigenvalues.end(),
                    [](const Eigenvalue& one) { return one.s.imag() == 0.0; }));
}

namespace {

constexpr double largest_residual = 1e-6;

const char* growth_text(const Eigenvalue& one, bool is_real) {
  if (!is_growing(one)) return "";
  return is_real ? "  unstable, without oscillation" : "  unstable";
}

const char* doubt_text(const Eigenvalue& one, double trusted) {
  if (is_doubtful(one)) return "  (not to be trusted)";
  return is_resolved(one.s, trusted) ? "" : "  (above what the reduction resolves)";
}

}  // namespace

Json eigenvalues_json(const std::vector<Eigenvalue>& eigenvalues) {
  Json list = Json::array();
  for (const Eigenvalue& one : eigenvalues) list.push_back({one.s.real(), one.s.imag()});
  return list;
}

void print_eigenvalues(const std::vector<Eigenvalue>& eigenvalues, double trusted) {
  fmt::print("{:>4}  {:>14}  {:>12}  {:>13}\n", "mode", "frequency (Hz)", "growth (1/s)",
             "damping ratio");
  int mode = 0;
  for (const Eigenvalue& one : eigenvalues) {
    const bool is_real = one.s.imag() == 0.0;
    const double ratio = std::abs(one.s) > 0.0 ? -one.growth() / std::abs(one.s) : 0.0;
    fmt::print("{:>4}  {:>14.3f}  {:>12.4f}  {:>13.6f}{}{}\n",
               is_real ? std::string("-") : std::to_string(++mode), one.frequency(), one.growth(),
               ratio, growth_text(one, is_real), doubt_text(one, trusted));
  }
  const auto num_doubtful = std::count_if(eigenvalues.begin(), eigenvalues.end(), is_doubtful);
  if (num_doubtful > 0)
    fmt::print(
        "{} of these eigenvalues cannot be trusted: they leave more of the equations of motion "
        "than "
        "{:g} of their terms\n",
        num_doubtful, largest_residual);
}

bool is_doubtful(const Eigenvalue& eigenvalue) {
  return !(eigenvalue.residual <= largest_residual);
}

Json doubtful_json(const std::vector<Eigenvalue>& eigenvalues) {
  Json places = Json::array();
  for (std::size_t i = 0; i < eigenvalues.size(); ++i)
    if (is_doubtful(eigenvalues[i])) places.push_back(i);
  return places;
}

bool is_resolved(std::complex<double> s, double trusted) {
  const double rate = s.imag() == 0.0 ? std::abs(s) : s.imag();
  return rate <= 2.0 * std::numbers::pi * trusted;
}

Json quotients_json(const ModeQuotients& seen) {
  return {{"damping", seen.damping},     {"gyroscopic", seen.gyroscopic},
          {"stiffness", seen.stiffness}, {"circulatory", seen.circulatory},
          {"margin", seen.margin()},     {"suffices", seen.damping > 0.0 && seen.margin() > 0.0},
          {"residual", seen.residual}};
}

void print_quotients(const Json& seen) {
  const auto value = [](const Json& object, const char* key) { return object[key].get<double>(); };
  fmt::print(
      "  sees damping d = {:.4g} 1/s, gyroscopic g = {:.4g} 1/s, stiffness k = {:.6g} 1/s^2, "
      "circulatory n = {:.4g} 1/s^2\n",
      value(seen, "damping"), value(seen, "gyroscopic"), value(seen, "stiffness"),
      value(seen, "circulatory"));
  fmt::print("  d > 0 and k d^2 + n d g - n^2 > 0 would suffice for decay; the latter is {:.4g}\n",
             value(seen, "margin"));
}

}  // namespace stridor
