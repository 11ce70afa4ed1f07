/// @file
/// A controller against tissue in one process: peaks, complaints, digests, and what is refused.
#include "tissue_contact/ros/lock_step.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/refusal.h"

namespace tissue_contact {
namespace lock_step_test {

const char* const kTopic = "/probe/joint_states";
const char* const kScene = TISSUE_CONTACT_SOURCE_DIR "/doc/controller_test/config/scene.yaml";

void stepTo(double z_m, LockStep& tissue) { tissue.step({{kTopic, {{"x", 0.0}, {"y", 0.0}, {"z", z_m}}}}); }

TEST(LockStep, TellsForcesPeaksAndDigests) {
  LockStep tissue(kScene, 100.0);
  const std::uint64_t nothing = tissue.digest();
  stepTo(0.0, tissue);
  EXPECT_EQ(tissue.wrench("probe").force, Vector3(0.0, 0.0, 0.0));
  EXPECT_NE(tissue.digest(), nothing);
  for (const double z_m : {-0.001, -0.002, -0.003}) stepTo(z_m, tissue);
  const double deepest = tissue.wrench("probe").force.norm();
  EXPECT_GT(deepest, 0.05);
  EXPECT_EQ(tissue.peakForce("probe"), deepest);
  stepTo(-0.001, tissue);
  EXPECT_LT(tissue.wrench("probe").force.norm(), deepest);
  EXPECT_EQ(tissue.peakForce("probe"), deepest);
  EXPECT_EQ(tissue.complaints(), std::vector<std::string>());
}

TEST(LockStep, DigestTellsRunsApart) {
  std::vector<std::uint64_t> digests;
  for (const double rate_hz : {100.0, 100.0, 50.0}) {
    LockStep tissue(kScene, rate_hz);
    for (const double z_m : {0.0, -0.002, -0.003}) stepTo(z_m, tissue);
    digests.push_back(tissue.digest());
  }
  EXPECT_EQ(digests[0], digests[1]);
  EXPECT_NE(digests[0], digests[2]);
}

TEST(LockStep, JointsFollowVelocitiesThatStatesHave) {
  // Of rest, a pull and rest again: without velocities each step of the scene in an interval moves as far.
  const auto digest = [](double end_velocity) {
    LockStep tissue(kScene, 50.0);
    tissue.step({{kTopic, {{"x", 0.0}, {"y", 0.0}, {"z", -0.002}}}}, {{kTopic, {{"z", 0.0}}}});
    tissue.step({{kTopic, {{"x", 0.0}, {"y", 0.0}, {"z", -0.0021}}}}, {{kTopic, {{"z", end_velocity}}}});
    return tissue.digest();
  };
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(digest(-0.01), digest(unknown));  // m/s: twice the way's mean
  EXPECT_EQ(digest(-10.0), digest(unknown));  // does not tell of this way
  LockStep tissue(kScene, 50.0);
  EXPECT_THROW(tissue.step({{kTopic, {{"z", 0.0}}}}, {{kTopic, {{"x", 0.0}}}}), std::invalid_argument);
}

TEST(LockStep, ComplainsOfWhatTheNodeWouldRefuse) {
  LockStep tissue(kScene, 100.0);
  stepTo(0.0, tissue);
  tissue.step({{kTopic, {{"z", std::numeric_limits<double>::quiet_NaN()}}}});
  tissue.step({{kTopic, {{"elbow", 0.0}}}});
  ASSERT_EQ(tissue.complaints().size(), 2U);
  EXPECT_EQ(tissue.complaints()[0].find("at 1.01 s: joint state refused: "), 0U) << tissue.complaints()[0];
  EXPECT_EQ(tissue.complaints()[1].find("at 1.02 s: joint state refused: "), 0U) << tissue.complaints()[1];
}

TEST(LockStep, ComplainsOfLoadsThatNoTissueBearsAndOfJumps) {
  LockStep tissue(kScene, 100.0);
  for (int i = 0; i <= 100; ++i) stepTo(-0.0002 * i, tissue);
  ASSERT_EQ(tissue.complaints().size(), LockStep::kMostComplaints);
  EXPECT_NE(tissue.complaints()[0].find("cannot bear"), std::string::npos) << tissue.complaints()[0];
  LockStep thrown(kScene, 100.0);
  stepTo(10.0, thrown);
  stepTo(-10.0, thrown);
  ASSERT_FALSE(thrown.complaints().empty());
  EXPECT_NE(thrown.complaints()[0].find("moved too far"), std::string::npos) << thrown.complaints()[0];
}

TEST(LockStep, RefusesUnknownNamesAndRates) {
  LockStep tissue(kScene, 100.0);
  EXPECT_EQ(refusal([&] { tissue.wrench("psm"); }), "the scene has no instrument \"psm\"; it has probe");
  EXPECT_EQ(refusal([&] {
              tissue.step({{"/psm", {{"z", 0.0}}}});
            }),
            "the scene has no joint-state topic \"/psm\"; it has /probe/joint_states");
  for (const double bad : {0.0, -1.0, 2e4, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_NE(refusal([&] { LockStep(kScene, bad); }).find("the rate of the joint states"), std::string::npos);
  }
}

}  // namespace lock_step_test
}  // namespace tissue_contact
