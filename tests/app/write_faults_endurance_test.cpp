// Every kind of fault at every write of a run, for every kind of scene.
#include "tests/app/write_faults_fixture.hpp"

namespace stridor {
namespace {

using namespace test;

class WriteFaultsEverywhere : public ::testing::TestWithParam<FaultyScene> {};

TEST_P(WriteFaultsEverywhere, NothingIsLost) {
  FaultTrial trial(GetParam());
  for (const Fault fault : {Fault::kill, Fault::torn, Fault::no_space, Fault::full}) {
    const int before = trial.num_given();
    give_everywhere(trial, fault, 1);
    if (HasFatalFailure()) return;
    fmt::print("fault {}: {} injections\n", static_cast<int>(fault), trial.num_given() - before);
  }
}

// Where there is no room for a copy, results go into the file itself.
TEST_P(WriteFaultsEverywhere, ARunKilledAfterAFailedWriteGoesOnBitIdentically) {
  FaultTrial trial(GetParam());
  for (const bool is_resumed : {false, true}) {
    const long count = trial.num_calls(is_resumed);
    for (long at = 1; at <= count; ++at) {
      // Four of the 24 calls after it, other ones for the next call.
      for (long k = 0; k < 4; ++k) {
        const long death = at + 1 + (7 * at + 6 * k) % 24;
        SCOPED_TRACE(fmt::format("no room at call {}, death at {} of {}, {}", at, death, count,
                                 is_resumed ? "resumed" : "from the beginning"));
        ASSERT_NO_FATAL_FAILURE(trial.give({Fault::no_space_kill, at, death, 0}, is_resumed));
      }
    }
  }
  fmt::print("{} injections\n", trial.num_given());
}

INSTANTIATE_TEST_SUITE_P(Of, WriteFaultsEverywhere, ::testing::ValuesIn(faulty_scenes()),
                         name_of_scene);

}  // namespace
}  // namespace stridor
