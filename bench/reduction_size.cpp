// Craig-Bampton reduction of fine meshes, beside one factorisation of the same interior stiffness
// by CHOLMOD as it comes.
//
//   build/release/bench/reduction_size [ALONG THROUGH [SPACING [ROUNDS]]]
//       the cantilever of the main scene: elements along the axis and through the thickness,
//       distance of the interface nodes on the top in m; by default 1250 26 0.001 3: 200,000 DoFs,
//       200 of them kept, three rounds of factorisation and reduction, alternating
//   build/release/bench/reduction_size solid NX NY NZ [KEPT [ROUNDS]]
//       a steel cantilever of hex20 elements with sides of 1 mm, held at x = 0, of which KEPT DoFs
//       (200) on the top are kept. 26 26 25 is a block and 91 91 2 a plate of 200,000 DoFs,
//       168 168 3 a plate of 1,000,000
//
// Seconds are processor time, which other work on the machine disturbs less than the clock on the
// wall (in brackets). Memory is the largest resident set of the process during each part, with what
// it holds from before: the full matrices, and for the factorisation the interior stiffness.
#include <fmt/format.h>

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "substructures/bodies/beam.hpp"
#include "substructures/elements/assembly.hpp"
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

/// A body, and its DoFs on the top.
struct Solid {
  BodyMatrices body;
  std::vector<int> top;
};

/// Rows and columns that have a place.
SparseMatrix selected(const SparseMatrix& matrix, const std::vector<int>& place, int size) {
  SparseMatrix part(size, size);
  part.reserve(matrix.nonZeros());
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    if (place[static_cast<std::size_t>(column)] < 0) continue;
    part.startVec(place[static_cast<std::size_t>(column)]);
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      const int row = place[static_cast<std::size_t>(entry.row())];
      if (row >= 0) part.insertBack(row, place[static_cast<std::size_t>(column)]) = entry.value();
    }
  }
  part.finalize();
  return part;
}

/// Nodes of hex20 elements lie on a grid of half elements, at most one index of which is odd.
Mesh block_mesh(const std::array<int, 3>& count) {
  constexpr double side = 0.001;
  Mesh mesh;
  const auto index = [&](int i, int j, int k) {
    return static_cast<std::size_t>((k * (2 * count[1] + 1) + j) * (2 * count[0] + 1) + i);
  };
  std::vector<int> number(index(2 * count[0], 2 * count[1], 2 * count[2]) + 1, -1);
  std::vector<Eigen::Vector3d> places;
  for (int k = 0; k <= 2 * count[2]; ++k) {
    for (int j = 0; j <= 2 * count[1]; ++j) {
      for (int i = 0; i <= 2 * count[0]; ++i) {
        if (i % 2 + j % 2 + k % 2 > 1) continue;
        number[index(i, j, k)] = static_cast<int>(places.size());
        places.emplace_back(0.5 * side * i, 0.5 * side * j, 0.5 * side * k);
      }
    }
  }
  mesh.nodes.resize(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t n = 0; n < places.size(); ++n) {
    mesh.nodes.row(static_cast<Eigen::Index>(n)) = places[n].transpose();
    mesh.node_labels.push_back(static_cast<std::int64_t>(n + 1));
  }
  constexpr int at[20][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2},
                             {2, 0, 2}, {2, 2, 2}, {0, 2, 2}, {1, 0, 0}, {2, 1, 0},
                             {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2}, {1, 2, 2},
                             {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
  std::int64_t label = 0;
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        std::array<int, 20> nodes{};
        for (std::size_t n = 0; n < nodes.size(); ++n)
          nodes[n] = number[index(2 * i + at[n][0], 2 * j + at[n][1], 2 * k + at[n][2])];
        mesh.add_element(ElementShape::hex20, nodes, ++label);
      }
    }
  }
  return mesh;
}

Solid solid_cantilever(const std::array<int, 3>& count) {
  const Mesh mesh = block_mesh(count);
  const ElasticLaw steel(IsotropicElasticity{210e9, 0.3}, PlaneState::none);
  MeshMatrices matrices = assemble_mesh(mesh, one_section(mesh, {steel, 7850.0}));
  Solid solid;
  std::vector<int> place;
  int size = 0;
  const double top = mesh.nodes.col(2).maxCoeff();
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
    for (int d = 0; d < 3; ++d) {
      const bool is_held = mesh.nodes(node, 0) == 0.0;
      if (!is_held && mesh.nodes(node, 2) == top) solid.top.push_back(size);
      place.push_back(is_held ? -1 : size++);
    }
  }
  solid.body.stiffness = selected(matrices.stiffness, place, size);
  matrices.stiffness = {};
  solid.body.mass = selected(matrices.mass, place, size);
  return solid;
}

/// So many of some DoFs, as far apart as they can be.
std::vector<int> spread(const std::vector<int>& dofs, std::size_t count) {
  std::vector<int> chosen;
  for (std::size_t k = 0; k < std::min(count, dofs.size()); ++k)
    chosen.push_back(dofs[k * dofs.size() / std::min(count, dofs.size())]);
  return chosen;
}

SparseMatrix interior_stiffness(const BodyMatrices& body, const std::vector<int>& interface) {
  std::vector<int> position(static_cast<std::size_t>(body.num_dofs()), 0);
  for (const int dof : interface) position[static_cast<std::size_t>(dof)] = BodyMatrices::held;
  int num_interior = 0;
  for (int& p : position)
    if (p != BodyMatrices::held) p = num_interior++;
  return selected(body.stiffness, position, num_interior);
}

void print(const char* what, const Cost& cost) {
  fmt::print("{:<16}{:>8.2f} s ({:.2f} s){:>8.2f} GB\n", what, cost.processor, cost.wall,
             cost.peak);
}

void compare(const BodyMatrices& body, const std::vector<int>& interface, int rounds) {
  fmt::print("{} DoFs, {} kept, {} modes; {:.1f} million entries in K\n", body.num_dofs(),
             interface.size(), num_modes, 1e-6 * static_cast<double>(body.stiffness.nonZeros()));
  ReducedBody reduced;
  std::vector<double> ratios;
  for (int round = 0; round < rounds; ++round) {
    Cost factorisation{};
    {
      const SparseMatrix interior = interior_stiffness(body, interface);
      factorisation = cost_of([&] {
        const Eigen::CholmodSupernodalLLT<SparseMatrix::Base, Eigen::Lower> factor(interior);
      });
    }
    print("factorisation", factorisation);
    const Cost reduction =
        cost_of([&] { reduced = make_craig_bampton(body, interface, num_modes, interface); });
    print("reduction", reduction);
    ratios.push_back(reduction.processor / factorisation.processor);
  }
  std::sort(ratios.begin(), ratios.end());
  fmt::print("ratio of processor times {:.2f} (median; {:.2f} to {:.2f})\n",
             ratios[ratios.size() / 2], ratios.front(), ratios.back());

  const Eigen::VectorXd omega = make_modal(reduced).omega;
  fmt::print("lowest frequencies, Hz:");
  for (Eigen::Index i = 0; i < 12; ++i) fmt::print(" {:.5f}", omega(i) / (2.0 * std::numbers::pi));
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int k, int otherwise) {
    return argc > k ? std::atoi(argv[k]) : otherwise;
  };
  if (argc > 4 && std::string(argv[1]) == "solid") {
    Solid solid;
    print("assembly", cost_of([&] {
            solid = solid_cantilever({number(2, 1), number(3, 1), number(4, 1)});
          }));
    compare(solid.body, spread(solid.top, static_cast<std::size_t>(number(5, 200))), number(6, 3));
    return 0;
  }
  const double spacing = argc > 3 ? std::atof(argv[3]) : 0.001;
  BodyMatrices body;
  print("assembly", cost_of([&] { body = make_beam(cantilever(number(1, 1250), number(2, 26))); }));
  const std::vector<int> interface = interface_dofs(body, spacing);
  if (interface.empty()) {
    fmt::print(stderr, "{:g} m is no multiple of the node distance\n", spacing);
    return 2;
  }
  compare(body, interface, number(4, 3));
  return 0;
}
