#include "core/stop_token.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <thread>

namespace stridor {
namespace {

class StopToken : public testing::Test {
 protected:
  StopToken() {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    request_stop(false);
  }
  ~StopToken() override {
    request_stop(false);
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
  }
};

TEST_F(StopToken, NothingIsRequestedAtFirst) {
  EXPECT_FALSE(stop_requested());
}

TEST_F(StopToken, RequestHoldsUntilItIsTakenBack) {
  request_stop();
  EXPECT_TRUE(stop_requested());
  EXPECT_TRUE(stop_requested());
  request_stop(false);
  EXPECT_FALSE(stop_requested());
}

TEST_F(StopToken, InstallingRequestsNothing) {
  install_stop_signals();
  EXPECT_FALSE(stop_requested());
}

TEST_F(StopToken, InterruptSignalRequestsAStop) {
  install_stop_signals();
  std::raise(SIGINT);
  EXPECT_TRUE(stop_requested());
}

TEST_F(StopToken, TerminateSignalRequestsAStop) {
  install_stop_signals();
  std::raise(SIGTERM);
  EXPECT_TRUE(stop_requested());
}

TEST_F(StopToken, RequestIsSeenByAnotherThread) {
  std::atomic<bool> has_seen{false};
  std::thread loop([&] {
    while (!stop_requested()) std::this_thread::yield();
    has_seen = true;
  });
  request_stop();
  loop.join();
  EXPECT_TRUE(has_seen);
}

TEST_F(StopToken, SecondInterruptEndsTheProgram) {
  EXPECT_EXIT(
      {
        install_stop_signals();
        std::raise(SIGINT);
        std::raise(SIGINT);
        std::_Exit(0);
      },
      testing::KilledBySignal(SIGINT), "");
}

TEST_F(StopToken, SecondTerminateEndsTheProgram) {
  EXPECT_EXIT(
      {
        install_stop_signals();
        std::raise(SIGTERM);
        std::raise(SIGTERM);
        std::_Exit(0);
      },
      testing::KilledBySignal(SIGTERM), "");
}

TEST_F(StopToken, SecondSignalOfTheOtherKindEndsTheProgram) {
  EXPECT_EXIT(
      {
        install_stop_signals();
        std::raise(SIGINT);
        std::raise(SIGTERM);
        std::_Exit(0);
      },
      testing::KilledBySignal(SIGTERM), "");
  EXPECT_EXIT(
      {
        install_stop_signals();
        std::raise(SIGTERM);
        std::raise(SIGINT);
        std::_Exit(0);
      },
      testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace stridor
