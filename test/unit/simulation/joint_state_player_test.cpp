/// @file
/// JointStatePlayer on one topic: placement, advancing, refusals, gaps and loops.
#include <limits>
#include <set>
#include <stdexcept>

#include "joint_state_player_fixture.h"

namespace tissue_contact {
namespace joint_state_player_test {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

PlayedSample playOne(JointStatePlayer& player, int topic, const JointStateSample& s) {
  player.push(topic, s);
  const std::vector<PlayedSample> all = drain(player);
  EXPECT_EQ(all.size(), 1U);
  return all.empty() ? PlayedSample() : all.front();
}

TEST(JointStatePlayer, ListsDistinctTopicsInOrderOfFirstMention) {
  const auto simulator = blockTouchedBy(probe("a", "/second, /first", -0.015) + probe("b", "/first, /third", 0.015));
  const JointStatePlayer player(*simulator);
  EXPECT_EQ(player.topics(), (std::vector<std::string>{"/second", "/first", "/third"}));
}

TEST(JointStatePlayer, RefusesASceneWithoutTopics) {
  const auto simulator = blockTouchedBy(
      "  - name: plate\n    urdf: package://tissue_contact/urdf/incline.urdf\n    tip_link: plate\n"
      "    base_pose: {position_m: [0, 0, -0.5]}\n    contact_links: [plate]\n");
  EXPECT_THROW(JointStatePlayer{*simulator}, std::invalid_argument);
}

TEST_F(OneProbe, FirstSamplePlacesWithoutAStep) {
  const PlayedSample played = playOne(player, 0, sample(kSecond, -0.004));
  EXPECT_EQ(played.verdict, Verdict::kAccepted);
  EXPECT_EQ(played.stamp_ns, kSecond);
  EXPECT_EQ(played.instruments, std::vector<int>{0});
  EXPECT_EQ(simulator->stepCount(), 0);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, -0.004));
  EXPECT_EQ(simulator->wrench(0).force, Vector3::Zero());
}

TEST_F(OneProbe, AdvancesFromStampToStamp) {
  playOne(player, 0, sample(kSecond, 0.0));
  const PlayedSample played = playOne(player, 0, sample(kSecond + 10 * kMillisecond, -0.002));
  EXPECT_FALSE(played.was_gap);
  EXPECT_FALSE(played.was_reset);
  EXPECT_EQ(simulator->stepCount(), 10);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, -0.002));
  EXPECT_GT(simulator->wrench(0).force.z(), 0.0);
}

TEST_F(OneProbe, JointsHeardLaterArePlacedNotMoved) {
  playOne(player, 0, {kSecond, {"z"}, {0.01}});
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, 0.01));
  // Half a metre in 10 ms would need far more steps than 10 if it were a motion.
  playOne(player, 0, {kSecond + 10 * kMillisecond, {"x"}, {0.5}});
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0.5, 0, 0.01));
  EXPECT_EQ(simulator->stepCount(), 10);
  EXPECT_FALSE(simulator->report().jumped);
  playOne(player, 0, {kSecond + 20 * kMillisecond, {"z"}, {0.02}});
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0.5, 0, 0.02));
}

TEST(JointStatePlayer, TakesReorderedAndMappedNamesAndIgnoresUnknownOnes) {
  const auto simulator = blockTouchedBy(probeEntry("a", "/a", "[0, 0, 0.026]", "    joint_names: {recorded_z: z}\n"));
  JointStatePlayer player(*simulator);
  const PlayedSample played =
      playOne(player, 0, {kSecond, {"jaw", "recorded_z", "z", "y", "x"}, {kNaN, 0.003, 5.0, 0.002, 0.001}});
  EXPECT_EQ(played.verdict, Verdict::kAccepted) << played.detail;
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0.001, 0.002, 0.003)) << "z is another arm's";
  const PlayedSample refused = playOne(player, 0, {kSecond + kMillisecond, {"recorded_z"}, {kNaN}});
  EXPECT_EQ(refused.verdict, Verdict::kNotFinite);
  EXPECT_NE(refused.detail.find("recorded_z"), std::string::npos) << refused.detail;
}

struct BadSample {
  const char* what;
  JointStateSample sample;
  Verdict verdict;
  const char* named;
};

TEST(JointStatePlayer, RefusesBadSamplesAndGoesOnAsIfTheyHadNotCome) {
  const std::int64_t next = kSecond + 10 * kMillisecond;
  const std::vector<BadSample> bad = {
      {"NaN", {next, {"x", "z"}, {0.0, kNaN}}, Verdict::kNotFinite, "'z'"},
      {"infinite", {next, {"x", "z"}, {-kInfinity, 0.0}}, Verdict::kNotFinite, "-inf"},
      {"a number whose differences are none", {next, {"z"}, {-1.7e308}}, Verdict::kNotFinite, "-1.7e+308; it must be"},
      {"NaN far in the future", {100 * kSecond, {"z"}, {kNaN}}, Verdict::kNotFinite, "'z'"},
      {"NaN in the past", {1, {"z"}, {kNaN}}, Verdict::kNotFinite, "'z'"},
      {"too few positions", {next, {"x", "z"}, {0.0}}, Verdict::kBadLength, "2 names but 1"},
      {"too many positions", {next, {"x"}, {0.0, 1.0}}, Verdict::kBadLength, "1 names but 2"},
      {"nothing known",
       {next, {"jaw", "elbow"}, {0.0, 0.0}},
       Verdict::kNoKnownJoint,
       "(jaw, elbow) is a joint of an instrument on this topic; map them by joint_names; those of 'a': x, y, z"},
      {"empty", {next, {}, {}}, Verdict::kNoKnownJoint, "joint"},
      {"stamp zero", sample(0, 0.0), Verdict::kBadStamp, "stamp"},
      {"negative stamp", sample(-5, 0.0), Verdict::kBadStamp, "stamp"},
      {"all bits of a stamp set", sample(4294967295 * kSecond + 4294967295, 0.0), Verdict::kBadStamp, "out of range"},
      {"one past the last stamp", sample(4294967296 * kSecond, 0.0), Verdict::kBadStamp, "out of range"},
      {"largest number", sample(std::numeric_limits<std::int64_t>::max(), 0.0), Verdict::kBadStamp, "out of range"},
      {"smallest number", sample(std::numeric_limits<std::int64_t>::min(), 0.0), Verdict::kBadStamp, "> 0"},
      {"duplicate stamp", sample(kSecond, 0.001), Verdict::kDuplicateStamp, "same stamp"},
  };
  for (const BadSample& b : bad) {
    SCOPED_TRACE(b.what);
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    playOne(player, 0, sample(kSecond, 0.0));
    const PlayedSample refused = playOne(player, 0, b.sample);
    EXPECT_EQ(refused.verdict, b.verdict);
    EXPECT_NE(refused.detail.find(b.named), std::string::npos) << refused.detail;
    EXPECT_NE(refused.detail.find("/a"), std::string::npos) << refused.detail;
    EXPECT_TRUE(refused.instruments.empty());
    EXPECT_EQ(player.count(b.verdict), 1);
    EXPECT_EQ(simulator->stepCount(), 0);
    EXPECT_EQ(simulator->jointPositions(0), Vector3::Zero());

    const PlayedSample good = playOne(player, 0, sample(next, -0.001));
    EXPECT_EQ(good.verdict, Verdict::kAccepted) << good.detail;
    EXPECT_FALSE(good.was_reset);
    EXPECT_EQ(simulator->stepCount(), 10);
    EXPECT_EQ(player.count(Verdict::kAccepted), 2);
    EXPECT_EQ(player.resets(), 0);
  }
}

TEST_F(OneProbe, NamesFromOutsideReachALogCutAndWithoutControlCharacters) {
  const std::vector<std::string> names(1000, "\x1b[2J\n\r\x7f" + std::string(1000000, 'n'));
  const PlayedSample refused = playOne(player, 0, {kSecond, names, std::vector<double>(names.size(), 0.0)});
  EXPECT_EQ(refused.verdict, Verdict::kNoKnownJoint);
  EXPECT_LT(refused.detail.size(), 2000U);
  EXPECT_NE(refused.detail.find("?[2J???nnn"), std::string::npos) << refused.detail;
  for (const char c : refused.detail) EXPECT_GE(c, ' ');
}

TEST_F(OneProbe, TakesTheLastStampThatThereIs) {
  EXPECT_EQ(playOne(player, 0, sample(4294967295 * kSecond + 999999999, 0.0)).verdict, Verdict::kAccepted);
}

TEST_F(OneProbe, RefusesABadFirstSample) {
  EXPECT_EQ(playOne(player, 0, sample(kSecond, kNaN)).verdict, Verdict::kNotFinite);
  EXPECT_EQ(playOne(player, 0, sample(kSecond, -0.001)).verdict, Verdict::kAccepted);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, -0.001));
}

TEST_F(OneProbe, LongIntervalIsSimulatedAsMaxGap) {
  playOne(player, 0, sample(kSecond, 0.0));
  EXPECT_FALSE(playOne(player, 0, sample(kSecond + 50 * kMillisecond, 0.0)).was_gap);
  EXPECT_EQ(simulator->stepCount(), 50);
  const PlayedSample played = playOne(player, 0, sample(4000000000 * kSecond, 0.001));
  EXPECT_TRUE(played.was_gap);
  EXPECT_EQ(player.gaps(), 1);
  EXPECT_EQ(simulator->stepCount(), 100);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, 0.001));
}

TEST_F(OneProbe, TimeGoingBackResetsOnceAndRepeatsTheSameBits) {
  std::vector<Trace> loops;
  for (int loop = 0; loop < 3; ++loop) {
    Trace trace;
    int resets = 0;
    for (const JointStateSample& s : press(kSecond, 0.006)) {
      player.push(0, s);
      while (const auto played = player.playNext()) {
        EXPECT_EQ(played->verdict, Verdict::kAccepted) << played->detail;
        resets += static_cast<int>(played->was_reset);
        trace.add(*played, *simulator);
      }
    }
    EXPECT_EQ(resets, loop == 0 ? 0 : 1);
    EXPECT_TRUE(trace.pressed());
    loops.push_back(trace);
  }
  EXPECT_EQ(player.resets(), 2);
  EXPECT_TRUE(loops[0] == loops[1]);
  EXPECT_TRUE(loops[0] == loops[2]);
}

TEST_F(OneProbe, ALoopForgetsWhichJointsWereHeard) {
  playOne(player, 0, {2 * kSecond, {"x", "z"}, {0.3, 0.01}});
  for (int i = 0; i < 3; ++i) player.push(0, {kSecond + i * kMillisecond, {"z"}, {0.02}});
  EXPECT_TRUE(drain(player).front().was_reset);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, 0.02));
}

TEST(JointStatePlayer, EveryVerdictHasItsOwnText) {
  std::set<std::string> texts;
  for (int v = 0; v < kVerdictCount; ++v) texts.insert(verdictText(static_cast<Verdict>(v)));
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(kVerdictCount));
  EXPECT_EQ(texts.count("unknown"), 0U);
}

}  // namespace joint_state_player_test
}  // namespace tissue_contact
