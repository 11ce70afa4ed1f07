/// @file
/// What is said of joint-state topics on which nothing comes, and how often.
#include "ros/node/topic_silence.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

namespace tissue_contact {
namespace topic_silence_test {

using Heard = std::vector<std::optional<double>>;
using Lines = std::vector<std::string>;

constexpr double kLongest_s = 2.0;

TopicSilence twoArms() { return TopicSilence({"/a", "/b"}, {true, true}, kLongest_s); }

TEST(TopicSilence, AnArmThatEndsIsToldOfOncePerSilence) {
  TopicSilence silence = twoArms();
  EXPECT_EQ(silence.look({100.0, 100.0}, 100.5), Lines());
  EXPECT_EQ(silence.look({101.0, 100.1}, 101.0), Lines());
  EXPECT_EQ(silence.look({102.0, 100.1}, 102.0), Lines());
  EXPECT_EQ(silence.summary(), "");
  const Lines told = silence.look({103.2, 100.1}, 103.2);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].rfind("no joint state for 3 s on /b, while others come: what it moves stays", 0), 0U) << told[0];
  EXPECT_EQ(silence.summary(), "no joint state for 3 s on /b, while others come");
  EXPECT_EQ(silence.look({104.2, 100.1}, 104.2), Lines());
  EXPECT_EQ(silence.summary(), "no joint state for 4 s on /b, while others come");
  EXPECT_EQ(silence.look({105.0, 105.0}, 105.1), Lines());  // it is back
  EXPECT_EQ(silence.summary(), "");
  EXPECT_EQ(silence.look({107.0, 105.0}, 107.0), Lines());
  EXPECT_EQ(silence.look({108.0, 105.0}, 108.1).size(), 1U);
}

TEST(TopicSilence, TheEndOfARecordingIsNoNewsForTheLog) {
  TopicSilence silence = twoArms();
  EXPECT_EQ(silence.look({100.0, 100.0}, 100.5), Lines());
  for (int s = 1; s <= 10; ++s) EXPECT_EQ(silence.look({100.1, 100.1}, 100.5 + s), Lines());
  EXPECT_EQ(silence.summary(), "no joint state for 10 s on /a; no joint state for 10 s on /b");
}

/// Every third of a hertz, beside a fast one.
TEST(TopicSilence, ASlowDriverIsNotSilent) {
  TopicSilence silence = twoArms();
  for (int s = 0; s < 60; ++s) {
    EXPECT_EQ(silence.look({1.0 * s, s < 5 ? std::optional<double>() : 3.0 * (s / 3)}, s + 0.1), Lines()) << s;
    EXPECT_EQ(silence.summary(), "") << s;
  }
  Lines told;
  for (int s = 60; s < 75 && told.empty(); ++s) told = silence.look({1.0 * s, 57.0}, s + 0.1);
  EXPECT_EQ(told.size(), 1U);
}

/// Neither a recording that is played again after a pause nor a process that was stopped makes a driver a slow one.
TEST(TopicSilence, APauseIsNoUsualInterval) {
  for (const bool held_up : {false, true}) {
    TopicSilence silence = twoArms();
    for (int s = 0; s < 5; ++s) silence.look({1.0 * s, 1.0 * s}, s);
    for (int s = 5; s < 65 && !held_up; ++s) silence.look({4.0, 4.0}, s);
    for (int s = 65; s < 70; ++s) EXPECT_EQ(silence.look({1.0 * s, 1.0 * s}, s), Lines());
    EXPECT_EQ(silence.summary(), "");
    Lines told;
    for (int s = 70; s < 74; ++s) {
      for (const std::string& line : silence.look({1.0 * s, 69.0}, s)) told.push_back(line);
    }
    EXPECT_EQ(told.size(), 1U) << held_up;
  }
}

TEST(TopicSilence, AProcessThatWasHeldUpHasNotReadWhatCame) {
  TopicSilence silence = twoArms();
  silence.look({1.0, 1.0}, 1.0);
  silence.look({2.0, 2.0}, 2.0);
  EXPECT_EQ(silence.look({7.0, 2.0}, 7.0), Lines());
  EXPECT_EQ(silence.summary(), "");
}

TEST(TopicSilence, TopicsThatNeverComeAreToldOfAfterTenSeconds) {
  TopicSilence none = twoArms();
  EXPECT_EQ(none.look(Heard(2), 1.0), Lines());
  for (int s = 2; s < 11; ++s) EXPECT_EQ(none.look(Heard(2), s), Lines());
  const Lines all = none.look(Heard(2), 11.0);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].rfind("no joint state yet, within 10 s, on /a, /b: nothing moves", 0), 0U) << all[0];
  EXPECT_EQ(none.look(Heard(2), 12.0), Lines());
  EXPECT_EQ(none.summary(), "");

  TopicSilence one({"/a", "/b", "/b/jaw"}, {true, true, false}, kLongest_s);  // a jaw that was not recorded is usual
  Lines missing;
  for (int s = 0; s <= 20; ++s) {
    const Lines now = one.look({s < 5 ? std::optional<double>() : 1.0 * s, {}, {}}, s);
    EXPECT_EQ(now.size(), s == 15 ? 1U : 0U) << s;  // ten seconds after the first of all
    missing.insert(missing.end(), now.begin(), now.end());
  }
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing[0].rfind("no joint state yet on /b, while others come", 0), 0U) << missing[0];
}

}  // namespace topic_silence_test
}  // namespace tissue_contact
