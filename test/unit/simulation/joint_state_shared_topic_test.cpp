/// @file
/// JointStatePlayer where several publishers share a topic, and where the joints are continuous.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "joint_state_player_fixture.h"

namespace tissue_contact {
namespace joint_state_shared_topic_test {

/// Drivers of an arm and of its jaw that share a topic: as their messages come in, every 10 ms; those of the jaw behind by so much.
Order ofTwoDrivers(int behind_ms) {
  Order order;
  for (int i = 0; i < 30; ++i) {
    const std::int64_t stamp = kSecond + i * 10 * kMillisecond;
    order.emplace_back(0, arm(stamp, 1e-4 * i));
    order.emplace_back(0, jaw(stamp - behind_ms * kMillisecond, -2e-4 * i));
  }
  return order;
}

TEST(JointStateSharedTopic, TwoDriversMayShareATopic) {
  for (const int behind_ms : {0, 3, 15, 49}) {
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    const Trace trace = runAll(*simulator, player, ofTwoDrivers(behind_ms));
    EXPECT_EQ(trace.stamps.size(), 30U) << behind_ms << " ms: one moment for each pair";
    EXPECT_TRUE(trace.pressed());
    EXPECT_EQ(simulator->jointPositions(0), Vector3(1e-4 * 29, 0.0, -2e-4 * 28)) << "the jaw as of the pair before";
    EXPECT_EQ(player.count(Verdict::kAccepted), 30);
    EXPECT_EQ(player.merged(), 30);
    EXPECT_EQ(player.waiting(), 0);
  }
}

TEST(JointStateSharedTopic, WhatTwoDriversShareDoesNotDependOnWhenItIsPlayed) {
  const Order order = ofTwoDrivers(3);
  const auto at_once = oneProbe();
  const auto one_by_one = oneProbe();
  JointStatePlayer first(*at_once);
  JointStatePlayer second(*one_by_one);
  for (const auto& [topic, s] : order) first.push(topic, s);
  EXPECT_TRUE(run(*at_once, first, {}) == runAll(*one_by_one, second, order));
}

/// Fastest motion of a joint from moment to moment, m/s.
struct Speed {
  double before = 0.0;
  std::int64_t before_ns = 0;
  double most = 0.0;

  void note(double position, std::int64_t stamp_ns) {
    if (before_ns > 0)
      most = std::max(most, std::abs(position - before) / (1e-9 * static_cast<double>(stamp_ns - before_ns)));
    before = position;
    before_ns = stamp_ns;
  }
};

// The jaw's way of 10 ms is not made in the .3 ms that are left when it becomes known.
TEST(JointStateSharedTopic, NobodyIsFasterForAnothersMoments) {
  for (const std::int64_t lead_us : {100, 300, 1000, 4000, 6000, 9900}) {
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    Speed speed;
    for (int i = 0; i < 60; ++i) {
      const std::int64_t stamp = kSecond + i * 10 * kMillisecond;
      player.push(0, arm(stamp - lead_us * 1000, 0.0));
      player.push(0, jaw(stamp, -5e-5 * i));
      while (const auto played = player.playNext()) speed.note(simulator->jointPositions(0).z(), played->stamp_ns);
      EXPECT_NEAR(simulator->jointPositions(0).z(), -5e-5 * i, 5e-5 + 1e-15) << "late by its own interval at most";
    }
    EXPECT_LE(speed.most, 2.0 * 5e-5 / 0.01 * (1.0 + 1e-9)) << lead_us;
    EXPECT_EQ(player.count(Verdict::kAccepted), 120);
  }
}

// The slower of two arms beside a live node, of which nothing is known when the faster one's moments are played.
TEST_F(TwoProbes, TheSlowerOneIsNoFasterForTheOthersMoments) {
  player.setPolicy(StatePolicy::kNewestState);
  Speed speed;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t stamp = kSecond + i * 10 * kMillisecond;
    player.push(0, sample(stamp, 0.0));
    player.stopWaiting();
    while (const auto played = player.playNext()) speed.note(simulator->jointPositions(1).z(), played->stamp_ns);
    if (i % 4 != 0) continue;
    player.push(1, sample(stamp + kMillisecond, -1e-5 * i));
    player.stopWaiting();
    while (const auto played = player.playNext()) speed.note(simulator->jointPositions(1).z(), played->stamp_ns);
    EXPECT_NEAR(simulator->jointPositions(1).z(), -1e-5 * i, 4e-5 + 1e-15);
  }
  EXPECT_LE(speed.most, 2.0 * 1e-5 / 0.01 * (1.0 + 1e-9));
  EXPECT_GE(speed.most, 1e-5 / 0.01 * (1.0 - 1e-9));
}

// A connection that was gone: the way takes a gap's time (.05 s here), as that of a single arm does.
TEST_F(TwoProbes, AfterAPauseBesideAnotherArmTheWayTakesAGap) {
  Speed speed;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t stamp = kSecond + i * 10 * kMillisecond;
    player.push(0, sample(stamp, 0.0));
    if (i < 20 || i >= 40) player.push(1, sample(stamp + kMillisecond / 2, -1e-5 * i));
    while (const auto played = player.playNext()) speed.note(simulator->jointPositions(1).z(), played->stamp_ns);
  }
  EXPECT_LE(speed.most, 2.0 * 2.1e-4 / 0.05) << "the way left out, and as much again for what is added meanwhile";
  EXPECT_NEAR(simulator->jointPositions(1).z(), -1e-5 * 99, 1.1e-5);
}

TEST_F(OneProbe, AJointOfASharedTopicThatSaysTheSameMomentTwiceIsRefused) {
  player.push(0, arm(kSecond, 0.001));
  player.push(0, jaw(kSecond, 0.001));
  player.push(0, jaw(kSecond, 0.002));
  player.push(0, jaw(kSecond - kMillisecond, 0.003));
  player.push(0, {kSecond - kMillisecond, {"x", "z"}, {0.003, 0.003}});
  player.push(0, arm(kSecond + 10 * kMillisecond, 0.001));
  drain(player);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0.001, 0.0, 0.001));
  EXPECT_EQ(player.count(Verdict::kDuplicateStamp), 1);
  EXPECT_EQ(player.count(Verdict::kLate), 2);
  EXPECT_EQ(player.count(Verdict::kAccepted), 2);
  EXPECT_EQ(player.merged(), 1);
}

TEST_F(OneProbe, WhatASharedTopicKeepsIsNotTakenIntoTheNextLoop) {
  player.push(0, arm(kSecond, 0.0));
  player.push(0, jaw(kSecond, -0.002));
  for (int i = 0; i < 3; ++i) player.push(0, arm(kSecond / 2 + i * 10 * kMillisecond, 0.0));
  drain(player);
  EXPECT_EQ(player.resets(), 1);
  EXPECT_EQ(simulator->jointPositions(0).z(), 0.0);
  EXPECT_EQ(countedBy(player), 5);
}

TEST(JointStateSharedTopic, ARecordingOfTwoDriversInALoopRepeatsItsBits) {
  for (const int behind_ms : {0, 3, 15}) {
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    Order both = ofTwoDrivers(behind_ms);
    const Order once = both;
    both.insert(both.end(), once.begin(), once.end());
    const Trace trace = runAll(*simulator, player, both);
    EXPECT_EQ(player.resets(), 1);
    ASSERT_EQ(trace.stamps.size(), 60U) << behind_ms;
    const auto half = static_cast<std::ptrdiff_t>(trace.forces.size() / 2);
    EXPECT_TRUE(std::equal(trace.forces.begin(), trace.forces.begin() + half, trace.forces.begin() + half))
        << behind_ms;
  }
}

// Late ones in a row go on for more than a gap and go back again, as a short recording in a loop does.
TEST(JointStateSharedTopic, ThreeDriversOfOneTopicAreNoLoop) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  Order order;
  for (int ms = 0; ms < 400; ms += 2) {
    const std::int64_t now = kSecond + ms * kMillisecond;
    if (ms % 20 == 0) order.emplace_back(0, JointStateSample{now, {"x"}, {1e-6 * ms}});
    order.emplace_back(0, JointStateSample{now - 30 * kMillisecond, {"y"}, {0.0}});
    order.emplace_back(0, jaw(now - 36 * kMillisecond, -1e-5 * ms));
  }
  runAll(*simulator, player, order);
  EXPECT_EQ(player.resets(), 0);
  EXPECT_EQ(countedBy(player), static_cast<std::int64_t>(order.size()));
}

TEST_F(OneProbe, OfASharedTopicTheNewestStateHasAllJoints) {
  player.setPolicy(StatePolicy::kNewestState);
  for (const auto& [topic, s] : ofTwoDrivers(3)) player.push(topic, s);
  drain(player);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(1e-4 * 29, 0.0, -2e-4 * 28));
  EXPECT_EQ(countedBy(player), 60);
}

/// A ball on an arm that a joint turns, 30 mm from its axis, and one that follows it at a multiple.
Simulator crank(const std::string& multiplier, const std::string& type = "continuous",
                const std::string& limit_rad = "4") {
  const std::string urdf =
      "<robot name='crank'><link name='base'/><link name='tip'><collision><origin xyz='0.03 0 0'/><geometry><sphere "
      "radius='0.005'/></geometry></collision></link><link name='geared'/><joint name='turn' type='" +
      type +
      "'><parent "
      "link='base'/><child link='tip'/><axis xyz='0 0 1'/><limit lower='-" +
      limit_rad + "' upper='" + limit_rad +
      "' effort='1' "
      "velocity='1'/></joint><joint name='gear' type='revolute'><parent "
      "link='base'/><child link='geared'/><axis xyz='0 0 1'/><limit lower='-9' upper='9' effort='1' "
      "velocity='1'/><mimic joint='turn' multiplier='" +
      multiplier + "'/></joint></robot>";
  return makeSimulator(blockScene() + "step: {max_step_s: 0.001, max_gap_s: 0.05}\n" + onlyBall("[0, 0, 0.1]"),
                       {{"probe", urdf}});
}

// Drivers give the angle of a continuous joint between -pi and pi: the tool went round a whole turn, through the tissue.
TEST(JointStateSharedTopic, AContinuousJointGoesTheShorterWay) {
  Simulator simulator = crank("-2");
  JointStatePlayer player(simulator);
  const double angles[] = {3.1, 3.14, -3.13, -3.1, 3.12, 3.12 + 4.0 * M_PI};
  const double turned[] = {3.1, 3.14, 2.0 * M_PI - 3.13, 2.0 * M_PI - 3.1, 3.12, 3.12};
  for (int i = 0; i < 6; ++i) {
    player.push(0, {kSecond + i * 10 * kMillisecond, {"turn"}, {angles[i]}});
    drain(player);
    EXPECT_NEAR(simulator.jointPositions(0)[0], turned[i], 1e-12) << i;
  }
  EXPECT_EQ(simulator.stepCount(), 50) << "a whole turn takes more";
  EXPECT_FALSE(simulator.report().jumped);
}

/// Where a joint is that is said to be at 3.1 rad, and then at these angles so many milliseconds later each.
std::vector<double> turned(const std::string& limit_rad, const std::vector<std::pair<int, double>>& said) {
  Simulator simulator = crank("1", "revolute", limit_rad);
  JointStatePlayer player(simulator);
  std::int64_t stamp = kSecond;
  player.push(0, {stamp, {"turn"}, {3.1}});
  drain(player);
  std::vector<double> found;
  for (const auto& [later_ms, angle] : said) {
    stamp += later_ms * kMillisecond;
    player.push(0, {stamp, {"turn"}, {angle}});
    drain(player);
    found.push_back(simulator.jointPositions(0)[0]);
  }
  return found;
}

// Some give those of all joints so: a wrist turned all the way round, and again at the next pause.
TEST(JointStateSharedTopic, ARevoluteJointGoesOnOverTurnsThatItsDriverLeavesOut) {
  const double over = 2.0 * M_PI;
  const auto expect_near = [](const std::vector<double>& found, const std::vector<double>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-12) << i;
  };
  for (const char* const limit : {"3.14", "0", "6.5"}) {
    SCOPED_TRACE(limit);
    expect_near(turned(limit, {{10, -3.1}, {10, -3.0}, {30, -3.0}, {300, -3.0}, {5000, -3.0}, {10, 3.1}, {10, 3.0}}),
                {over - 3.1, over - 3.0, over - 3.0, over - 3.0, over - 3.0, 3.1, 3.0});
    expect_near(turned(limit, {{45, 1.0}, {45, -2.0}, {45, 0.5}}), {1.0, -2.0, 0.5});  // no half turn at once
  }
  expect_near(turned("2.9", {{10, -3.1}}), {-3.1});  // never all the way round
}

TEST(JointStateSharedTopic, ASavedStateKnowsTheTurnsThatWereLeftOut) {
  Simulator simulator = crank("1", "revolute", "3.14");
  JointStatePlayer player(simulator);
  std::int64_t stamp = kSecond;
  const auto said = [&](JointStatePlayer& to, double angle) {
    to.push(0, {stamp += 10 * kMillisecond, {"turn"}, {angle}});
    drain(to);
  };
  for (const double angle : {3.1, -3.1}) said(player, angle);
  Simulator other = crank("1", "revolute", "3.14");
  JointStatePlayer restored(other);
  restored.restoreState(player.saveState());
  said(restored, -3.0);
  EXPECT_NEAR(other.jointPositions(0)[0], 2.0 * M_PI - 3.0, 1e-12);
}

TEST(JointStateSharedTopic, AWholeTurnOfAGearedJointIsNoneOfItsGear) {
  Simulator simulator = crank("0.1");
  JointStatePlayer player(simulator);
  for (const double angle : {3.1, -3.1}) {
    player.push(0, {kSecond + (angle < 0.0 ? 40 : 0) * kMillisecond, {"turn"}, {angle}});
    drain(player);
    EXPECT_EQ(simulator.jointPositions(0)[0], angle);
  }
}

// Another topic's moment lies on the way.
TEST(JointStateSharedTopic, OnTheWayAContinuousJointGoesTheShorterWayAsWell) {
  const std::string urdf =
      "<robot name='jaw'><link name='base'/><link name='slide'/><link name='tip'><collision><geometry><sphere "
      "radius='0.005'/></geometry></collision></link><joint name='z' type='prismatic'><parent link='base'/><child "
      "link='slide'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint><joint "
      "name='turn' "
      "type='continuous'><parent link='slide'/><child link='tip'/></joint></robot>";
  Simulator simulator =
      makeSimulator(blockScene() +
                        "step: {max_step_s: 0.001, max_gap_s: 0.05}\ninstruments:\n  - {name: probe, "
                        "robot_description: probe, tip_link: tip, contact_links: [tip], joint_state_topics: "
                        "[/arm, /jaw], base_pose: {position_m: [0, 0, 0.1]}}\n",
                    {{"probe", urdf}});
  JointStatePlayer player(simulator);
  for (const int ms : {0, 10}) player.push(1, {kSecond + ms * kMillisecond, {"turn"}, {ms == 0 ? 3.1 : -3.1}});
  for (const int ms : {0, 5}) player.push(0, {kSecond + ms * kMillisecond, {"z"}, {0.0}});
  drain(player);
  EXPECT_NEAR(simulator.jointPositions(0)[1], M_PI, 1e-12);
}

}  // namespace joint_state_shared_topic_test
}  // namespace tissue_contact
