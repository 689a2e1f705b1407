#include "solvers/modal_kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "solvers/aligned_array.hpp"

namespace stridor {
namespace {

AlignedArray random_array(std::size_t size, std::mt19937& generator) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  AlignedArray array(size);
  for (std::size_t i = 0; i < size; ++i) array[i] = uniform(generator);
  return array;
}

/// The pass as its comment has it, one mode after the other.
void advance_plainly(std::size_t size, AlignedArray& q, AlignedArray& d, const AlignedArray& keep, const AlignedArray& pull,
                     const AlignedArray& gain, const AlignedArray& load, const std::vector<AlignedArray>& rows,
                     const std::vector<double>& forces, std::vector<double>& predicted) {
  predicted.assign(rows.size(), 0.0);
  for (std::size_t i = 0; i < size; ++i) {
    double modal_force = 0.0;
    for (std::size_t j = 0; j < rows.size(); ++j) modal_force += rows[j][i] * forces[j];
    const double increment = d[i] + gain[i] * modal_force;
    q[i] += increment;
    d[i] = keep[i] * increment - pull[i] * q[i] + load[i];
    for (std::size_t j = 0; j < rows.size(); ++j) predicted[j] += rows[j][i] * (q[i] + d[i]);
  }
}

class ModalKernelTest : public ::testing::TestWithParam<int> {};

TEST_P(ModalKernelTest, DoesWhatItsEquationsSayForAnyNumberOfSlots) {
  const auto num_slots = static_cast<std::size_t>(GetParam());
  for (const std::size_t size : {8u, 24u, 224u}) {
    std::mt19937 generator(static_cast<unsigned>(size + num_slots));
    AlignedArray q = random_array(size, generator);
    AlignedArray d = random_array(size, generator);
    const AlignedArray keep = random_array(size, generator);
    const AlignedArray pull = random_array(size, generator);
    const AlignedArray gain = random_array(size, generator);
    const AlignedArray load = random_array(size, generator);
    std::vector<AlignedArray> rows;
    std::vector<const double*> row_pointers;
    std::vector<double> forces;
    for (std::size_t j = 0; j < num_slots; ++j) {
      rows.push_back(random_array(size, generator));
      forces.push_back(static_cast<double>(j) - 1.5);
    }
    for (const AlignedArray& row : rows) row_pointers.push_back(row.data());
    AlignedArray plain_q(size);
    AlignedArray plain_d(size);
    for (std::size_t i = 0; i < size; ++i) {
      plain_q[i] = q[i];
      plain_d[i] = d[i];
    }
    std::vector<double> predicted(num_slots);
    std::vector<double> plain_predicted;
    advance_modes({size, q.data(), d.data(), keep.data(), pull.data(), gain.data(), load.data()}, row_pointers.data(),
                  forces.data(), static_cast<int>(num_slots), predicted.data());
    advance_plainly(size, plain_q, plain_d, keep, pull, gain, load, rows, forces, plain_predicted);
    // Some tens of operations on numbers of order 10, in another order and with fused products.
    for (std::size_t i = 0; i < size; ++i) {
      EXPECT_NEAR(q[i], plain_q[i], 1e-13);
      EXPECT_NEAR(d[i], plain_d[i], 1e-13);
    }
    for (std::size_t j = 0; j < num_slots; ++j) EXPECT_NEAR(predicted[j], plain_predicted[j], 1e-12 * static_cast<double>(size));
  }
}

INSTANTIATE_TEST_SUITE_P(Slots, ModalKernelTest, ::testing::Values(0, 1, 2, 3, 4, 5, 6, 9, 40));

TEST(ModalKernel, DotProductOfAnyPaddedLength) {
  for (const std::size_t size : {8u, 16u, 24u, 40u, 224u}) {
    std::mt19937 generator(static_cast<unsigned>(size));
    const AlignedArray a = random_array(size, generator);
    const AlignedArray b = random_array(size, generator);
    double plain = 0.0;
    for (std::size_t i = 0; i < size; ++i) plain += a[i] * b[i];
    EXPECT_NEAR(dot(a.data(), b.data(), size), plain, 1e-15 * static_cast<double>(size));
  }
}

}  // namespace
}  // namespace stridor
