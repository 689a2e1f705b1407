#include "models/set_up_estimate.hpp"

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "substructures/bodies/beam.hpp"
#include "substructures/bodies/plate_body.hpp"
#include "tests/support/paper_beams.hpp"

namespace stridor {
namespace {

SetUpEstimate of_bytes(double bytes) {
  SetUpEstimate estimate;
  estimate.parts = {{"a.key", "something small", "take less", 0.25 * bytes},
                    {"b.key", "something large", "take fewer", 0.75 * bytes}};
  estimate.operations = 4e9 * 7200.0;
  return estimate;
}

TEST(SetUpEstimate, CountsUnknownsAndEntriesAsTheyAreAssembled) {
  for (const auto& [along, through] : {std::pair{1, 1}, {5, 1}, {4, 3}, {2, 7}}) {
    BeamParameters beam = test::paper_cantilever();
    beam.supports = {};
    beam.mesh = {along, through};
    const BodyMatrices made = make_beam(beam);
    const ReductionSize size = size_of(beam.mesh, beam.reduction, 0.0);
    EXPECT_EQ(size.unknowns, static_cast<double>(made.num_dofs()));
    const auto entries = static_cast<double>(made.mass.nonZeros() + made.stiffness.nonZeros());
    // Some entries of the stiffness cancel.
    EXPECT_GE(size.matrix_entries, entries);
    EXPECT_LE(size.matrix_entries, 1.5 * entries);
  }
}

TEST(SetUpEstimate, OfManyInterfaceUnknownsIsThatOfTheirConstraintModes) {
  const ReductionSize size{1e6, 1e4, 1e4, 20.0, 3e7, 2e7, 1e9};
  const SetUpEstimate estimate = estimate_reduction(size, "body", {".mesh", "less"});
  EXPECT_GT(estimate.bytes(), 8.0 * 1e6 * 1e4);
  EXPECT_LT(estimate.bytes(), 1.2 * 8.0 * (1e6 * 1e4 + 13.0 * 1e4 * 1e4));
  // A solve with the factor for each, and the mass they project.
  EXPECT_GT(estimate.operations, 1e4 * 4.0 * 2e7 + 1e6 * 1e8);
}

TEST(SetUpEstimate, OfManyModesIsThatOfTheKrylovSpace) {
  const ReductionSize size{1e6, 2.0, 2.0, 1000.0, 3e7, 2e7, 1e9};
  const SetUpEstimate estimate = estimate_reduction(size, "body", {".mesh", "less"});
  const auto& largest = estimate.parts.at(2);
  EXPECT_EQ(largest.key, "body.reduction.fixed_interface_modes");
  EXPECT_EQ(largest.bytes, 8.0 * 1e6 * (3240.0 + 2000.0 + 24.0));
}

TEST(SetUpEstimate, OfABodyWithoutReductionIsThatOfItsAssembly) {
  const ReductionSize size = size_of({900'000, 1}, {0}, 0.0);
  const SetUpEstimate estimate = estimate_reduction(size, "body", {".mesh", "less"});
  EXPECT_GT(estimate.bytes(), 256.0 * 9e5 * 28.0);
}

TEST(SetUpEstimate, OfADiscGrowsWithTheSquareOfItsModes) {
  ModelParameters model;
  PlateBodyParameters disc;
  disc.plate.nodal_diameters = 200;
  disc.plate.radial_modes = 40;
  model.substructures["disc"] = disc;
  const double whole = estimate_set_up(model).bytes();
  EXPECT_GT(whole, 8.9 * 8.0 * 16040.0 * 16040.0);
  disc.plate.radial_modes = 20;
  model.substructures["disc"] = disc;
  EXPECT_NEAR(estimate_set_up(model).bytes() / whole, 0.25, 1e-2);
}

TEST(SetUpEstimate, OfBoundaryElementsGrowsWithTheSquareOfTheGrid) {
  SlidingContactParameters contact;
  contact.grid = 4096;
  const double whole = estimate_set_up(contact, "contact.normal.solver").bytes();
  contact.grid = 2048;
  EXPECT_EQ(estimate_set_up(contact, "contact.normal.solver").bytes(), 0.25 * whole);
}

TEST(RequireMemory, AllowsWhatFits) {
  EXPECT_NO_THROW(require_memory(of_bytes(1e9), {1e9, "the memory"}));
  EXPECT_NO_THROW(require_memory({}, {0.0, "the memory"}));
}

TEST(RequireMemory, RefusesTheRestWithTheNumbersAndWhatToDo) {
  try {
    require_memory(of_bytes(40e9), {16e9, "the memory of this machine"});
    FAIL() << "nothing was refused";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().front().key, "b.key");
    EXPECT_EQ(error.problems().front().message,
              "the set-up would take about 40 GB of memory and 2 h of time, but the memory of this "
              "machine is 16 GB; the most of it, 30 GB, is for something large; take fewer");
  }
}

TEST(RequireMemory, RefusesResultsThatDoNotFit) {
  const MemoryPart results{"--points", "20 eigenvalues at 1000000 values", "ask for fewer", 10e9};
  EXPECT_NO_THROW(require_memory_for(results, {16e9, "the memory of this machine"}));
  try {
    require_memory_for(results, {8e9, "the memory of this machine"});
    FAIL() << "nothing was refused";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().front().key, "--points");
    EXPECT_EQ(error.problems().front().message,
              "20 eigenvalues at 1000000 values would take about 10 GB of memory, but the memory "
              "of this machine is 8 GB; ask for fewer");
  }
}

}  // namespace
}  // namespace stridor
