// Cost of a step against the number of points that slide in space, on the facets of a body and on a plane.
//
//   build/release/bench/space_contact [ROUNDS]
//
// The block of scenes/examples/sliding_block.yaml with soles of 15, 50 and 100 nodes, 2 ms after the start.
// Microseconds of processor time per step, the least over ROUNDS (5) of 200 steps.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>

#include "bench/processor_clock.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/simulation.hpp"

using namespace stridor;
using namespace stridor::bench;

namespace {

constexpr double step = 2e-6;  ///< s
constexpr std::int64_t start = 1200, stretch = 200;  ///< steps

/// A block of 20 x 10 x 10 mm in bricks, of which the sole has (along + 1) (across + 1) nodes.
void write_block(const std::filesystem::path& file, int along, int across) {
  constexpr int through = 2;
  const auto node = [&](int i, int j, int k) {
    return 1 + i + (along + 1) * (j + (through + 1) * k);
  };
  std::ofstream out(file);
  out << "*NODE\n";
  for (int k = 0; k <= across; ++k)
    for (int j = 0; j <= through; ++j)
      for (int i = 0; i <= along; ++i)
        out << fmt::format("{}, {}, {}, {}\n", node(i, j, k), 5.0 + 20.0 * i / along,
                           10.0 * j / through, 5.0 + 10.0 * k / across);
  out << "*ELEMENT, TYPE=C3D8, ELSET=all\n";
  int number = 0;
  for (int k = 0; k < across; ++k) {
    for (int j = 0; j < through; ++j) {
      for (int i = 0; i < along; ++i) {
        out << ++number;
        for (const int up : {j, j + 1})
          for (const int one : {node(i, up, k), node(i, up, k + 1), node(i + 1, up, k + 1),
                                node(i + 1, up, k)})
            out << ", " << one;
        out << '\n';
      }
    }
  }
}

double cost_of(const std::vector<std::string>& sets, int rounds) {
  const LoadedScene loaded =
      load_scene(STRIDOR_SOURCE_DIR "/scenes/examples/sliding_block.yaml", sets);
  const Model model = build_model(loaded);
  TimeParameters time = *loaded.scene.time;
  time.step = step;
  Simulation simulation(model.system, time);
  const auto march = [&](std::int64_t steps) {
    if (simulation.step_until(simulation.step_index() + steps) != StepOutcome::done)
      throw std::runtime_error(simulation.failure());
  };
  march(start);
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const double from = processor_seconds();
    march(stretch);
    least = std::min(least, (processor_seconds() - from) / static_cast<double>(stretch));
  }
  return least;
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
  const auto file = std::filesystem::temp_directory_path() / "stridor_space_contact.inp";
  const std::string plane = "{normal: [0, 1, 0], point: [0, 0, 0]}";
  fmt::print("| points | on facets, us | on a rigid plane, us |\n|---|---|---|\n");
  for (const auto& [along, across] : {std::pair(4, 2), std::pair(9, 4), std::pair(9, 9)}) {
    write_block(file, along, across);
    const std::string mesh = "substructures.slider.file=" + file.string();
    const double on_facets = cost_of({mesh}, rounds);
    const double on_plane =
        cost_of({mesh, "contact.master=rigid", "contact.plane=" + plane}, rounds);
    fmt::print("| {} | {:.1f} | {:.1f} |\n", (along + 1) * (across + 1), 1e6 * on_facets,
               1e6 * on_plane);
  }
  std::filesystem::remove(file);
}
