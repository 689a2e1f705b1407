// Cost of one step of the main scene: modal form against the published dense form.
//
//   build/release/bench/step_forms [ROUNDS]
//       nanoseconds a step of every form, interleaved, minimum and median over the rounds, and the
//       ratios to the modal form taken round by round
//   valgrind --tool=callgrind --toggle-collect="stridor::Simulation::step_until*"
//       build/release/bench/step_forms --instructions [central_difference | exact_50_kHz]
//       20,000 modal steps after the start-up, for counting instructions (see instructions.cmake)
//   build/release/bench/step_forms --recording [ROUNDS]
//       the modal step alone and with the recorder of the scene behind it
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/run_file/recorder.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/march.hpp"

using namespace stridor;

namespace {

using Clock = std::chrono::steady_clock;

double seconds_for(Simulation& simulation, std::int64_t steps) {
  const auto start = Clock::now();
  if (simulation.step_until(simulation.step_index() + steps) != StepOutcome::done) {
    throw std::runtime_error(simulation.failure());
  }
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}
double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

LoadedScene bench_scene() {
  // A short ramp and schedule, so that the forms are timed in the state that most of a run is in.
  return load_scene(
      STRIDOR_SOURCE_DIR "/scenes/beam_on_beam.yaml",
      {"drive.ramp=1e-4", "contact.armed_from=1e3", "substructures.oblique.damping.hold=1e-5",
       "substructures.oblique.damping.fade=1e-5"});
}

struct Form {
  const char* name;
  Coordinates coordinates;
  std::int64_t steps;  ///< per round
};

void compare_forms(int rounds) {
  const LoadedScene loaded = bench_scene();
  const Model model = build_model(loaded);
  const std::vector<Form> forms{
      {"modal", Coordinates::modal, 100'000},
      {"craig_bampton (published, assembled)", Coordinates::craig_bampton, 500},
      {"craig_bampton_fused", Coordinates::craig_bampton_fused, 5'000}};
  std::vector<Simulation> simulations;
  for (const Form& form : forms) {
    TimeParameters time = *loaded.scene.time;
    time.coordinates = form.coordinates;
    simulations.emplace_back(model.system, time);
    seconds_for(simulations.back(), 1000);  // past the start
  }
  std::vector<std::vector<double>> nanoseconds(forms.size());
  std::vector<std::vector<double>> ratios(forms.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < forms.size(); ++i) {
      nanoseconds[i].push_back(seconds_for(simulations[i], forms[i].steps) * 1e9 /
                               static_cast<double>(forms[i].steps));
      ratios[i].push_back(nanoseconds[i].back() / nanoseconds[0].back());
    }
  }
  fmt::print("{:<40}{:>12}{:>12}{:>16}\n", "form", "min ns", "median ns", "median ratio");
  for (std::size_t i = 0; i < forms.size(); ++i) {
    fmt::print("{:<40}{:>12.1f}{:>12.1f}{:>16.2f}\n", forms[i].name, least(nanoseconds[i]),
               median(nanoseconds[i]), median(ratios[i]));
  }
}

void count_instructions(const std::string& form) {
  const LoadedScene loaded = bench_scene();
  const Model model = build_model(loaded);
  TimeParameters time = *loaded.scene.time;
  if (form == "exact_50_kHz") {
    time.integrator = Integrator::exact;
    time.retain = RetainParameters{50e3, {}};
    time.step = 2.5e-6;
  } else if (form != "central_difference") {
    throw std::runtime_error("no form " + form);
  }
  Simulation simulation(model.system, time);
  while (simulation.step_index() < 1000) simulation.step();
  seconds_for(simulation, 20'000);
}

void compare_recording(int rounds) {
  const LoadedScene loaded = bench_scene();
  const Scene& scene = loaded.scene;
  const Model model = build_model(loaded);
  const auto channels = parse_channels(*scene.record, scene.model);
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("stridor-bench-{}.h5", getpid()))
          .string();
  {
    RunFileWriter writer(
        path, Overwrite::yes, {},
        Recorder::series(model, channels, scene.time->step, scene.record->interval));
    Recorder recorder(model, channels, scene.time->step, scene.record->interval, writer);
    Simulation bare(model.system, *scene.time);
    Simulation recorded(model.system, *scene.time);
    std::vector<double> without;
    std::vector<double> ratios;
    constexpr std::int64_t steps = 50'000;
    for (int round = 0; round < rounds; ++round) {
      MarchPlan plan;
      plan.last_step = steps * (round + 1);
      auto start = Clock::now();
      march(bare, nullptr, plan);
      const double alone = std::chrono::duration<double>(Clock::now() - start).count();
      start = Clock::now();
      march(recorded, &recorder, plan);
      const double with = std::chrono::duration<double>(Clock::now() - start).count();
      without.push_back(alone * 1e9 / static_cast<double>(steps));
      ratios.push_back(with / alone);
    }
    fmt::print(
        "{} channels every {:g} s: {:.1f} ns a step alone (median), with recording {:.3f} times "
        "that (median; min {:.3f})\n",
        channels.size(), scene.record->interval, median(without), median(ratios), least(ratios));
  }
  std::filesystem::remove(path);
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int index, int otherwise) {
    return argc > index ? std::atoi(argv[index]) : otherwise;
  };
  if (argc > 1 && std::strcmp(argv[1], "--instructions") == 0) {
    count_instructions(argc > 2 ? argv[2] : "central_difference");
  } else if (argc > 1 && std::strcmp(argv[1], "--recording") == 0) {
    compare_recording(number(2, 201));
  } else {
    compare_forms(number(1, 11));
  }
}
