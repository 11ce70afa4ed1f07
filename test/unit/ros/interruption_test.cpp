/// Ctrl-C and SIGTERM of a replay: the first is noted, the second, of either kind, ends the process at once.
#include "ros/replay/interruption.h"

#include <gtest/gtest.h>

#include <csignal>

namespace tissue_contact {
namespace interruption_test {

TEST(SignalWatch, NotesTheFirst) {
  for (const int number : {SIGINT, SIGTERM}) {
    const SignalWatch watch;
    EXPECT_EQ(SignalWatch::signal(), 0);
    std::raise(number);
    EXPECT_EQ(SignalWatch::signal(), number);
  }
}

TEST(SignalWatch, TheSecondEndsTheProcess) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  for (const int first : {SIGINT, SIGTERM}) {
    for (const int second : {SIGINT, SIGTERM}) {
      const auto twice = [&] {
        const SignalWatch watch;
        std::raise(first);
        std::raise(second);
      };
      EXPECT_EXIT(twice(), testing::KilledBySignal(second), "") << first << ", then " << second;
    }
  }
}

}  // namespace interruption_test
}  // namespace tissue_contact
