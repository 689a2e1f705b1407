// The reference of `stridor precision` against SUNDIALS ARKODE, on a short run of the leading
// scene.
//
//   build/release/bench/confirm [END, s]
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>

#include "bench/arkode_run.hpp"
#include "io/scene/channels.hpp"
#include "io/scene/scene.hpp"
#include "models/model.hpp"

using namespace stridor;

namespace {

constexpr double interval = 1e-5;

void print(const std::string& name, const RunErrors& errors, double seconds) {
  fmt::print("{:<44} {:>10.2e} {:>10.2e} {:>10.2e} {:>9.3f}\n", name, errors.force,
             errors.acceleration, errors.envelope, seconds);
}

}  // namespace

int main(int argc, char** argv) {
  const double end = argc > 1 ? std::atof(argv[1]) : 0.06;
  // A quick ramp, and a start in the middle of a segment.
  const LoadedScene loaded =
      load_scene(STRIDOR_SOURCE_DIR "/scenes/beam_on_beam_leading.yaml",
                 {"drive.ramp=0.02", "contact.start=30.5 mm", "contact.armed_from=1e3"});
  const Model model = build_model(loaded);
  const Model::Point& point = model.points.at({"cantilever", "free_end"});
  const ObservedRow observed{point.body, point.rows.y};
  const auto num_samples = static_cast<std::int64_t>(end / interval + 0.5);
  const NormParameters norms{{0.03, end}, {2.5e3, 15e3}};

  const bench::ArkodeResult arkode =
      bench::run_arkode(model.system, observed, interval, num_samples);
  bench::ArkodeParameters loose;
  loose.relative_tolerance = 1e-7;
  loose.displacement_tolerance = 1e-13;
  loose.velocity_tolerance = 1e-8;
  const bench::ArkodeResult coarse =
      bench::run_arkode(model.system, observed, interval, num_samples, loose);
  const ReferenceRun reference(arkode.samples, norms);
  fmt::print("ARKODE: {} steps, {} evaluations, {} kinks, largest gap {:.1e} m, {:.2f} s\n",
             arkode.steps, arkode.evaluations, arkode.kinks, arkode.worst_gap, arkode.seconds);
  fmt::print("errors against it from 0.03 to {} s, 2.5 to 15 kHz\n\n", end);
  fmt::print("{:<44} {:>10} {:>10} {:>10} {:>9}\n", "run", "force", "accel.", "envelope", "s");
  print("ARKODE, tolerances 100 times larger", reference.errors_of(coarse.samples), coarse.seconds);
  const auto own = [&](const char* name, Integrator integrator, std::optional<double> retained,
                       int steps) {
    const TimeParameters time =
        PrecisionMethod{integrator, retained, {}, {}}.at(steps, *loaded.scene.time, interval);
    TimedRun run(model.system, time, observed, interval, num_samples);
    run.run_until(num_samples);
    if (!run.failure().empty()) fmt::print("{}\n", run.failure());
    print(fmt::format("{}, {:.3g} s", name, time.step), reference.errors_of(run.samples()),
          run.cost().stepping);
  };
  for (const int steps : {560, 280, 140, 70, 35, 4, 1})
    own("exact, all modes", Integrator::exact, {}, steps);
  for (const int steps : {280, 140, 70, 35})
    own("central difference", Integrator::central_difference, {}, steps);
  for (const double cutoff : {100e3, 50e3})
    for (const int steps : {8, 4, 3, 2, 1})
      own(cutoff > 60e3 ? "exact to 100 kHz" : "exact to 50 kHz", Integrator::exact, cutoff, steps);
}
