// Cost of the boundary-element contact: points of the master curve, each from the one before.
//
//   build/release/bench/boundary_elements [GRID...]
//       By default 64, 128 and 256 cells a side, at the default tolerance: setting up, one product
//       with the influence coefficients, a point (mean and largest over the 57 of the curve), the
//       whole curve, and the memory of the process at its peak. Processor time of this one thread,
//       so that other work on the machine disturbs little. Grids in ascending order, since the peak
//       only grows.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "solvers/half_space/half_space_convolution.hpp"
#include "solvers/half_space/master_curve.hpp"

using namespace stridor;

namespace {

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void measure(std::int64_t grid) {
  double start = processor_seconds();
  HalfSpaceConvolution half_space(static_cast<std::size_t>(grid));
  const double setup = processor_seconds() - start;
  const SlidingCreep creep{0.9, 1.0};
  half_space.set_creep({&creep, 1}, 2.2 / static_cast<double>(grid));
  std::vector<double> field(half_space.num_values(), 1.0);
  constexpr int num_products = 20;
  start = processor_seconds();
  for (int k = 0; k < num_products; ++k) half_space.apply(field, field);
  const double product = (processor_seconds() - start) / num_products;

  SlidingContactParameters parameters;
  parameters.grid = grid;
  std::vector<double> points;
  const double curve_start = processor_seconds();
  start = curve_start;
  const ComputedMasterCurve computed =
      compute_master_curve(0.1, master_curve_betas(), parameters, [&](std::size_t) {
        points.push_back(processor_seconds() - start);
        start = processor_seconds();
      });
  const double curve = processor_seconds() - curve_start;
  // The first point has none before it.
  points.erase(points.begin());
  double mean = 0.0;
  for (const double seconds : points) mean += seconds / static_cast<double>(points.size());
  fmt::print("{:>6}{:>12.1f}{:>14.2f}{:>12.1f}{:>12.1f}{:>12.2f}{:>12.0f}  {}\n", grid, 1e3 * setup,
             1e3 * product, 1e3 * mean, 1e3 * *std::max_element(points.begin(), points.end()),
             curve, peak_megabytes(), computed.converged() ? "converged" : "NOT CONVERGED");
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::int64_t> grids;
  for (int i = 1; i < argc; ++i) grids.push_back(std::atoll(argv[i]));
  if (grids.empty()) grids = {64, 128, 256};
  fmt::print("{:>6}{:>12}{:>14}{:>12}{:>12}{:>12}{:>12}\n", "grid", "set-up, ms", "product, ms",
             "point, ms", "worst, ms", "curve, s", "peak, MB");
  for (const std::int64_t grid : grids) measure(grid);
  return 0;
}
