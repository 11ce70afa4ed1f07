/// Command line of tissue_contact_benchmark.
#include <gtest/gtest.h>

#include <stdexcept>

#include "benchmark/benchmark.h"
#include "support/comma_locale.h"

namespace tissue_contact {
namespace options_test {

TEST(BenchmarkOptionsTest, ShippedScenes) {
  const BenchmarkOptions options =
      parseBenchmarkOptions({"--out", "here", "--only=robot", "--quick", "--robot-bag", "psm.bag", "--no-plot"});
  EXPECT_EQ(options.out_directory, "here");
  EXPECT_EQ(options.only, "robot");
  EXPECT_EQ(options.scenes.robot_bag, "psm.bag");
  EXPECT_TRUE(options.scenes.quick);
  EXPECT_FALSE(options.plot);
  EXPECT_TRUE(parseBenchmarkOptions({}).plot);
}

TEST(BenchmarkOptionsTest, OwnScene) {
  const OwnSceneOptions own = parseBenchmarkOptions({"--scene", "s.yaml", "--bag", "b.bag", "--from", "0",
                                                     "--duration=2.5", "--urdf", "r.urdf"})
                                  .own;
  EXPECT_EQ(own.scene_file, "s.yaml");
  EXPECT_EQ(own.bag_file, "b.bag");
  EXPECT_EQ(own.urdf_file, "r.urdf");
  EXPECT_EQ(own.window.from_s, 0.0);
  EXPECT_EQ(own.window.duration_s, 2.5);
}

TEST(BenchmarkOptionsTest, NumbersAreTheSameInAnyLocale) {
  const CommaLocale locale;
  if (!locale.isOn()) GTEST_SKIP() << "no locale with a decimal comma, and none can be made";
  EXPECT_EQ(parseBenchmarkOptions({"--scene", "s", "--bag", "b", "--from", "0.5"}).own.window.from_s, 0.5);
  EXPECT_THROW(parseBenchmarkOptions({"--scene", "s", "--bag", "b", "--from", "0,5"}), std::invalid_argument);
}

TEST(BenchmarkOptionsTest, RefusesWhatMakesNoSense) {
  using Arguments = std::vector<std::string>;
  for (const Arguments& wrong :
       {Arguments{"--oops"}, Arguments{"--only", "all"}, Arguments{"--only", "robot"},
        Arguments{"--only", "robot-sweep"}, Arguments{"--only", "grasp", "--robot-bag", "b"}, Arguments{"--scene", "s"},
        Arguments{"--bag", "b"}, Arguments{"--from", "1"}, Arguments{"--scene", "s", "--bag", "b", "--quick"},
        Arguments{"--scene", "s", "--bag", "b", "--duration", "0"},
        Arguments{"--scene", "s", "--bag", "b", "--duration", "nan"},
        Arguments{"--scene", "s", "--bag", "b", "--from", "-1"},
        Arguments{"--scene", "s", "--bag", "b", "--from", "1s"}}) {
    EXPECT_THROW(parseBenchmarkOptions(wrong), std::invalid_argument) << wrong.back();
  }
}

}  // namespace options_test
}  // namespace tissue_contact
