// The controller against tissue in one process: no ROS master, no other node.
#include <gtest/gtest.h>
#include <tissue_contact/ros/lock_step.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "../src/press_controller.h"

namespace {

double target() {
  const char* given = std::getenv("TARGET_FORCE_N");
  return given == nullptr ? 0.5 : std::strtod(given, nullptr);
}

// 150 periods at 100 Hz.
void run(tissue_contact::LockStep& tissue) {
  PressController controller(target());
  double z_m = 0.0;
  for (int period = 0; period < 150; ++period) {
    tissue.step({{"/probe/joint_states", {{"x", 0.0}, {"y", 0.0}, {"z", z_m}}}});
    z_m = controller.next(tissue.wrench("probe").force.norm());
  }
}

TEST(PressController, PressesGentlyAndHolds) {
  tissue_contact::LockStep tissue(SCENE, 100.0);
  run(tissue);
  EXPECT_EQ(tissue.complaints(), std::vector<std::string>());
  EXPECT_LT(tissue.peakForce("probe"), 0.6);
  EXPECT_NEAR(tissue.wrench("probe").force.norm(), 0.5, 0.02);
}

TEST(PressController, GivesTheSameBitsAgain) {
  tissue_contact::LockStep first(SCENE, 100.0);
  tissue_contact::LockStep second(SCENE, 100.0);
  run(first);
  run(second);
  EXPECT_EQ(first.digest(), second.digest());
  RecordProperty("digest", std::to_string(first.digest()));
}

}  // namespace
