#include "core/tasks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using ::testing::Each;

const auto ignore = [](std::size_t, std::size_t) {};

TEST(Tasks, EachIsDoneOnceAndTold) {
  for (const int num_threads : {0, 1, 2, 5}) {
    std::vector<int> times(100, 0);
    std::vector<int> told(100, 0);
    std::size_t last = 0;
    run_tasks(
        times.size(), num_threads, [&](std::size_t task, std::size_t) { ++times[task]; },
        [&](std::size_t num_done, std::size_t task) {
          EXPECT_EQ(num_done, ++last);
          ++told[task];
        });
    EXPECT_THAT(times, Each(1));
    EXPECT_THAT(told, Each(1));
  }
}

TEST(Tasks, TheFirstFailureInOrderIsThrownWhateverTheThreads) {
  for (const int num_threads : {1, 2, 5}) {
    for (int repetition = 0; repetition < 20; ++repetition) {
      const auto fail = [](std::size_t task, std::size_t) {
        if (task >= 7) throw std::runtime_error("task " + std::to_string(task));
      };
      EXPECT_EQ(
          test::message_of<std::runtime_error>([&] { run_tasks(40, num_threads, fail, ignore); }),
          "task 7");
    }
  }
}

TEST(Tasks, AStopEndsThemWithoutAResult) {
  for (const int num_threads : {1, 2, 5}) {
    std::atomic<int> num_begun = 0;
    std::atomic<int> num_told = 0;
    const auto stop_in_third = [&](std::size_t task, std::size_t) {
      ++num_begun;
      if (task == 2) request_stop();
      // Those that others have begun are done, but none is begun after it.
      while (task > 2 && !stop_requested()) std::this_thread::yield();
    };
    EXPECT_THROW(
        run_tasks(40, num_threads, stop_in_third, [&](std::size_t, std::size_t) { ++num_told; }),
        Interrupted);
    request_stop(false);
    if (num_threads == 1) {
      EXPECT_EQ(num_begun, 3);
    }
    EXPECT_LE(num_begun, 2 + num_threads);
    EXPECT_EQ(num_told, num_begun);
  }
}

}  // namespace
}  // namespace stridor
