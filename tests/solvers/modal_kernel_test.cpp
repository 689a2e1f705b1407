#include "solvers/integrators/modal_kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "solvers/algebra/aligned_array.hpp"

namespace stridor {
namespace {

AlignedArray random_array(std::size_t size, std::mt19937& generator) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  AlignedArray array(size);
  for (std::size_t i = 0; i < size; ++i) array[i] = uniform(generator);
  return array;
}

class ModalKernelTest : public ::testing::TestWithParam<int> {};

TEST_P(ModalKernelTest, DoesWhatItsEquationsSayForAnyNumberOfPorts) {
  const auto num_ports = static_cast<std::size_t>(GetParam());
  for (const std::size_t num_blocks : {1u, 3u, 28u}) {
    const std::size_t size = num_blocks * modal_block;
    const double lookahead = num_blocks == 3 ? 0.0 : 1.0;
    std::mt19937 generator(static_cast<unsigned>(size + num_ports));
    AlignedArray blocks = random_array(size * num_modal_fields, generator);
    std::vector<AlignedArray> rows;
    std::vector<const double*> row_pointers;
    std::vector<double> forces;
    for (std::size_t j = 0; j < num_ports; ++j) {
      rows.push_back(random_array(size, generator));
      forces.push_back(static_cast<double>(j) - 1.5);
    }
    for (const AlignedArray& row : rows) row_pointers.push_back(row.data());

    // The pass as its comment has it, one mode after the other.
    std::vector<double> position(size);
    std::vector<double> increment(size);
    std::vector<double> expected(num_ports, 0.0);
    for (std::size_t i = 0; i < size; ++i) {
      const auto before = [&](ModalField field) { return blocks[modal_index(i, field)]; };
      double modal_force = 0.0;
      for (std::size_t j = 0; j < num_ports; ++j) modal_force += rows[j][i] * forces[j];
      const double corrected =
          before(ModalField::increment) + before(ModalField::gain) * modal_force;
      position[i] = before(ModalField::position) + corrected;
      increment[i] = before(ModalField::keep) * corrected - before(ModalField::pull) * position[i] +
                     before(ModalField::load);
      for (std::size_t j = 0; j < num_ports; ++j)
        expected[j] += rows[j][i] * (position[i] + lookahead * increment[i]);
    }

    std::vector<double> predicted(num_ports);
    advance_modes(blocks.data(), num_blocks, row_pointers.data(), forces.data(),
                  static_cast<int>(num_ports), lookahead, predicted.data());
    // Some tens of operations on numbers of order 10, in another order and with fused products.
    for (std::size_t i = 0; i < size; ++i) {
      EXPECT_NEAR(blocks[modal_index(i, ModalField::position)], position[i], 1e-13);
      EXPECT_NEAR(blocks[modal_index(i, ModalField::increment)], increment[i], 1e-13);
    }
    for (std::size_t j = 0; j < num_ports; ++j)
      EXPECT_NEAR(predicted[j], expected[j], 1e-12 * static_cast<double>(size));
  }
}

INSTANTIATE_TEST_SUITE_P(Ports, ModalKernelTest,
                         ::testing::Values(0, 1, 2, 3, 4, 5, 6, 8, 9, 10, 40));

TEST(ModalKernel, GatherIsTheProductOfARowWithOneField) {
  for (const std::size_t num_blocks : {1u, 2u, 5u, 28u}) {
    const std::size_t size = num_blocks * modal_block;
    std::mt19937 generator(static_cast<unsigned>(size));
    const AlignedArray blocks = random_array(size * num_modal_fields, generator);
    const AlignedArray row = random_array(size, generator);
    for (const ModalField field : {ModalField::position, ModalField::increment, ModalField::load}) {
      double plain = 0.0;
      for (std::size_t i = 0; i < size; ++i) plain += row[i] * blocks[modal_index(i, field)];
      EXPECT_NEAR(gather_modes(blocks.data(), num_blocks, field, row.data()), plain,
                  1e-15 * static_cast<double>(size));
    }
  }
}

}  // namespace
}  // namespace stridor
