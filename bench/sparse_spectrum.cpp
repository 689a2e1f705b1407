// Unstable eigenvalues of a disc between elastic pads, thousands of unknowns: time of each part.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "solvers/sparse_spectrum.hpp"
#include "tests/support/elastic_pads.hpp"

int main() {
  using namespace stridor;
  using Clock = std::chrono::steady_clock;
  const SparseSystem system = test::ElasticPads().system();
  for (const double frequency : {4000.0, 8000.0}) {
    const auto start = Clock::now();
    const std::clock_t processor = std::clock();
    const SparseSpectrum found = sparse_spectrum(system, SpectrumWindow::below(frequency));
    const double wall = std::chrono::duration<double>(Clock::now() - start).count();
    const double busy = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
    double largest = 0.0;
    for (const double error : found.backward_errors) largest = std::max(largest, error);
    fmt::print(
        "{} unknowns below {} Hz: {} found, {} counted, {} factorisations, {:.1f} s of the "
        "processor in {:.1f} s, backward error <= {:.1e}\n",
        system.size(), frequency, found.num_found, found.num_counted, found.factorisations, busy,
        wall, largest);
    for (const Eigenvalue& one : found.eigenvalues)
      if (one.growth() > 0.0)
        fmt::print("  unstable: {:.4f} Hz, {:.5f} 1/s\n", one.frequency(), one.growth());
  }
}
