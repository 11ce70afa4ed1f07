/// @file
/// What the frames of links are called, and which are refused.
#include "ros/publish/instrument_messages.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "support/refusal.h"
#include "support/replaced.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace instrument_messages_test {

/// A scene with the block and these instruments, all of a parameter's URDF, {name: parameter}.
Simulator sceneOf(const std::map<std::string, std::string>& instruments, const std::string& world_frame = "world") {
  std::string yaml = "world_frame: " + world_frame + "\n" + blockScene() + "instruments:\n";
  for (const auto& [name, urdf] : instruments) {
    yaml += "  - {name: " + name + ", robot_description: " + urdf +
            ", tip_link: tip, contact_links: [tip], joint_state_topics: [/" + name +
            "], base_pose: {position_m: [0, 0, 0.1]}}\n";
  }
  const std::string ball = "<collision><geometry><sphere radius='0.005'/></geometry></collision>";
  const std::string joint =
      "<joint name='x' type='prismatic'><parent link='foot'/><child link='tip'/><axis xyz='1 0 0'/>"
      "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
  const std::map<std::string, std::string> urdfs = {
      {"probe", probeUrdf(0.005)},
      {"other", "<robot name='other'><link name='foot'/><link name='tip'>" + ball + "</link>" + joint + "</robot>"},
      {"old", "<robot name='old'><link name='/foot'/><link name='tip'>" + ball + "</link>" +
                  replaced(joint, "'foot'", "'/foot'") + "</robot>"},
      // Its first link is called as the frame of probe `a`'s tip is where several share a tip.
      {"cunning", "<robot name='cunning'><link name='a/tip'/><link name='point'>" + ball +
                      "</link><joint name='x' type='prismatic'><parent link='a/tip'/><child link='point'/>"
                      "<axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>"}};
  const std::string point = "tip_link: tip, contact_links: [tip]";
  if (const std::size_t at = yaml.find("robot_description: cunning"); at != std::string::npos) {
    yaml.replace(yaml.find(point, at), point.size(), "tip_link: point, contact_links: [point]");
  }
  return makeSimulator(yaml, urdfs);
}

TEST(FrameNames, AreTheLinksWhereNoneIsShared) {
  const FrameNames frames = frameNames(sceneOf({{"a", "probe"}}));
  EXPECT_EQ(frames, (FrameNames{{"base", "x_link", "y_link", "tip"}}));
}

TEST(FrameNames, BeginWithNoSlash) {
  EXPECT_EQ(frameNames(sceneOf({{"a", "old"}})), (FrameNames{{"foot", "tip"}}));
  EXPECT_EQ(frameNames(sceneOf({{"a", "old"}, {"b", "probe"}})),
            (FrameNames{{"a/foot", "a/tip"}, {"b/base", "b/x_link", "b/y_link", "b/tip"}}));
}

TEST(FrameNames, HaveTheInstrumentWhereTwoShareOne) {
  EXPECT_EQ(frameNames(sceneOf({{"a", "probe"}, {"b", "probe"}})),
            (FrameNames{{"a/base", "a/x_link", "a/y_link", "a/tip"}, {"b/base", "b/x_link", "b/y_link", "b/tip"}}));
  // One shared link is enough, and all of the instrument's have its name then.
  EXPECT_EQ(frameNames(sceneOf({{"a", "probe"}, {"b", "other"}})),
            (FrameNames{{"a/base", "a/x_link", "a/y_link", "a/tip"}, {"b/foot", "b/tip"}}));
}

TEST(FrameNames, HaveTheInstrumentWhereALinkIsCalledAsTheWorldAndElsewhere) {
  EXPECT_EQ(frameNames(sceneOf({{"b", "other"}}, "foot")), (FrameNames{{"b/foot", "tip"}}));  // the root alone
  EXPECT_EQ(frameNames(sceneOf({{"a", "other"}, {"b", "other"}}, "foot")),
            (FrameNames{{"a/foot", "a/tip"}, {"b/foot", "b/tip"}}));
  EXPECT_EQ(frameNames(sceneOf({{"b", "other"}}, "tip")), (FrameNames{{"b/foot", "b/tip"}}));
}

TEST(FrameNames, AreRefusedWhereALinkIsCalledAsTheFrameOfAnother) {
  const Simulator simulator = sceneOf({{"a", "probe"}, {"b", "other"}, {"c", "cunning"}});
  expectRefusal([&] { frameNames(simulator); }, {"two links", "'a/tip'", "rename one in its URDF"});
}

}  // namespace instrument_messages_test
}  // namespace tissue_contact
