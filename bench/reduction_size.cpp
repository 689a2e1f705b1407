// Craig-Bampton reduction of the cantilever of the main scene on fine meshes, beside one
// factorisation of the same interior stiffness by CHOLMOD as it comes.
//
//   build/release/bench/reduction_size [ALONG THROUGH [SPACING [ROUNDS]]]
//       elements along the axis and through the thickness, distance of the interface nodes on the
//       top in m; by default 1250 26 0.001 3: 200,000 DoFs, 200 of them kept, three rounds of
//       factorisation and reduction, alternating
//
// Seconds are processor time, which other work on the machine disturbs less than the clock on the
// wall (in brackets). Memory is the largest resident set of the process during each part, with what
// it holds from before: the full matrices, and for the factorisation the interior stiffness.
#include <fmt/format.h>

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "substructures/bodies/beam.hpp"
#include "substructures/reduction/modal_body.hpp"

using namespace stridor;

namespace {

constexpr Eigen::Index num_modes = 20;

struct Cost {
  double processor;  ///< s
  double wall;       ///< s
  double peak;       ///< GB
};

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << "5\n";
}

double peak_gigabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kibibytes = 0.0;
    if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024.0 * 1e-9;
  }
  return 0.0;
}

template <typename Work>
Cost cost_of(Work&& work) {
  forget_peak();
  const auto wall_start = std::chrono::steady_clock::now();
  const double start = processor_seconds();
  work();
  return {processor_seconds() - start,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count(),
          peak_gigabytes()};
}

BeamParameters cantilever(int along, int through) {
  BeamParameters beam;
  beam.length = 0.100;
  beam.thickness = 0.002;
  beam.width = 0.020;
  beam.material = {2.38e9, 0.40, 1200.0};
  beam.mesh = {along, through};
  beam.supports = {Support::clamped, Support::free};
  return beam;
}

/// DoFs of the nodes on the top, `spacing` apart; empty if the nodes do not allow it.
std::vector<int> interface_dofs(const BodyMatrices& body, double spacing) {
  const std::vector<int>& top = body.surfaces.at("top");
  const double ratio = spacing / (body.nodes.row(top[1]) - body.nodes.row(top[0])).norm();
  const auto stride = static_cast<std::size_t>(std::llround(ratio));
  if (stride < 1 || std::abs(ratio - std::round(ratio)) > 1e-6 * ratio) return {};
  std::vector<int> dofs;
  for (std::size_t k = 0; k < top.size(); k += stride) {
    for (const int dof : body.node_dofs[static_cast<std::size_t>(top[k])])
      if (dof != BodyMatrices::held) dofs.push_back(dof);
  }
  return dofs;
}

SparseMatrix interior_stiffness(const BodyMatrices& body, const std::vector<int>& interface) {
  std::vector<int> position(static_cast<std::size_t>(body.num_dofs()), 0);
  for (const int dof : interface) position[static_cast<std::size_t>(dof)] = BodyMatrices::held;
  int num_interior = 0;
  for (int& p : position)
    if (p != BodyMatrices::held) p = num_interior++;
  SparseMatrix interior(num_interior, num_interior);
  interior.reserve(body.stiffness.nonZeros());
  for (Eigen::Index dof = 0; dof < body.num_dofs(); ++dof) {
    const int column = position[static_cast<std::size_t>(dof)];
    if (column == BodyMatrices::held) continue;
    interior.startVec(column);
    for (SparseMatrix::InnerIterator entry(body.stiffness, dof); entry; ++entry) {
      const int row = position[static_cast<std::size_t>(entry.row())];
      if (row != BodyMatrices::held) interior.insertBack(row, column) = entry.value();
    }
  }
  interior.finalize();
  return interior;
}

void print(const char* what, const Cost& cost) {
  fmt::print("{:<16}{:>8.2f} s ({:.2f} s){:>8.2f} GB\n", what, cost.processor, cost.wall,
             cost.peak);
}

}  // namespace

int main(int argc, char** argv) {
  const int along = argc > 1 ? std::atoi(argv[1]) : 1250;
  const int through = argc > 2 ? std::atoi(argv[2]) : 26;
  const double spacing = argc > 3 ? std::atof(argv[3]) : 0.001;
  const int rounds = argc > 4 ? std::atoi(argv[4]) : 3;

  BodyMatrices body;
  const Cost assembly = cost_of([&] { body = make_beam(cantilever(along, through)); });
  const std::vector<int> interface = interface_dofs(body, spacing);
  if (interface.empty()) {
    fmt::print(stderr, "{:g} m is no multiple of the node distance\n", spacing);
    return 2;
  }
  fmt::print(
      "{} x {} elements: {} DoFs, {} kept, {} modes; {:.1f} million "
      "entries in K\n",
      along, through, body.num_dofs(), interface.size(), num_modes,
      1e-6 * static_cast<double>(body.stiffness.nonZeros()));
  print("assembly", assembly);

  ReducedBody reduced;
  std::vector<double> ratios;
  for (int round = 0; round < rounds; ++round) {
    Cost factorisation{};
    {
      const SparseMatrix interior = interior_stiffness(body, interface);
      factorisation = cost_of(
          [&] { const Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> factor(interior); });
    }
    print("factorisation", factorisation);
    const Cost reduction =
        cost_of([&] { reduced = make_craig_bampton(body, interface, num_modes, interface); });
    print("reduction", reduction);
    ratios.push_back(reduction.processor / factorisation.processor);
  }
  std::sort(ratios.begin(), ratios.end());
  fmt::print("ratio of processor times {:.1f} (median; {:.1f} to {:.1f})\n",
             ratios[ratios.size() / 2], ratios.front(), ratios.back());

  const Eigen::VectorXd omega = make_modal(reduced).omega;
  fmt::print("lowest frequencies, Hz:");
  for (Eigen::Index i = 0; i < 12; ++i) fmt::print(" {:.5f}", omega(i) / (2.0 * std::numbers::pi));
  fmt::print("\n");
  return 0;
}
