#include "core/memory.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// A machine of 16 GiB as its files tell it.
class Memory : public testing::Test {
 protected:
  Memory() { put("proc/meminfo", "MemTotal:       16777216 kB\nMemFree:        1000 kB\n"); }
  void put(const std::string& file, const std::string& text) {
    const std::filesystem::path path = root_ / file;
    std::filesystem::create_directories(path.parent_path());
    test::write_file(path, text);
  }
  MemoryLimit limit(double address_space = unlimited) {
    return memory_limit(root_.path(), address_space);
  }

 private:
  test::TemporaryFolder root_;
};

TEST_F(Memory, IsThatOfTheMachineWhereNothingElseIsSaid) {
  EXPECT_EQ(limit().bytes, 0x1p34);
  EXPECT_EQ(limit().source, "the memory of this machine");
}

TEST_F(Memory, IsLimitedByTheAddressSpace) {
  EXPECT_EQ(limit(1e9).bytes, 1e9);
  EXPECT_EQ(limit(1e9).source, "the limit of its address space (ulimit -v)");
  EXPECT_EQ(limit(1e12).bytes, 0x1p34);
}

TEST_F(Memory, IsLimitedByAnyGroupAroundTheProcess) {
  put("proc/self/cgroup", "0::/jobs/one\n");
  put("sys/fs/cgroup/jobs/one/memory.max", "max\n");
  EXPECT_EQ(limit().bytes, 0x1p34);
  put("sys/fs/cgroup/jobs/memory.max", "2000000000\n");
  EXPECT_EQ(limit().bytes, 2e9);
  EXPECT_EQ(limit().source, "the memory of its control group");
  put("sys/fs/cgroup/memory.max", "1000000000\n");
  EXPECT_EQ(limit().bytes, 1e9);
}

TEST_F(Memory, IsLimitedByGroupsOfTheFirstVersion) {
  put("proc/self/cgroup", "5:cpu:/jobs\n4:hugetlb,memory:/jobs\n");
  put("sys/fs/cgroup/memory/jobs/memory.limit_in_bytes", "3000000000\n");
  put("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(limit().bytes, 3e9);
}

TEST_F(Memory, OfNoKnownSizeHasNoLimit) {
  const test::TemporaryFolder nothing;
  EXPECT_EQ(memory_limit(nothing.path(), unlimited).bytes, unlimited);
}

TEST(MemoryText, HasThreeDigits) {
  EXPECT_EQ(memory_text(18.93e9), "18.9 GB");
  EXPECT_EQ(memory_text(2.5e6), "2.5 MB");
  EXPECT_EQ(memory_text(1.3e14), "130 TB");
}

}  // namespace
}  // namespace stridor
