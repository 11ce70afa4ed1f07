/// @file
/// Command line of tissue_contact_replay; how it is parsed: core/command_line_test.cpp.
#include <gtest/gtest.h>

#include "ros/replay/replay.h"
#include "support/refusal.h"

namespace tissue_contact {
namespace replay_options_test {

void expectMissing(const std::vector<std::string>& arguments, const char* missing) {
  expectRefusal([&] { parseReplayOptions(arguments); }, {missing});
}

TEST(ReplayOptions, AreFilledIn) {
  const ReplayOptions options = parseReplayOptions(
      {"--csv=o=1.csv", "--bag", "i.bag", "--urdf", "r.urdf", "--scene", "s", "--dump-step=7", "--dump-file", "p.txt"});
  EXPECT_EQ(options.scene_file, "s");
  EXPECT_EQ(options.bag_file, "i.bag");
  EXPECT_EQ(options.csv_file, "o=1.csv");
  EXPECT_EQ(options.urdf_file, "r.urdf");
  EXPECT_EQ(options.dump_step, 7);
  EXPECT_TRUE(options.settings.empty());
  EXPECT_EQ(options.dump_file, "p.txt");
  EXPECT_FALSE(options.help);
  EXPECT_EQ(options.out_file, "");
  EXPECT_EQ(options.from_s, 0.0);
  EXPECT_TRUE(parseReplayOptions({"--bag", "b", "-h"}).help);
  const ReplayOptions part =
      parseReplayOptions({"--scene=s", "--bag=b", "--out=o.bag", "--plot=p", "--from=1.5", "--duration", "2"});
  EXPECT_EQ(part.csv_file, "");
  const ReplayOptions set = parseReplayOptions({"--scene=s", "--set", "a.b=1", "--bag=b", "--csv=c", "--set=c=[2, 3]"});
  EXPECT_EQ(set.settings, (std::vector<std::string>{"a.b=1", "c=[2, 3]"}));
  EXPECT_EQ(part.out_file, "o.bag");
  EXPECT_EQ(part.plot_folder, "p");
  EXPECT_EQ(part.from_s, 1.5);
  EXPECT_EQ(part.duration_s, 2.0);
}

TEST(ReplayOptions, ABatchTakesNoOthers) {
  EXPECT_EQ(parseReplayOptions({"--batch", "lines.txt"}).batch_file, "lines.txt");
  EXPECT_EQ(parseReplayOptions({"--batch=lines.txt"}).batch_file, "lines.txt");
  expectMissing({"--batch=lines.txt", "--csv=o.csv"}, "give no others");
  expectMissing({"--batch", "lines.txt", "--csv=o.csv"}, "give no others");
  expectMissing({"--csv=o.csv", "--batch=lines.txt"}, "give no others");
}

TEST(ReplayOptions, HelpNamesAll) {
  for (const char* key : {"--scene", "--bag", "--csv", "--out", "--plot", "--from", "--duration", "--urdf", "--timing",
                          "--set", "--dump-step", "--dump-file", "--help"}) {
    EXPECT_NE(replayUsage().find(key), std::string::npos) << key;
  }
}

TEST(ReplayOptions, WhatIsMissingIsNamed) {
  expectMissing({}, "--scene");
  expectMissing({"--scene", "s", "--csv", "c"}, "--bag");
  expectMissing({"--scene", "s", "--bag", "b"}, "--csv");
  expectMissing({"--scene", "s", "--bag", "b", "--csv", "c", "--plot", "p"}, "--out");
  const std::vector<std::string> all = {"--scene", "s", "--bag", "b", "--csv", "c"};
  for (const auto& [given, missing] :
       {std::pair("--dump-step=1", "--dump-file"), std::pair("--dump-file=p", "--dump-step")}) {
    std::vector<std::string> arguments = all;
    arguments.emplace_back(given);
    expectMissing(arguments, missing);
  }
}

}  // namespace replay_options_test
}  // namespace tissue_contact
