/// @file
/// Which arguments and private parameters the node refuses.

#include "ros/node/private_parameters.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace tissue_contact {
namespace {

using Names = std::vector<std::string>;

TEST(PrivateParameters, OnlyAssignmentsAreArguments) {
  const char* const good[] = {"node", "_scene:=/a b.yaml", "chatter:=/x", "__name:=n", "/a/b:=c", "_empty:="};
  EXPECT_FALSE(asksForHelp(6, good));
  EXPECT_FALSE(asksForHelp(1, good));
  for (const char* const bad : {"/a.yaml", "--scene", "_scene=/a.yaml", ""}) {
    const char* const arguments[] = {"node", "_scene:=/a.yaml", bad};
    try {
      asksForHelp(3, arguments);
      ADD_FAILURE() << "accepted: " << bad;
    } catch (const std::invalid_argument& error) {
      const std::string problem = error.what();
      EXPECT_NE(problem.find("'" + std::string(bad) + "'"), std::string::npos) << problem;
      EXPECT_NE(problem.find("_scene:="), std::string::npos) << problem;
    }
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
  EXPECT_EQ(misspelt("sceen"), "scene");
  EXPECT_EQ(misspelt("tf_timeout"), "tf_timeout_s");
  EXPECT_EQ(misspelt("tf_timout_s"), "tf_timeout_s");
  EXPECT_EQ(misspelt("marker/force_arrow_m_per_n"), "markers/force_arrow_m_per_n");
  // URDFs that another scene uses, and parameters of a node below.
  for (const char* other : {"left/description", "robot_description_2", "robot_descriptions", "camera/tf_timeout_s",
                            "markers", "gravity", "scene_of_yesterday"}) {
    EXPECT_EQ(misspelt(other), "") << other;
  }
}

}  // namespace
}  // namespace tissue_contact
