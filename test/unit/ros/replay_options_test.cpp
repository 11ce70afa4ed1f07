/// @file
/// Command line of tissue_contact_replay.
#include "tissue_contact/ros/replay_options.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace tissue_contact {
namespace {

std::string refusal(const std::vector<std::string>& arguments) {
  try {
    parseReplayOptions(arguments);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ReplayOptions, TakesBothSpellingsInAnyOrder) {
  const ReplayOptions options =
      parseReplayOptions({"--csv=o=1.csv", "--bag", "i.bag", "--urdf", "r.urdf", "--scene", "s"});
  EXPECT_EQ(options.scene_file, "s");
  EXPECT_EQ(options.bag_file, "i.bag");
  EXPECT_EQ(options.csv_file, "o=1.csv");
  EXPECT_EQ(options.urdf_file, "r.urdf");
  EXPECT_FALSE(options.help);
}

TEST(ReplayOptions, HelpNeedsNothingElse) {
  EXPECT_TRUE(parseReplayOptions({"--help"}).help);
  EXPECT_TRUE(parseReplayOptions({"--bag", "b", "-h"}).help);
  for (const char* key : {"--scene", "--bag", "--csv", "--urdf", "--timing", "--help"}) {
    EXPECT_NE(replayUsage().find(key), std::string::npos) << key;
  }
}

TEST(ReplayOptions, RefusalsNameTheArgument) {
  EXPECT_NE(refusal({}).find("--scene"), std::string::npos);
  EXPECT_NE(refusal({"--scene", "s", "--csv", "c"}).find("--bag"), std::string::npos);
  EXPECT_NE(refusal({"--scene", "s", "--bag", "b"}).find("--csv"), std::string::npos);
  EXPECT_NE(refusal({"--scene", "s", "--bag", "b", "--csv"}).find("--csv"), std::string::npos);
  EXPECT_NE(refusal({"--scene", "s", "--bag", "b", "--csv="}).find("--csv"), std::string::npos);
  EXPECT_NE(refusal({"--scene", "s", "--scene", "t"}).find("twice"), std::string::npos);
  EXPECT_NE(refusal({"--scene", "s", "--bag", "b", "--csv", "--urdf", "u"}).find("--csv"), std::string::npos);
  EXPECT_NE(refusal({"--sceen", "s"}).find("'--sceen'"), std::string::npos);
  EXPECT_NE(refusal({"in.bag"}).find("'in.bag'"), std::string::npos);
}

}  // namespace
}  // namespace tissue_contact
