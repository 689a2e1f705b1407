#include "core/activity.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace stridor {
namespace {

int num_idle = 0;

TEST(Activity, TellsWhatTheMainThreadIsAtTheOutermostFirst) {
  EXPECT_EQ(current_activity().what, "");
  const Activity outer("reducing");
  EXPECT_EQ(current_activity().what, "reducing");
  {
    Activity inner("modes");
    inner.report(0.5);
    EXPECT_EQ(current_activity().what, "reducing: modes");
    EXPECT_EQ(current_activity().fraction, 0.5);
  }
  EXPECT_EQ(current_activity().what, "reducing");
  EXPECT_EQ(current_activity().fraction, 0.0);
}

TEST(Activity, IsCountedAnewWheneverItChanges) {
  const Activity outer("reducing");
  const auto before = current_activity().count;
  std::uint64_t inside = 0;
  {
    const Activity inner("modes");
    inside = current_activity().count;
  }
  EXPECT_NE(before, inside);
  EXPECT_NE(current_activity().count, inside);
  EXPECT_NE(current_activity().count, before);
}

TEST(Activity, OfOtherThreadsIsNotTold) {
  std::thread([] {
    Activity task("a task of many");
    task.report(0.9);
    EXPECT_EQ(current_activity().what, "");
  }).join();
}

TEST(Activity, SaysWhenTheOutermostEnds) {
  on_idle([] { ++num_idle; });
  {
    const Activity outer("reducing");
    { const Activity inner("modes"); }
    EXPECT_EQ(num_idle, 0);
  }
  EXPECT_EQ(num_idle, 1);
  on_idle(nullptr);
}

}  // namespace
}  // namespace stridor
