/// Changes of a scene's numbers in a bag: taken at their moments, whenever they were recorded; from a bag that fits no scene, or that somebody has
/// made up, an error.
#include "ros/bag/recorded_changes.h"

#include <gtest/gtest.h>

#include "bag_fixture.h"
#include "support/refusal.h"
#include "support/text_scene.h"
#include "tissue_contact/Changes.h"

namespace tissue_contact {
namespace recorded_changes_test {

const std::string kYoung = "tissues/block/youngs_modulus_pa";
constexpr std::int64_t kSecond = 1'000'000'000;

const ros::Time kBegins(1, 0);  // before write() records anything

Changes changesOf(unsigned stamp_s, unsigned loop, const std::vector<std::string>& keys,
                  const std::vector<double>& values) {
  Changes message;
  message.header.stamp = ros::Time(stamp_s, 0);
  message.loop = loop;
  message.keys = keys;
  message.values = values;
  return message;
}

class RecordedChangesTest : public testing::Test {
 protected:
  /// One after the other on topics of these names. @return the file.
  std::string write(const std::vector<std::pair<std::string, Changes>>& messages) const {
    const std::string file = directory_.path("changes.bag");
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    std::uint32_t time_s = 5000;
    for (const auto& [topic, message] : messages) bag.write(topic, ros::Time(time_s++, 0), message);
    bag.write(kTopic, ros::Time(time_s, 0), jointState(1));
    return file;
  }

  std::string refusalOf(const std::vector<std::pair<std::string, Changes>>& messages,
                        const std::string& topic = "") const {
    const std::string file = write(messages);
    return refusal<std::runtime_error>([&] { RecordedChanges(file, topic, scene_, kBegins); });
  }

  TemporaryDirectory directory_;
  Scene scene_ = parseScene(blockScene(), "text scene", nullptr);
};

double modulusOf(const std::optional<Scene>& scene) {
  return scene ? scene->tissues[0].material.youngs_modulus_pa : 0.0;
}

TEST_F(RecordedChangesTest, EachIsDueOnceItsMomentWasPlayed) {
  const std::string file = write({{"/node/changes", changesOf(0, 0, {kYoung}, {6000.0})},
                                  {"/node/changes", changesOf(10, 0, {kYoung}, {7000.0})},
                                  {"/node/changes", changesOf(5, 1, {}, {})}});
  RecordedChanges changes(file, "", scene_, kBegins);
  EXPECT_EQ(changes.count(), 3U);
  EXPECT_FALSE(changes.takeDue(0, std::nullopt, 0));  // no moment is ready
  EXPECT_EQ(modulusOf(changes.takeDue(0, std::nullopt, 8 * kSecond)), 6000.0);
  EXPECT_FALSE(changes.takeDue(0, std::nullopt, 8 * kSecond));
  EXPECT_FALSE(changes.takeDue(0, 8 * kSecond, 9 * kSecond));
  EXPECT_EQ(modulusOf(changes.takeDue(0, 10 * kSecond, 11 * kSecond)), 7000.0);
  EXPECT_FALSE(changes.takeDue(0, 12 * kSecond, 4 * kSecond));
  EXPECT_FALSE(changes.takeDue(1, 4 * kSecond, 5 * kSecond));
  EXPECT_EQ(changes.taken(), 2U);
  EXPECT_EQ(modulusOf(changes.takeDue(1, 5 * kSecond, 6 * kSecond)), 5000.0);  // the scene's again
  EXPECT_FALSE(changes.takeDue(2, 5 * kSecond, 6 * kSecond));
}

// A recording that begins in the middle has the latched message of what was changed before.
TEST_F(RecordedChangesTest, WhatWasChangedBeforeTheRecordingHoldsFromItsStart) {
  const std::string file = write({{"/node/changes", changesOf(90, 0, {kYoung}, {7000.0})}});
  RecordedChanges changes(file, "", scene_, kBegins);
  EXPECT_FALSE(changes.takeDue(0, std::nullopt, 90 * kSecond));
  EXPECT_EQ(modulusOf(changes.takeDue(0, std::nullopt, 91 * kSecond)), 7000.0);
}

// The node was reset, or its bag had looped, before the recording.
TEST_F(RecordedChangesTest, ALatchedChangeHoldsWhateverItsLoop) {
  const std::string file = write({{"/node/changes", changesOf(90, 2, {kYoung}, {7000.0})},
                                  {"/node/changes", changesOf(95, 2, {kYoung}, {8000.0})},
                                  {"/node/changes", changesOf(3, 3, {kYoung}, {9000.0})}});
  RecordedChanges changes(file, "", scene_, ros::Time(5000, 500));
  EXPECT_EQ(modulusOf(changes.takeDue(0, std::nullopt, 91 * kSecond)), 7000.0);
  EXPECT_FALSE(changes.takeDue(0, std::nullopt, 91 * kSecond));
  EXPECT_EQ(modulusOf(changes.takeDue(0, 95 * kSecond, 96 * kSecond)), 8000.0);
  EXPECT_FALSE(changes.takeDue(0, 97 * kSecond, 98 * kSecond));
  EXPECT_EQ(modulusOf(changes.takeDue(1, 3 * kSecond, 4 * kSecond)), 9000.0);
}

// By a connection of its own it may come a moment later than the first joint state.
TEST_F(RecordedChangesTest, TheFirstOneSoonAfterTheBeginningTellsItsLoop) {
  const std::string file = write({{"/node/changes", changesOf(0, 3, {}, {})},
                                  {"/node/changes", changesOf(95, 3, {kYoung}, {8000.0})},
                                  {"/node/changes", changesOf(0, 4, {kYoung}, {8000.0})},
                                  {"/node/changes", changesOf(96, 4, {kYoung}, {9000.0})}});
  RecordedChanges changes(file, "", scene_, ros::Time(4999));
  EXPECT_EQ(changes.count(), 2U);  // what is said again where a loop begins changes nothing
  EXPECT_FALSE(changes.takeDue(0, std::nullopt, 94 * kSecond));
  EXPECT_FALSE(changes.takeDue(0, 94 * kSecond, 95 * kSecond));
  EXPECT_EQ(modulusOf(changes.takeDue(0, 95 * kSecond, 96 * kSecond)), 8000.0);
  EXPECT_FALSE(changes.takeDue(0, 96 * kSecond, 1 * kSecond));
  EXPECT_FALSE(changes.takeDue(1, 1 * kSecond, 96 * kSecond));
  EXPECT_EQ(modulusOf(changes.takeDue(1, 96 * kSecond, 0)), 9000.0);
}

// Then it is of that one.
TEST_F(RecordedChangesTest, NorWhereALoopHasBegunMeanwhile) {
  scene_ = parseScene(blockScene() + "instruments:\n" + probeEntry("probe", kTopic, "[0, 0, 0.026]"), "text scene",
                      ownEnvironment().package_path);
  const std::string file = directory_.path("loop.bag");
  {
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    std::uint32_t recorded_ns = 0;
    for (const int stamp_ms : {100, 200, 300, 100}) {
      bag.write(kTopic, ros::Time(4999, ++recorded_ns), jointState(stamp_ms));
    }
    bag.write("/node/changes", ros::Time(5000), changesOf(11, 1, {kYoung}, {7000.0}));
  }
  RecordedChanges changes(file, "", scene_, ros::Time(4999));
  EXPECT_FALSE(changes.takeDue(0, 11 * kSecond, 12 * kSecond));
  EXPECT_EQ(modulusOf(changes.takeDue(1, 11 * kSecond, 12 * kSecond)), 7000.0);
}

TEST_F(RecordedChangesTest, AStrayStampAheadBringsNoneForward) {
  const std::string file = write({{"/node/changes", changesOf(10, 0, {kYoung}, {7000.0})},
                                  {"/node/changes", changesOf(3600, 0, {kYoung}, {8000.0})}});
  RecordedChanges changes(file, "", scene_, kBegins);
  EXPECT_FALSE(changes.takeDue(0, 5 * kSecond, 3605 * kSecond));
  EXPECT_FALSE(changes.takeDue(0, 3605 * kSecond, 0));  // what comes is not known yet
  EXPECT_FALSE(changes.takeDue(0, 3605 * kSecond, 6 * kSecond));
  EXPECT_FALSE(changes.takeDue(0, 9 * kSecond, 11 * kSecond));
  EXPECT_EQ(modulusOf(changes.takeDue(0, 11 * kSecond, 12 * kSecond)), 7000.0);    // its own moment was not recorded
  EXPECT_EQ(modulusOf(changes.takeDue(0, 3600 * kSecond, 12 * kSecond)), 8000.0);  // changed right after a stray one
}

TEST_F(RecordedChangesTest, MostBagsHaveNone) {
  writeJointStates(directory_.path("plain.bag"), 3);
  EXPECT_EQ(RecordedChanges(directory_.path("plain.bag"), "", scene_, kBegins).count(), 0U);
  expectRefusal<std::runtime_error>(
      [&] { RecordedChanges(directory_.path("plain.bag"), "/node/changes", scene_, kBegins); },
      {"plain.bag", "/node/changes", "--changes"});
}

TEST_F(RecordedChangesTest, OfSeveralNodesOneIsToBeNamed) {
  const std::vector<std::pair<std::string, Changes>> messages = {{"/a/changes", changesOf(1, 0, {kYoung}, {6000.0})},
                                                                 {"/b/changes", changesOf(1, 0, {kYoung}, {7000.0})}};
  expectContains(refusalOf(messages), {"/a/changes, /b/changes", "--changes TOPIC"});
  RecordedChanges changes(write(messages), "b/changes", scene_, kBegins);
  EXPECT_EQ(modulusOf(changes.takeDue(0, kSecond, 0)), 7000.0);
}

TEST_F(RecordedChangesTest, RefusesWhatIsNotOfTheScene) {
  const auto refused = [&](const Changes& message, const std::vector<std::string>& words) {
    expectContains(refusalOf({{"/node/changes", message}}), words);
  };
  refused(changesOf(1, 0, {"tissues/liver/youngs_modulus_pa"}, {6000.0}),
          {"changes.bag", "/node/changes", "tissues/liver/youngs_modulus_pa", "give the scene that the node ran with"});
  refused(changesOf(1, 0, {kYoung}, {-6000.0}), {kYoung, "-6000"});
  refused(changesOf(1, 0, {kYoung}, {}), {"1 keys with 0 values"});
}

TEST_F(RecordedChangesTest, NoByteThatIsSpoiltCrashesOrTakesMemory) {
  const std::string file = write({{"/node/changes", changesOf(10, 0, {kYoung, "solver/iterations"}, {7000.0, 5.0})}});
  const std::string sound = readBytes(file);
  const RecordPlace message = messageOf(sound, 0);
  int refused = 0;
  for (std::size_t i = 0; i < message.size; ++i) {
    writeBytes(file, patched(sound, message.data + i, "\xff"));
    try {
      RecordedChanges(file, "", scene_, kBegins);
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, static_cast<int>(message.size) / 2);
}

}  // namespace recorded_changes_test
}  // namespace tissue_contact
