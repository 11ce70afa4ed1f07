/// @file
/// What a person sees of a long replay.
#include "ros/replay/replay_progress.h"

#include <gtest/gtest.h>

#include <sstream>

namespace tissue_contact {
namespace replay_progress_test {

TEST(ReplayProgress, LogHasWholeLinesEveryTenSeconds) {
  std::ostringstream out;
  {
    ReplayProgress progress(out, false, "replay: ", 40.0);
    for (int i = 0; i <= 250; ++i) progress.at(0.1 * i, 0.1 * i);
  }
  EXPECT_EQ(out.str(),
            "replay: 25.0 % of 40 s, 1 times real time, 30 s left\n"
            "replay: 50.0 % of 40 s, 1 times real time, 20 s left\n");
}

TEST(ReplayProgress, SlowReplayNeverRepeatsAFigureThatTheTimeLeftContradicts) {
  std::ostringstream out;
  ReplayProgress progress(out, false, "", 100.0);
  progress.at(1.0, 100.0);
  progress.at(1.1, 110.0);
  EXPECT_EQ(out.str(),
            "1.0 % of 100 s, 0.01 times real time, 2:45:00 h left\n"
            "1.1 % of 100 s, 0.01 times real time, 2:44:50 h left\n");
}

TEST(ReplayProgress, TerminalHasOneLineRewrittenEverySecondAndTakenAwayInTheEnd) {
  std::ostringstream out;
  {
    ReplayProgress progress(out, true, "", 200.0);
    for (int i = 0; i <= 25; ++i) progress.at(0.2 * i, 0.1 * i);
  }
  EXPECT_EQ(out.str(),
            "\r1.0 % of 200 s, 2 times real time, 1:39 min left\033[K"
            "\r2.0 % of 200 s, 2 times real time, 1:38 min left\033[K"
            "\r\033[K");
}

TEST(ReplayProgress, NothingForShortRunsAndBagsWithoutLength) {
  std::ostringstream out;
  {
    ReplayProgress quick(out, true, "", 10.0);
    quick.at(9.0, 0.9);
    ReplayProgress empty(out, true, "", 0.0);
    empty.at(0.0, 100.0);
    ReplayProgress stuck(out, false, "", 10.0);
    stuck.at(0.0, 100.0);  // no speed yet: no time left, and no division by zero
  }
  EXPECT_EQ(out.str(), "0.0 % of 10 s, 0 times real time\n");
}

}  // namespace replay_progress_test
}  // namespace tissue_contact
