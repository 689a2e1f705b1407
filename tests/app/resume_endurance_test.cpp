// Killed runs that go on, for longer than every day.
#include "tests/app/resume_fixture.hpp"

namespace stridor {
namespace {

TEST(ResumeEndurance, RunsKilledThreeHundredTimesGoOnBitwise) {
  test::kill_and_resume(300, 250);
}

}  // namespace
}  // namespace stridor
