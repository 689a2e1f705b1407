// Cost of the locus of the main scene: secular method with refinement and root count, against the
// dense method.
//
//   build/release/bench/secular [ROUNDS]
//       20 branches over 2,000 positions from 30 to 98 mm, all modes, in every round, with the
//       dense method at a few of these positions; minimum and median over the rounds. Processor
//       time of this one thread, so that other work on the machine disturbs little.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "analysis/locus.hpp"
#include "io/scene/scene.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"

using namespace stridor;

namespace {

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <class Work>
double seconds_for(Work&& work) {
  const double start = processor_seconds();
  work();
  return processor_seconds() - start;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void print_row(const char* name, const std::vector<double>& values, double unit,
               const char* unit_name) {
  fmt::print("{:<52}{:>12.2f}{:>12.2f} {}\n", name,
             *std::min_element(values.begin(), values.end()) / unit, median(values) / unit,
             unit_name);
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 11;
  constexpr int num_positions = 2000;
  constexpr int num_dense = 3;  // positions a round
  const LoadedScene loaded = load_scene(STRIDOR_SOURCE_DIR "/scenes/beam_on_beam.yaml", {});
  const Model model = build_model(loaded);
  const ContactParameters contact = loaded.scene.model.contact.value();
  const PencilFamily family = undeformed_family(
      model.system, model.system.contacts[0].friction.dynamic_coefficient, 1.0, contact.start.along.value());
  std::vector<double> positions;
  for (int i = 0; i < num_positions; ++i) {
    positions.push_back(0.030 + 0.068 * i / (num_positions - 1));
  }

  Pencil pencil;
  family.place(positions.front(), pencil);
  Locus locus;
  std::vector<double> secular, per_position, dense, dense_with_residuals, ratios;
  for (int round = 0; round < rounds; ++round) {
    secular.push_back(seconds_for([&] { locus = trace_locus(family, positions); }));
    per_position.push_back(secular.back() / num_positions);
    double values_only = 0.0;
    double with_residuals = 0.0;
    for (int i = 0; i < num_dense; ++i) {
      const int at = (round * num_dense + i) * 97 % num_positions;
      family.place(positions[static_cast<std::size_t>(at)], pencil);
      values_only += seconds_for([&] { dense_eigenvalues(pencil, DenseWork::eigenvalues); });
      with_residuals += seconds_for([&] { dense_eigenvalues(pencil, DenseWork::residuals); });
    }
    dense.push_back(values_only / num_dense);
    dense_with_residuals.push_back(with_residuals / num_dense);
    ratios.push_back(dense.back() / per_position.back());
  }

  fmt::print(
      "{} modes, {} positions asked for; {} counted, {} refined, {} not verified; {} windows\n",
      pencil.num_modes(), num_positions, locus.num_places, locus.num_refined,
      locus.unverified.size(), locus.unstable.size());
  fmt::print("{:<52}{:>12}{:>12}\n", "", "minimum", "median");
  print_row("secular, the whole locus", secular, 1e-3, "ms");
  print_row("secular, per position asked for", per_position, 1e-6, "us");
  print_row("dense, per position, eigenvalues only", dense, 1e-3, "ms");
  print_row("dense, per position, with residuals", dense_with_residuals, 1e-3, "ms");
  print_row("ratio dense (eigenvalues only) to secular", ratios, 1.0, "");
}
