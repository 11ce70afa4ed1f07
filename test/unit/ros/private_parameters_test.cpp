/// @file
/// Which arguments and private parameters the node refuses.

#include "ros/node/private_parameters.h"

#include <gtest/gtest.h>

#include "support/refusal.h"

namespace tissue_contact {
namespace private_parameters_test {

using Names = std::vector<std::string>;

TEST(PrivateParameters, OnlyAssignmentsAreArguments) {
  const char* const good[] = {"node", "_scene:=/a b.yaml", "chatter:=/x", "__name:=n", "/a/b:=c", "_empty:="};
  EXPECT_FALSE(asksForHelp(6, good));
  EXPECT_FALSE(asksForHelp(1, good));
  for (const char* const bad : {"/a.yaml", "--scene", "_scene=/a.yaml", ""}) {
    const char* const arguments[] = {"node", "_scene:=/a.yaml", bad};
    expectRefusal([&] { asksForHelp(3, arguments); }, {"'" + std::string(bad) + "'", "_scene:="});
  }
}

TEST(PrivateParameters, PrivateArgumentsAreThoseWithOneUnderscore) {
  const char* const arguments[] = {
      "_program:=x", "_scene:=/a:=b.yaml", "__name:=n", "chatter:=/x", "_markers/a:=", "_:=x", ":=x", "_scene"};
  EXPECT_EQ(privateArguments(8, arguments), (Names{"scene", "markers/a"}));
}

TEST(PrivateParameters, UnknownNamesAreThoseBelowTheNamespace) {
  const Names set{"/n/scene", "/n/z", "/n/a/b", "/n", "/n_of_another/sceen", "/other/n/x", "/scene"};
  EXPECT_EQ(unknownNames(set, "/n", {"/n/scene"}), (Names{"/n/a/b", "/n/z"}));
  EXPECT_EQ(unknownNames(set, "/n", {"/n/scene", "/n/z", "/n/a/b"}), Names());
}

TEST(PrivateParameters, MisspeltIsWhatCanMeanNothingElse) {
  const Names own = nodeParameters(nullptr).own;
  EXPECT_EQ(misspelt("sceen", own), "scene");
  EXPECT_EQ(misspelt("publish_meshes", own), "publish_mesh");
  EXPECT_EQ(misspelt("tf_timeout", own), "tf_timeout_s");
  EXPECT_EQ(misspelt("tf_timout_s", own), "tf_timeout_s");
  EXPECT_EQ(misspelt("marker/force_arrow_m_per_n", own), "markers/force_arrow_m_per_n");
  // URDFs that another scene uses, and parameters of a node below.
  for (const char* other : {"left/description", "robot_description_2", "robot_descriptions", "camera/tf_timeout_s",
                            "markers", "gravity", "scene_of_yesterday"}) {
    EXPECT_EQ(misspelt(other, own), "") << other;
  }
}

}  // namespace private_parameters_test
}  // namespace tissue_contact
