#include "app/runs/transient_report.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "app/results/transient_results.hpp"
#include "app/runs/cycle_motion.hpp"
#include "app/runs/heard_windows.hpp"

namespace stridor {
namespace {

/// Only where it is a violation.
void print_contact_gain(const Json& gain) {
  if (gain.is_null() || !gain["violated"].get<bool>()) return;
  fmt::print(
      "{:<24}contacts gave {:.4g} J to the bodies until {:.4g} s, {:.3g} of the energy "
      "exchanged; none can\n",
      "CONTACT WORK VIOLATED", gain["energy"].get<double>(), gain["last_time"].get<double>(),
      gain["share"].get<double>());
}

std::string result_text(const Json& value) {
  if (value.is_null()) return "-";
  return value.is_number() ? fmt::format("{:.5g}", value.get<double>()) : value.get<std::string>();
}

void print_acceleration(const Json& results) {
  const Json& acceleration = results["free_end_acceleration"];
  if (acceleration.is_null()) return;
  fmt::print("{:<24}peak {} m/s^2, r.m.s. {}{} m/s^2, of {}\n", "acceleration",
             result_text(acceleration["peak"]), results["bursts"].is_null() ? "" : "in band ",
             result_text(acceleration["rms"]), result_text(acceleration["channel"]));
}

void print_fractions(const Json& results) {
  const auto fraction_text = [&](const char* name) {
    return results[name].is_null() ? std::string("-")
                                   : fmt::format("{:.4g} %", 100.0 * results[name].get<double>());
  };
  fmt::print("{:<24}{} of the time, lifted off {}\n", "sticking", fraction_text("stick_fraction"),
             fraction_text("free_fraction"));
}

/// Work that the run left out.
void print_left_out(const Json& left_out) {
  const auto part = [](const Json& one) {
    return fmt::format("{} of {}", one["left_out"].get<std::int64_t>(),
                       one["of"].get<std::int64_t>());
  };
  fmt::print("{:<24}{} modes, {} rows under contacts: {} instead of {} multiplications a step\n",
             "left out", part(left_out["modes"]), part(left_out["contact_rows"]),
             left_out["multiplications"]["done"].get<std::int64_t>(),
             left_out["multiplications"]["of"].get<std::int64_t>());
  for (const Json& what : left_out["rest"]) fmt::print("{:<24}{}\n", "", what.get<std::string>());
}

void print_work(const Json& results) {
  const std::string limit =
      results["step_limit"].is_null()
          ? "no limit by the modes"
          : fmt::format("largest stable {:.4g} s", results["step_limit"].get<double>());
  fmt::print("{:<24}{} of {:g} s ({})\n", "steps", results["steps"].get<std::int64_t>(),
             results["step"].get<double>(), limit);
  for (const auto& [name, modes] : results["modes"].items()) {
    fmt::print("{:<23} {} moving, {} left to their static residual\n", "modes of " + name,
               modes["moving"].get<int>(), modes["residual"].get<int>());
  }
  print_left_out(results["left_out"]);
  const std::string step_time =
      results["step_ns"].is_null()
          ? ""
          : fmt::format(" ({:.0f} ns a step)", results["step_ns"].get<double>());
  fmt::print("{:<24}{:.3g} s stepping{}, {:.3g} s set-up, {:.3g} s output\n", "time taken",
             results["wall_s"].get<double>(), step_time, results["setup_s"].get<double>(),
             results["output_s"].get<double>());
}

void print_forces(const Json& results) {
  const auto print_force = [&](const std::string& name, const Json& force) {
    fmt::print("{:<23} {} to {} N\n", name, result_text(force["min"]), result_text(force["max"]));
  };
  if (results.contains("contact_force")) print_force("contact force", results["contact_force"]);
  if (!results.contains("contacts")) return;
  constexpr std::size_t most_listed = 20;
  const Json& contacts = results["contacts"];
  if (contacts.size() > most_listed) {
    // Where the largest force acts; --json has those of all.
    const Json* largest = nullptr;
    std::string name_of_largest;
    for (const auto& [name, contact] : contacts.items()) {
      const Json& force = contact["contact_force"];
      if (!force["max"].is_number()) continue;
      if (largest != nullptr && force["max"] <= (*largest)["max"]) continue;
      largest = &force;
      name_of_largest = name;
    }
    fmt::print("{:<23} of {} points", "contact force", contacts.size());
    if (largest != nullptr)
      fmt::print(", largest in {}: {} to {} N", name_of_largest, result_text((*largest)["min"]),
                 result_text((*largest)["max"]));
    fmt::print("\n");
    return;
  }
  for (const auto& [name, contact] : contacts.items())
    print_force("contact force, " + name, contact["contact_force"]);
}

void print_error(const Json& error) {
  if (error.is_null()) return;
  if (!error["failure"].is_null()) {
    fmt::print("{:<24}not estimated: {}\n", "error", error["failure"].get<std::string>());
    return;
  }
  fmt::print(
      "{:<24}{} of the envelope of the acceleration, {} of the acceleration, {} of the "
      "force: {} ({:.3g} s)\n",
      "error", result_text(error["envelope"]), result_text(error["acceleration"]),
      result_text(error["force"]), error["is"].get<std::string>(), error["wall_s"].get<double>());
}

}  // namespace

void print_cycles(const Json& results, const std::string& output) {
  const auto print = [](const char* name, const Json& value, const char* units) {
    const std::string number =
        value.is_null() ? "-" : fmt::format("{:.10g} {}", value.get<double>(), units);
    fmt::print("{:<24}{}\n", name, number);
  };
  fmt::print("{:<24}{}\n", "status", result_text(results["status"]));
  fmt::print("{:<24}{} ({:.3g} s)\n", "steps", results["steps"].get<std::int64_t>(),
             results["wall_s"].get<double>());
  print("period", results["period"], "s");
  print("x, r.m.s. about mean", results["x"]["rms"], "m");
  print("x, smallest", results["x"]["min"], "m");
  print("x, largest", results["x"]["max"], "m");
  fmt::print("{:<23} {} to {} N\n", "contact force", result_text(results["contact_force"]["min"]),
             result_text(results["contact_force"]["max"]));
  print_acceleration(results);
  print_bursts(results);
  print_heard_windows(results);
  print_fractions(results);
  print_law_exceeded(results);
  fmt::print("{:<24}{}\n", "run file", output);
}

void print_summary(const Json& results, const std::string& output) {
  fmt::print("{:<24}{}\n", "status", result_text(results["status"]));
  print_work(results);
  print_forces(results);
  if (!results["perturbation"].is_null()) {
    fmt::print("{:<24}{:.6g} Hz, growth {:.6g} 1/s\n", "perturbed mode",
               results["perturbation"]["frequency"].get<double>(),
               results["perturbation"]["growth"].get<double>());
  }
  print_acceleration(results);
  print_bursts(results);
  print_heard_windows(results);
  const bool has_contacts = !results.contains("contacts") || !results["contacts"].empty();
  if (has_contacts) {
    print_fractions(results);
    fmt::print("{:<24}{} steps ({} of them before the contacts were armed)\n", "sliding violated",
               results["violations"].get<std::int64_t>(),
               results["violation_details"]["before_armed"].get<std::int64_t>());
  }
  if (!results["energy_error"].is_null()) {
    fmt::print("{:<24}largest error {:.2g} of the energy exchanged\n", "energy balance",
               results["energy_error"].get<double>());
  }
  print_contact_gain(results["contact_gain"]);
  print_error(results["error"]);
  fmt::print("{:<24}{}\n", "run file", output);
}

}  // namespace stridor
