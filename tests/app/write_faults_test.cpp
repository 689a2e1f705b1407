// Runs that die or find the disk full at any of their writes. Every kind of fault at every write:
// write_faults_endurance_test.cpp.
#include "tests/app/write_faults_fixture.hpp"

namespace stridor {
namespace {

using namespace test;

class WriteFaults : public ::testing::TestWithParam<FaultyScene> {};

TEST_P(WriteFaults, ARunKilledAtAnyWriteGoesOnBitIdentically) {
  FaultTrial trial(GetParam());
  give_everywhere(trial, Fault::kill, 1);
  RecordProperty("kills", trial.num_given());
}

TEST_P(WriteFaults, ADiskThatIsFullAtAWriteLosesNothing) {
  FaultTrial trial(GetParam());
  give_everywhere(trial, Fault::full, 3);
  RecordProperty("full_disks", trial.num_given());
}

INSTANTIATE_TEST_SUITE_P(Of, WriteFaults, ::testing::ValuesIn(faulty_scenes()), name_of_scene);

}  // namespace
}  // namespace stridor
