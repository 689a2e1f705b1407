// Run files under many kills and with an index of several levels: what takes too long for every
// day.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <random>
#include <vector>

#include "tests/io/run_file_fixture.hpp"

namespace stridor {
namespace {

using namespace test;

using RunFileEndurance = RunFile;

// A node of the chunk index takes 64 pieces and is left half full by a split: more than 32 · 64
// pieces make a tree of three levels.
TEST_F(RunFileEndurance, IsReadableAfterEveryWriteWithAnIndexOfThreeLevels) {
  check_after_every_write(path(), 2200);
}

// Processes that keep the processor busy, so that a kill may find the writer at any place.
class Load {
 public:
  explicit Load(int count) {
    for (int i = 0; i < count; ++i) {
      children_.push_back(fork());
      if (children_.back() != 0) continue;
      for (std::atomic<unsigned> work{0};;) ++work;
    }
  }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;
  ~Load() {
    for (const pid_t child : children_) {
      if (child <= 0) continue;
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
    }
  }

 private:
  std::vector<pid_t> children_;
};

TEST_F(RunFileEndurance, SurvivesThreeHundredKillsUnderLoad) {
  const Load load(4);
  std::mt19937 random(20250101);
  std::uniform_int_distribution<int> delay(0, 60000);
  for (int trial = 0; trial < 300; ++trial) {
    write_until_killed(path(), std::chrono::microseconds(delay(random)));
    ASSERT_FALSE(HasFailure()) << "kill " << trial;
  }
}

}  // namespace
}  // namespace stridor
