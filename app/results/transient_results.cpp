#include "app/results/transient_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "app/results/burst_text.hpp"
#include "solvers/integrators/make_propagator.hpp"
#include "solvers/integrators/retained_modes.hpp"

namespace stridor {
namespace {

Json force_json(const std::optional<ContactStatistics>& statistics) {
  if (!statistics) return {{"min", nullptr}, {"max", nullptr}};
  return {{"min", number(statistics->force_min)}, {"max", number(statistics->force_max)}};
}

Json fraction(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? Json(static_cast<double>(part) / static_cast<double>(whole)) : Json(nullptr);
}

Json contact_json(const Simulation& simulation, const System& system,
                  const MeasuredContacts& measured) {
  Json results = Json::object();
  ContactStatistics sum;
  Json contacts = Json::object();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const ContactStatistics one = measured[i].value_or(ContactStatistics{});
    sum.steps += one.steps;
    sum.sticking += one.sticking;
    sum.open += one.open;
    contacts[system.contacts[i].name] = {
        {"contact_force", force_json(measured[i])},
        {"violations", simulation.violations(static_cast<int>(i)).total()},
        {"stick_fraction", fraction(one.sticking, one.steps)},
        {"free_fraction", fraction(one.open, one.steps)}};
  }
  if (measured.size() == 1) {
    results["contact_force"] = force_json(measured[0]);
  } else {
    results["contacts"] = contacts;
  }
  results["stick_fraction"] = fraction(sum.sticking, sum.steps);
  results["free_fraction"] = fraction(sum.open, sum.steps);
  return results;
}

/// Numbers of retained modes and of modes truncated to their residual flexibility, for every body.
Json modes_json(const System& system, double highest) {
  Json bodies = Json::object();
  for (const SystemBody& body : system.bodies) {
    const Eigen::Index moving = (body.modal.omega.array() <= highest).count();
    bodies[body.name] = {{"moving", moving}, {"residual", body.modal.size() - moving}};
  }
  return bodies;
}

/// The rows that the contacts of a system follow, and the properties that none of them needs.
struct ContactWork {
  /// Rows of the bodies that contacts follow at a time, and all on which they might be.
  std::vector<Eigen::Index> followed, touchable;
  bool has_friction = false;
  bool slides_only = true;
  bool has_fixed_normal = true;
};

ContactWork contact_work(const System& system) {
  ContactWork work;
  work.followed.assign(system.bodies.size(), 0);
  work.touchable.assign(system.bodies.size(), 0);
  for (const ContactPoint& contact : system.contacts) {
    const auto slave = static_cast<std::size_t>(contact.slave_body);
    const auto master = static_cast<std::size_t>(system.master_of(contact));
    if (contact.face || contact.space) {
      const auto num_slave = static_cast<Eigen::Index>(contact.num_slave_ports());
      const auto on_face = static_cast<Eigen::Index>(system.num_master_ports(contact));
      work.followed[slave] += num_slave;
      work.touchable[slave] += num_slave;
      work.followed[master] += on_face;
      work.touchable[master] += on_face;
      work.has_friction |= !contact.friction.is_frictionless();
      work.slides_only = work.has_fixed_normal = false;
      continue;
    }
    const MasterSurface& surface = system.surface_of(contact);
    work.followed[slave] += 2;
    work.touchable[slave] += 2;
    work.followed[master] += 2 * surface.stencil_size();
    work.touchable[master] += 2 * static_cast<Eigen::Index>(surface.positions.size());
    work.has_friction |= contact.substrate || !contact.friction.is_frictionless();
    work.slides_only &= contact.unilateral_from() == std::numeric_limits<double>::infinity();
    work.has_fixed_normal &= contact.assumption == ContactAssumption::subs_a ||
                             contact.assumption == ContactAssumption::subs_c;
  }
  return work;
}

/// Computations omitted from every step, and the cost avoided by truncated modes and omitted rows.
/// @param highest frequency of a retained mode, rad/s
Json left_out_json(const System& system, double highest, bool has_ledger) {
  const ContactWork work = contact_work(system);
  Eigen::Index moving = 0, modes = 0, rows = 0, all_rows = 0, done = 0, all = 0;
  double damping_until = 0.0;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const ModalBody& modal = system.bodies[b].modal;
    const Eigen::Index of_body = (modal.omega.array() <= highest).count();
    moving += of_body;
    modes += modal.size();
    if (modal.size() > 0) {
      rows += work.followed[b];
      all_rows += work.touchable[b];
    }
    // Correct and predict a mode: 4, and a force and a displacement at every row.
    done += of_body * (4 + 2 * work.followed[b]);
    all += modal.size() * (4 + 2 * work.touchable[b]);
    damping_until = std::max(damping_until, modal.damping.constant_from());
  }
  Json rest = Json::array();
  if (work.slides_only) rest.push_back("stick, slip and lift-off");
  if (!work.has_friction) rest.push_back("friction");
  if (work.has_fixed_normal) rest.push_back("rotation of the normal");
  if (!has_ledger) rest.push_back("energy ledger");
  const auto push_changes = [&](const char* of, double until) {
    rest.push_back(until > 0.0 ? fmt::format("changes of {} from {:.4g} s on", of, until)
                               : fmt::format("changes of {}", of));
  };
  push_changes("load and drive", system.drives_constant_from());
  push_changes("damping", damping_until);
  return {{"modes", {{"left_out", modes - moving}, {"of", modes}}},
          {"contact_rows", {{"left_out", all_rows - rows}, {"of", all_rows}}},
          {"multiplications", {{"done", done}, {"of", all}}},
          {"rest", rest}};
}

Json violations_json(const Simulation& simulation) {
  ViolationCount sum;
  for (int i = 0; i < simulation.num_contacts(); ++i) {
    const ViolationCount& one = simulation.violations(i);
    sum.negative_force += one.negative_force;
    sum.reversed_sliding += one.reversed_sliding;
    sum.before_armed += one.before_armed;
    sum.last_time = std::max(sum.last_time, one.last_time);
  }
  return {{"violations", sum.total()},
          {"violation_details",
           {{"negative_force", sum.negative_force},
            {"reversed_sliding", sum.reversed_sliding},
            {"before_armed", sum.before_armed},
            {"last_time", sum.total() > 0 ? number(sum.last_time) : Json(nullptr)}}}};
}

/// Energy that contacts have given to the bodies, which none can.
Json contact_gain_json(const EnergyLedger* energy) {
  if (energy == nullptr) return nullptr;
  const ContactGain& gain = energy->contact_gain();
  const double turned_over = energy->turned_over();
  return {{"energy", number(gain.energy)},
          {"share", number(turned_over > 0.0 ? gain.energy / turned_over : 0.0)},
          {"last_time", gain.energy > 0.0 ? number(gain.last_time) : Json(nullptr)},
          {"violated", energy->contacts_feed()}};
}

}  // namespace

Json harmonic_json(const Burst& burst) {
  if (!burst.harmonic) return nullptr;
  return {{"of", burst.harmonic->of + 1}, {"order", burst.harmonic->order}};
}

Json bursts_json(const std::vector<Burst>& bursts) {
  Json list = Json::array();
  for (const Burst& burst : bursts) {
    list.push_back({{"start", burst.start},
                    {"end", burst.end},
                    {"frequency", burst.frequency},
                    {"peak", burst.peak},
                    {"gain", burst.gain},
                    {"start_frequency", burst.start_frequency},
                    {"end_frequency", burst.end_frequency},
                    {"harmonic", harmonic_json(burst)}});
  }
  return list;
}

Json acceleration_json(const std::optional<AccelerationSummary>& acceleration) {
  Json results = {
      {"free_end_acceleration", nullptr}, {"bursts", nullptr}, {"lasting_tone", nullptr}};
  if (!acceleration) return results;
  results["free_end_acceleration"] = {{"peak", number(acceleration->peak)},
                                      {"rms", number(acceleration->rms)},
                                      {"channel", acceleration->channel}};
  if (acceleration->bursts) results["bursts"] = bursts_json(*acceleration->bursts);
  if (const auto& tone = acceleration->lasting)
    results["lasting_tone"] = {
        {"frequency", tone->frequency}, {"rms", tone->rms}, {"share", tone->share}};
  return results;
}

Json step_limit_json(const System& system, const TimeParameters& time) {
  return number(step_limit(system, time).step);
}

MarchPlan measured_plan(const Scene& scene, std::int64_t last_step) {
  const double step = scene.time->step;
  const auto to_step = [&](double time) {
    return static_cast<std::int64_t>(std::ceil(time / step - 1e-6));
  };
  const auto end_step = static_cast<std::int64_t>(std::llround(scene.time->end / step));
  MarchPlan plan;
  plan.last_step = last_step;
  plan.measure_from = to_step(scene.measure.from);
  plan.measure_to = std::min(end_step, scene.measure.to ? to_step(*scene.measure.to) : end_step);
  return plan;
}

Json transient_results(const Simulation& simulation, const System& system,
                       const TimeParameters& time, MarchEnd end, const MeasuredContacts& measured,
                       const std::optional<AccelerationSummary>& acceleration) {
  Json results = {{"status", end == MarchEnd::finished  ? "done"
                             : end == MarchEnd::stopped ? "stopped"
                                                        : "failed"}};
  const double highest = retained_frequency(system, time);
  results["modes"] = modes_json(system, highest);
  results["left_out"] = left_out_json(system, highest, simulation.energy() != nullptr);
  results.update(contact_json(simulation, system, measured));
  results.update(acceleration_json(acceleration));
  results.update(violations_json(simulation));
  const EnergyLedger* energy = simulation.energy();
  results["energy_error"] = energy != nullptr ? number(energy->relative_error()) : Json(nullptr);
  results["contact_gain"] = contact_gain_json(energy);
  return results;
}

void print_bursts(const Json& results) {
  if (results["bursts"].is_null()) return;
  if (results["bursts"].empty()) fmt::print("{:<24}none\n", "bursts");
  for (const auto& [name, text] : burst_lines(results["bursts"]))
    fmt::print("{:<24}{}\n", name, text);
  const Json tone = results.value("lasting_tone", Json(nullptr));
  if (!tone.is_null()) fmt::print("{:<24}{}\n", "lasting tone", lasting_tone_text(tone));
  const std::string doubtful =
      doubtful_text(results["bursts"], tone, results.value("trusted_frequency", Json(nullptr)));
  if (!doubtful.empty()) fmt::print("{:<24}{}\n", "doubtful", doubtful);
}

}  // namespace stridor
