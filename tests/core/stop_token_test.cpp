#include "core/stop_token.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "core/errors.hpp"
#include "tests/support/temporary_folder.hpp"

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

TEST_F(StopToken, SignalRequestsAStopWhereSomethingWouldBeLost) {
  for (const int signal : {SIGINT, SIGTERM}) {
    request_stop(false);
    install_stop_signals();
    const OrderlyStop something_to_lose;
    std::raise(signal);
    EXPECT_TRUE(stop_requested()) << signal;
  }
}

TEST_F(StopToken, RequestIsThrownWhereItIsAskedFor) {
  EXPECT_NO_THROW(throw_if_stopped());
  request_stop();
  EXPECT_THROW(throw_if_stopped(), Interrupted);
}

TEST_F(StopToken, SignalEndsTheProgramAtOnceWhereNothingWouldBeLost) {
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EXIT(
        {
          install_stop_signals();
          { const OrderlyStop over; }
          std::raise(signal);
          std::_Exit(0);
        },
        testing::ExitedWithCode(stopped_exit_code),
        "stridor: stopped on request\nnothing has been written\n");
  }
}

TEST_F(StopToken, SignalInAnotherThreadEndsTheProgramToo) {
  EXPECT_EXIT(
      {
        install_stop_signals();
        std::thread([] { std::raise(SIGTERM); }).join();
        std::_Exit(0);
      },
      testing::ExitedWithCode(stopped_exit_code), "");
}

/// Compares the files that the program leaves behind, so both sides must have the same files.
class StopTokenAtOnce : public StopToken {
 protected:
  StopTokenAtOnce() { testing::GTEST_FLAG(death_test_style) = "fast"; }
};

TEST_F(StopTokenAtOnce, RemovesUnfinishedFilesAndFoldersAndNoOthers) {
  const test::TemporaryFolder folder;
  const std::string part = (folder / "part").string();
  const std::string scratch = (folder / "scratch").string();
  const std::string inside = (folder / "scratch/script").string();
  const std::string finished = (folder / "finished").string();
  std::filesystem::create_directory(scratch);
  for (const std::string& file : {part, inside, finished}) test::write_file(file, "text");
  EXPECT_EXIT(
      {
        install_stop_signals();
        const UnfinishedFile first(scratch);
        const UnfinishedFile second(inside);
        const UnfinishedFile third(part);
        const UnfinishedFile missing((folder / "missing").string());
        { const UnfinishedFile over(finished); }
        note_written_file();
        std::raise(SIGTERM);
        std::_Exit(0);
      },
      testing::ExitedWithCode(stopped_exit_code), "files written before are whole");
  EXPECT_EQ(folder.files(), std::vector<std::string>{"finished"});
}

TEST_F(StopTokenAtOnce, EndsAHelperToo) {
  const pid_t helper = fork();
  if (helper == 0) {
    pause();
    _exit(0);
  }
  EXPECT_EXIT(
      {
        install_stop_signals();
        const HelperProcess running(helper);
        std::raise(SIGTERM);
        std::_Exit(0);
      },
      testing::ExitedWithCode(stopped_exit_code), "");
  int status = 0;
  ASSERT_EQ(waitpid(helper, &status, 0), helper);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

TEST_F(StopTokenAtOnce, IsToldAsJsonWhereThatIsWanted) {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  EXPECT_EXIT(
      {
        if (std::freopen(out.c_str(), "w", stdout) == nullptr) std::_Exit(1);
        install_stop_signals();
        tell_stop_as_json();
        std::raise(SIGTERM);
        std::_Exit(0);
      },
      testing::ExitedWithCode(stopped_exit_code), "");
  EXPECT_EQ(test::contents_of(out),
            "{\"errors\": [{\"code\": \"interrupted\", \"message\": \"stopped on request; nothing "
            "has been written\"}]}\n");
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
        const OrderlyStop something_to_lose;
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
        const OrderlyStop something_to_lose;
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
        const OrderlyStop something_to_lose;
        std::raise(SIGINT);
        std::raise(SIGTERM);
        std::_Exit(0);
      },
      testing::KilledBySignal(SIGTERM), "");
  EXPECT_EXIT(
      {
        install_stop_signals();
        const OrderlyStop something_to_lose;
        std::raise(SIGTERM);
        std::raise(SIGINT);
        std::_Exit(0);
      },
      testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace stridor
