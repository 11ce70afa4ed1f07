/// @file
/// Joint states that would move a tool silently to a wrong place: other names, other units, other clocks.
#include "ros/joint_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "support/text_scene.h"

namespace tissue_contact {
namespace joint_watch_test {

/// A slide x of 0 to 0.2 m, a hinge y without limits worth the name, and a continuous joint z.
const char kRobot[] =
    "<robot name='r'><link name='a'/><link name='b'/><link name='c'/><link name='tip'><collision><geometry>"
    "<sphere radius='0.005'/></geometry></collision></link>"
    "<joint name='x' type='prismatic'><parent link='a'/><child link='b'/>"
    "<limit lower='0' upper='0.2' effort='1' velocity='1'/></joint>"
    "<joint name='y' type='revolute'><parent link='b'/><child link='c'/>"
    "<limit lower='0' upper='0' effort='0' velocity='0'/></joint>"
    "<joint name='z' type='continuous'><parent link='c'/><child link='tip'/></joint></robot>";

class JointWatchOfOneArm : public testing::Test {
 protected:
  void hear(const std::vector<std::string>& names, const std::vector<double>& positions) {
    watch.note(0, {1, names, positions}, 1.0);
  }

  Simulator simulator = makeSimulator(blockScene() + onlyBall("[0, 0, 0.5]"), {{"probe", kRobot}});
  JointStatePlayer player{simulator};
  JointWatch watch{simulator, player, 1.0};
};

TEST_F(JointWatchOfOneArm, UsualStatesAreNoFinding) {
  hear({"x", "y", "z"}, {0.1, 0.0, 0.0});
  hear({"x", "y", "z"}, {-0.19, 90.0, 1e6});  // just within one more range; joints without limits
  hear({"x", "y", "z", "other_arm"}, {0.39, 0.0, 0.0, 1e9});
  hear({"x"}, {});
  EXPECT_EQ(watch.findings(), std::vector<std::string>());
  EXPECT_EQ(watch.takeNews(0.0), std::vector<std::string>());
  EXPECT_EQ(watch.takeNews(100.0), std::vector<std::string>());
}

TEST_F(JointWatchOfOneArm, MillimetresAreFarOutsideTheLimits) {
  hear({"z", "x", "y"}, {0.0, 120.0, 0.0});
  hear({"z", "x", "y"}, {0.0, 130.0, 0.0});
  const std::vector<std::string> lines = watch.findings();
  ASSERT_EQ(lines.size(), 1U);
  for (const char* words : {"'probe'", "x at 120 (0 to 0.2)", "rad and m", "joint_names"}) {
    EXPECT_NE(lines[0].find(words), std::string::npos) << words << " in: " << lines[0];
  }
  EXPECT_EQ(watch.takeNews(0.0), lines);
  EXPECT_EQ(watch.takeNews(1.0), std::vector<std::string>()) << "told twice";
}

TEST_F(JointWatchOfOneArm, APositionThatIsNoNumberIsNotOutside) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) hear({"x", "y", "z"}, {bad, 0.0, 0.0});
  EXPECT_EQ(watch.findings(), std::vector<std::string>());
}

TEST_F(JointWatchOfOneArm, AJointThatGoesByAnotherNameIsFoundOnceEveryTopicHadTime) {
  hear({"x", "y", "wrist"}, {0.1, 0.0, 0.0});
  const std::vector<std::string> lines = watch.findings();
  ASSERT_EQ(lines.size(), 1U);
  for (const char* words : {"'probe'", "puts them: z", "none of its independent joints: wrist", "joint_names"}) {
    EXPECT_NE(lines[0].find(words), std::string::npos) << words << " in: " << lines[0];
  }
  EXPECT_EQ(watch.takeNews(10.0), std::vector<std::string>());
  EXPECT_EQ(watch.takeNews(14.9), std::vector<std::string>());
  EXPECT_EQ(watch.takeNews(15.0), lines);
  EXPECT_EQ(watch.takeNews(30.0), std::vector<std::string>()) << "told twice";
}

TEST_F(JointWatchOfOneArm, AJointThatAMessageNamesTwiceIsToldOnce) {
  hear({"x", "y", "x", "z"}, {0.1, 0.0, 0.15, 0.0});
  const std::vector<std::string> lines = watch.findings();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("more than once: x. The last position counts"), std::string::npos) << lines[0];
  EXPECT_EQ(watch.takeNews(0.0), lines);
  EXPECT_EQ(watch.takeNews(1.0), std::vector<std::string>()) << "told twice";
}

/// The same with y on a topic that only updates.
class JointWatchOfAnArmAndAJaw : public testing::Test {
 protected:
  /// From 1 s on, ten of each, 200 ms apart.
  void play(double jaw_ahead_s, int jaws) {
    for (int i = 0; i < 10; ++i) {
      const std::int64_t stamp = 1000000000LL + i * 200000000LL;
      if (i < jaws) hear(1, {stamp + static_cast<std::int64_t>(1e9 * jaw_ahead_s), {"y"}, {0.0}});
      hear(0, {stamp, {"x", "z"}, {0.1, 0.0}});
    }
    player.finish();
    drain();
  }
  void hear(int topic, const JointStateSample& sample) {
    watch.note(topic, sample, 1e-9 * static_cast<double>(sample.stamp_ns));
    player.push(topic, sample);
    drain();
  }
  void drain() {
    while (player.playNext()) watch.notePlayed();
  }

  Simulator simulator = makeSimulator(
      blockScene() +
          "instruments:\n  - {name: probe, robot_description: probe, tip_link: tip, contact_links: [tip], "
          "joint_state_topics: [/arm/js, /arm/jaw/js], base_pose: {position_m: [0, 0, 0.5]}}\n",
      {{"probe", kRobot}});
  JointStatePlayer player{simulator};
  JointWatch watch{simulator, player, 1.0};
};

TEST_F(JointWatchOfAnArmAndAJaw, OneThatKeepsUpIsNoFinding) {
  play(0.5, 10);  // within max_gap_s
  EXPECT_EQ(watch.findings(), std::vector<std::string>());
  EXPECT_EQ(watch.takeNews(0.0), std::vector<std::string>());
}

TEST_F(JointWatchOfAnArmAndAJaw, OneThatIsAheadIsToldOnce) {
  play(3600.0, 10);
  const std::vector<std::string> lines = watch.findings();
  ASSERT_EQ(lines.size(), 1U);
  for (const char* words : {"/arm/jaw/js", "by up to 3600 s", "max_gap_s is 1", "NTP", "header.stamp"}) {
    EXPECT_NE(lines[0].find(words), std::string::npos) << words << " in: " << lines[0];
  }
  EXPECT_EQ(watch.takeNews(0.0), lines);
  EXPECT_EQ(watch.takeNews(1.0), std::vector<std::string>()) << "told twice";
}

TEST_F(JointWatchOfAnArmAndAJaw, OneThatEndsBeforeTheOtherIsToldAtTheEnd) {
  play(0.0, 3);
  const std::vector<std::string> lines = watch.findings();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("for 1.4 s no joint state came on /arm/jaw/js"), std::string::npos) << lines[0];
  EXPECT_EQ(watch.takeNews(0.0), std::vector<std::string>()) << "TopicSilence tells it";
}

TEST_F(JointWatchOfOneArm, AJawThatWasNotRecordedIsNoFinding) {
  hear({"x", "y"}, {0.1, 0.0});
  EXPECT_EQ(watch.findings(), std::vector<std::string>());
}

/// x and y at 250 Hz and z at 100 Hz from drivers of their own on one topic, from 1 s on. The one of z ends after 1.2 s, and its force went
/// on at 0.1475 N, where 0 was right, with "running" and no word.
TEST_F(JointWatchOfOneArm, AJointWhoseDriverEndsOnASharedTopicIsTold) {
  std::vector<std::string> told;
  const auto hearAt = [&](int ms, const std::vector<std::string>& names) {
    watch.note(0, {1000000LL * ms, names, std::vector<double>(names.size(), 0.1)}, 1e-3 * ms);
    for (const std::string& line : watch.takeNews(1e-3 * ms)) told.push_back(line);
  };
  for (int ms = 1000; ms <= 4000; ++ms) {
    if (ms % 4 == 0) hearAt(ms, {"x", "y"});
    if (ms % 10 == 0 && ms < 2200) hearAt(ms, {"z"});
    if (ms == 2900) {
      EXPECT_EQ(told, std::vector<std::string>());
    }
  }
  ASSERT_EQ(told.size(), 1U) << "once";
  for (const char* words : {"for 1 s no joint state on /js, where others come, has named", "'probe': z", "driver"}) {
    EXPECT_NE(told[0].find(words), std::string::npos) << words << " in: " << told[0];
  }
  EXPECT_EQ(watch.silentJoints().find("for 1 s no joint state on /js"), 0U) << watch.silentJoints();
  const std::vector<std::string> lines = watch.findings();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("for 1.81 s no joint state on /js, where others came, named"), std::string::npos) << lines[0];
  for (int ms = 4004; ms < 4400; ms += 4) hearAt(ms, {"x", "y", "z"});
  EXPECT_EQ(watch.silentJoints(), "");
  EXPECT_EQ(watch.findings().size(), 1U) << "it was silent all the same";
  EXPECT_EQ(told.size(), 1U);
}

}  // namespace joint_watch_test
}  // namespace tissue_contact
