// Cost of a step: against the number of modes, contacts, master nodes, batches and threads.
//
//   build/release/bench/step_cost [ROUNDS]
//
// Exact propagation of the main scene, set going within 0.1 ms. Nanoseconds of processor time
// per step, the least over ROUNDS (15) of interleaved stretches.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "analysis/precision_study.hpp"
#include "bench/processor_clock.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/batch.hpp"
#include "solvers/transient/simulation.hpp"

using namespace stridor;
using namespace stridor::bench;

namespace {

constexpr std::int64_t stretch = 4'000;  ///< steps
constexpr double retained = 50e3;        ///< Hz
constexpr double step = 2.5e-6;          ///< s, with these modes

LoadedScene bench_scene(std::vector<std::string> sets = {}) {
  // A short ramp and schedule, so that the steps are those that most of a run is made of.
  for (const char* set :
       {"drive.ramp=1e-4", "contact.armed_from=1e3", "substructures.oblique.damping.hold=1e-5",
        "substructures.oblique.damping.fade=1e-5"})
    sets.emplace_back(set);
  return load_scene(STRIDOR_SOURCE_DIR "/scenes/beam_on_beam.yaml", sets);
}

TimeParameters exact(double step_size, std::optional<double> frequency) {
  TimeParameters time;
  time.integrator = Integrator::exact;
  time.step = step_size;
  if (frequency) time.retain = RetainParameters{*frequency, {}};
  return time;
}

void march(Simulation& simulation, std::int64_t steps) {
  if (simulation.step_until(simulation.step_index() + steps) != StepOutcome::done)
    throw std::runtime_error(simulation.failure());
}

/// One line of a table.
struct Case {
  Case(std::string its_label, const System& system, const TimeParameters& time)
      : label(std::move(its_label)),
        modes(num_moving_modes(system, time)),
        simulation(system, time) {
    march(simulation, 1000);  // past the start
  }
  std::string label;
  int modes;
  Simulation simulation;
  double least = std::numeric_limits<double>::infinity();  ///< s per step
};

void measure(std::vector<Case>& cases, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    for (Case& one : cases) {
      const double start = processor_seconds();
      march(one.simulation, stretch);
      one.least = std::min(one.least, (processor_seconds() - start) / static_cast<double>(stretch));
    }
  }
}

void print(const char* what, const std::vector<Case>& cases) {
  fmt::print("\n| {} | moving modes | ns per step |\n|---|---|---|\n", what);
  for (const Case& one : cases)
    fmt::print("| {} | {} | {:.0f} |\n", one.label, one.modes, one.least * 1e9);
}

void against_modes(const System& system, int rounds) {
  std::vector<Case> cases;
  // Small enough a step to resolve every mode.
  constexpr double fine = 2.5e-7;
  for (const double frequency : {5e3, 10e3, 20e3, 50e3, 100e3, 200e3, 400e3})
    cases.emplace_back(fmt::format("{:g} kHz", frequency * 1e-3), system, exact(fine, frequency));
  cases.emplace_back("all", system, exact(fine, {}));
  measure(cases, rounds);
  print("modes up to", cases);
  double modes = 0.0, time = 0.0, square = 0.0, product = 0.0;
  for (const Case& one : cases) {
    const auto n = static_cast<double>(cases.size());
    modes += one.modes / n;
    time += one.least / n;
    square += one.modes * one.modes / n;
    product += one.modes * one.least / n;
  }
  const double slope = (product - modes * time) / (square - modes * modes);
  fmt::print("least squares: {:.0f} ns and {:.2f} ns per mode\n", (time - slope * modes) * 1e9,
             slope * 1e9);
}

/// The system with several of its slave bodies in a row, each with a contact of its own and its
/// share of the load.
System with_contacts(const System& system, int count) {
  System many = system;
  const double load = system.drives[0].load.value(system.drives[0].load.constant_from());
  many.drives[0].load = TimeCurve::ramp(load / count, system.drives[0].load.constant_from());
  const ContactPoint contact = system.contacts[0];
  constexpr int nodes_apart = 6;
  const MasterSurface& surface = system.surfaces[0];
  for (int k = 1; k < count; ++k) {
    ContactPoint next = contact;
    next.name = fmt::format("{}{}", contact.name, k);
    next.slave_body = static_cast<int>(many.bodies.size());
    const auto from = static_cast<std::size_t>(contact.first_segment);
    next.first_segment = contact.first_segment + k * nodes_apart;
    next.slave_position += surface.positions[from + static_cast<std::size_t>(k * nodes_apart)] -
                           surface.positions[from];
    many.bodies.push_back(system.bodies[static_cast<std::size_t>(contact.slave_body)]);
    many.contacts.push_back(next);
  }
  return many;
}

void against_contacts(const System& system, int rounds) {
  std::vector<Case> cases;
  for (const auto assumption : {ContactAssumption::subs_b, ContactAssumption::film}) {
    for (const int count : {1, 2, 4, 8}) {
      cases.emplace_back(
          fmt::format("{}, {}", count,
                      assumption == ContactAssumption::subs_b ? "sliding" : "unilateral"),
          with_assumption(with_contacts(system, count), assumption), exact(step, retained));
    }
  }
  measure(cases, rounds);
  print("contacts, each with a beam of its own", cases);
}

void against_nodes(int rounds) {
  std::vector<Case> cases;
  for (const int elements : {25, 50, 100, 200}) {
    const LoadedScene loaded = bench_scene(
        {fmt::format("substructures.cantilever.mesh.along={}", elements),
         fmt::format("substructures.cantilever.interface.spacing={:g} mm", 50.0 / elements)});
    const System system = build_model(loaded).system;
    cases.emplace_back(fmt::format("{}", system.surfaces[0].positions.size()), system,
                       exact(step, retained));
  }
  measure(cases, rounds);
  print("nodes of the master", cases);
}

/// Eight runs one after the other and in a batch, interleaved.
void against_batch(const System& system, int rounds) {
  constexpr double fine = 2.5e-7;
  constexpr int num_runs = 8;
  fmt::print(
      "\n| modes up to | moving modes | eight runs, ns per step of one | in a batch | ratio "
      "|\n|---|---|---|---|---|\n");
  for (const double frequency : {10e3, 30e3, 50e3, 80e3, 100e3, 400e3}) {
    const TimeParameters time = exact(fine, frequency);
    std::vector<Simulation> alone;
    std::vector<Simulation> together;
    for (int i = 0; i < num_runs; ++i) {
      alone.emplace_back(system, time).step_until(1000);
      together.emplace_back(system, time);
    }
    std::vector<Simulation*> runs;
    for (Simulation& simulation : together) runs.push_back(&simulation);
    Batch batch(runs);
    batch.step_until(1000);
    double least_alone = std::numeric_limits<double>::infinity();
    double least_together = least_alone;
    for (int round = 1; round <= rounds; ++round) {
      double start = processor_seconds();
      for (Simulation& simulation : alone) march(simulation, stretch);
      least_alone = std::min(least_alone, processor_seconds() - start);
      start = processor_seconds();
      batch.step_until(1000 + round * stretch);
      least_together = std::min(least_together, processor_seconds() - start);
      for (std::size_t i = 0; i < runs.size(); ++i) {
        if (batch.outcome(i) != StepOutcome::done) throw std::runtime_error(runs[i]->failure());
      }
    }
    const double nanoseconds = 1e9 / static_cast<double>(num_runs * stretch);
    fmt::print("| {:g} kHz | {} | {:.1f} | {:.1f} | {:.2f} |\n", frequency * 1e-3,
               num_moving_modes(system, time), least_alone * nanoseconds,
               least_together * nanoseconds, least_alone / least_together);
  }
}

/// Independent runs at once, one per thread.
struct Throughput {
  double steps_per_second = 0.0;  ///< of all threads together, by the wall clock
  double processor = 0.0;         ///< s of processor time per step
};

Throughput run_threads(std::vector<Simulation>& simulations, const State& start_state,
                       std::int64_t steps) {
  for (Simulation& simulation : simulations) simulation.load(start_state);
  std::vector<double> used(simulations.size());
  std::vector<std::thread> threads;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < simulations.size(); ++i) {
    threads.emplace_back([&, i] {
      const double begin = processor_seconds();
      march(simulations[i], steps);
      used[i] = processor_seconds() - begin;
    });
  }
  for (std::thread& thread : threads) thread.join();
  const double wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double all = static_cast<double>(steps) * static_cast<double>(simulations.size());
  double sum = 0.0;
  for (const double seconds : used) sum += seconds;
  return {all / wall, sum / all};
}

void against_threads(const System& system, int rounds) {
  constexpr std::int64_t steps = 25'000;
  std::vector<std::vector<Simulation>> groups(2);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (std::size_t i = 0; i <= g; ++i)
      groups[g].emplace_back(system, exact(step, retained)).step_until(1000);
  }
  const State start = groups[0][0].save();
  std::vector<Throughput> best(2, {0.0, std::numeric_limits<double>::infinity()});
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const Throughput now = run_threads(groups[g], start, steps);
      best[g].steps_per_second = std::max(best[g].steps_per_second, now.steps_per_second);
      best[g].processor = std::min(best[g].processor, now.processor);
    }
  }
  fmt::print(
      "\n| threads | million steps per second, most | processor time per step, ns, least |\n"
      "|---|---|---|\n");
  for (std::size_t g = 0; g < groups.size(); ++g) {
    fmt::print("| {} | {:.3f} | {:.0f} |\n", g + 1, best[g].steps_per_second * 1e-6,
               best[g].processor * 1e9);
  }
  fmt::print(
      "two threads: {:.2f} times the steps of one by the wall clock, {:.2f} by processor "
      "time\n",
      best[1].steps_per_second / best[0].steps_per_second,
      2.0 * best[0].processor / best[1].processor);
}

}  // namespace

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 15;
  const System system = build_model(bench_scene()).system;
  against_modes(system, rounds);
  against_contacts(system, rounds);
  against_nodes(rounds);
  against_batch(system, rounds);
  // Short ones, and many: others leave both cores to this program for a few milliseconds only.
  against_threads(system, 60 * rounds);
}
