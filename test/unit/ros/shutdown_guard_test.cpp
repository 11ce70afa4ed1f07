/// @file
/// SIGINT and SIGTERM: the program is asked, and left where it does not listen.
#include "ros/node/shutdown_guard.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <thread>

namespace tissue_contact {
namespace shutdown_guard_test {

void waitFor(const ShutdownGuard& guard) {
  while (!guard.asked()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

[[noreturn]] void hang() {
  for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
}

class ShutdownGuardTest : public testing::Test {
 protected:
  void SetUp() override { ::testing::GTEST_FLAG(death_test_style) = "threadsafe"; }
};

TEST_F(ShutdownGuardTest, ASignalOnlyAsks) {
  for (const int number : {SIGINT, SIGTERM}) {
    ShutdownGuard guard;
    EXPECT_FALSE(guard.asked());
    std::raise(number);
    waitFor(guard);
  }
}

TEST_F(ShutdownGuardTest, SoDoesTheProgramItself) {
  ShutdownGuard guard;
  guard.ask();
  EXPECT_TRUE(guard.asked());
}

TEST_F(ShutdownGuardTest, ThereIsOneAtATime) {
  const ShutdownGuard guard;
  EXPECT_THROW(ShutdownGuard(), std::runtime_error);
}

TEST_F(ShutdownGuardTest, AProgramThatHangsIsLeftAfterItsLastWords) {
  for (const int number : {SIGINT, SIGTERM}) {
    const auto hangs = [number] {
      ShutdownGuard guard;
      guard.setLastWords([] { std::fputs("counts\n", stderr); });
      std::raise(number);
      hang();
    };
    EXPECT_EXIT(hangs(), testing::ExitedWithCode(0), "counts");
  }
}

TEST_F(ShutdownGuardTest, LastWordsThatHangDoNotHoldItUp) {
  const auto hangs = [] {
    ShutdownGuard guard;
    guard.setLastWords([] { hang(); });
    guard.ask();
    hang();
  };
  EXPECT_EXIT(hangs(), testing::ExitedWithCode(0), "");
}

TEST_F(ShutdownGuardTest, RepeatedSignalsDoNotCutTheTimeShort) {
  const auto ends_by_itself = [] {
    ShutdownGuard guard;
    for (int i = 0; i < 100; ++i) std::raise(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    std::_Exit(7);
  };
  EXPECT_EXIT(ends_by_itself(), testing::ExitedWithCode(7), "");
}

}  // namespace shutdown_guard_test
}  // namespace tissue_contact
