/// Joints that give way to the tissue (CompliantJoints): where they rest, what they do at their limit, beside stiff tissue and when it lets
/// go, and what a saved state keeps of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/text_scene.h"

namespace tissue_contact {
namespace compliant_joints_test {

constexpr double kStep = 0.001;

/// A ball of 5 mm, 0.1 mm above the middle of a block, on joints x, y, z.
Simulator ballOn(const std::string& compliance, const std::string& youngs_modulus_pa = "5000") {
  std::string tissue = blockScene("[0.06, 0.06, 0.02]", "[6, 6, 3]");
  tissue.replace(tissue.find("5000"), 4, youngs_modulus_pa);
  std::string ball = onlyBall("[0.001, 0.002, 0.0251]");
  ball.insert(ball.rfind("}\n"), ", compliant_joints: " + compliance);
  return makeSimulator(tissue + ball + "friction: [{instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}]\n",
                       {{"probe", probeUrdf(0.005)}});
}

/// The ball goes down to `z_m` at 20 mm/s and rests.
void press(Simulator& simulator, double z_m, double rest_s = 0.3) {
  const double from = simulator.jointPositions(0)[2];
  const int steps = std::max(1, static_cast<int>(std::lround(std::abs(z_m - from) / 0.02 / kStep)));
  for (int k = 1; k <= steps; ++k) simulator.advance(kStep, {Vector3(0.0, 0.0, from + (z_m - from) * k / steps)});
  for (int k = 0; k < std::lround(rest_s / kStep); ++k) simulator.advance(kStep, {Vector3(0.0, 0.0, z_m)});
}

/// In world axes, since the ball does not turn.
double upwardForce(const Simulator& simulator) { return simulator.wrench(0).force.z(); }

TEST(CompliantJoints, RestWhereTheSpringBearsTheForce) {
  constexpr double kStiffness = 20.0;  // N/m, as much as the tissue's
  Simulator simulator = ballOn("[{joint: z, stiffness_n_per_m: 20}]");
  press(simulator, -0.004);
  const double way = simulator.jointDeflections(0)[2];
  EXPECT_NEAR(kStiffness * way, upwardForce(simulator), 1e-3 * upwardForce(simulator));
  EXPECT_GT(way, 1e-3);
  EXPECT_EQ(simulator.jointPositions(0)[2], -0.004);
  EXPECT_NEAR(simulator.linkPoses(0)[3].translation().z(), 0.0251 - 0.004 + way, 1e-12);

  // A rigid joint that goes where this one rests meets the same force, but for what friction keeps of the way there.
  Simulator rigid = ballOn("[{joint: x, stiffness_n_per_m: 1.0e12}]");
  press(rigid, -0.004 + way);
  EXPECT_NEAR(upwardForce(rigid), upwardForce(simulator), 0.01 * upwardForce(rigid));
}

TEST(CompliantJoints, PressNoHarderThanTheirLimit) {
  Simulator simulator = ballOn("[{joint: z, stiffness_n_per_m: 1.0e4, force_limit_n: 0.02}]");
  press(simulator, -0.008);
  EXPECT_NEAR(upwardForce(simulator), 0.02, 2e-5);
  EXPECT_GT(simulator.jointDeflections(0)[2], 0.004);
}

/// What follows a step late must not swing, however stiff the tissue is beside the joint.
TEST(CompliantJoints, ComeToRestOnStiffTissue) {
  for (const double stiffness : {1.0, 1e3, 1e6}) {
    Simulator simulator =
        ballOn("[{joint: z, stiffness_n_per_m: " + std::to_string(stiffness) + ", force_limit_n: 0.5}]", "1.0e7");
    press(simulator, -0.001, 1.0);
    double least = upwardForce(simulator), most = least;
    for (int k = 0; k < 100; ++k) {
      simulator.advance(kStep, {Vector3(0.0, 0.0, -0.001)});
      least = std::min(least, upwardForce(simulator));
      most = std::max(most, upwardForce(simulator));
    }
    const double borne = std::min(stiffness * simulator.jointDeflections(0)[2], 0.5);
    EXPECT_GT(borne, 5e-4) << stiffness;
    EXPECT_NEAR(least, borne, 0.01 * borne) << stiffness;
    EXPECT_NEAR(most, borne, 0.01 * borne) << stiffness;
  }
}

/// Without friction nothing along the surface holds a ball back but the slope it goes up.
TEST(CompliantJoints, SlideWithTheirJointState) {
  std::string tissue = blockScene("[0.06, 0.06, 0.02]", "[12, 12, 4]");
  tissue.replace(tissue.find("5000"), 4, "1.0e6");
  std::string ball = onlyBall("[-0.01, 0.002, 0.0251]");
  ball.insert(ball.rfind("}\n"), ", compliant_joints: [{joint: x, stiffness_n_per_m: 1000}]");
  Simulator simulator = makeSimulator(tissue + ball, {{"probe", probeUrdf(0.005)}});
  press(simulator, -0.0006);
  double farthest = 0.0, hardest = 0.0;
  for (int k = 1; k <= 1000; ++k) {
    simulator.advance(kStep, {Vector3(1e-5 * k, 0.0, -0.0006)});
    farthest = std::max(farthest, std::abs(simulator.jointDeflections(0)[0]));
    hardest = std::max(hardest, std::abs(simulator.wrench(0).force.x()));
  }
  EXPECT_LT(farthest, 1.3 * hardest / 1000.0);
}

/// Stamps that jitter: what contacts resist in a short step is not what they did in a long one before it.
TEST(CompliantJoints, PressNoHarderInStepsOfUnequalLength) {
  Simulator simulator = ballOn("[{joint: z, stiffness_n_per_m: 1.0e4, force_limit_n: 0.02}]");
  press(simulator, -0.006);
  double most = 0.0;
  for (int k = 0; k < 200; ++k) {
    simulator.advance(k % 2 == 0 ? 0.001 : 0.0001, {Vector3(0.0, 0.0, -0.006 - 1e-5 * k)});
    most = std::max(most, upwardForce(simulator));
  }
  EXPECT_LT(most, 0.025);
  EXPECT_NEAR(upwardForce(simulator), 0.02, 0.002);
}

TEST(CompliantJoints, ReturnWhenNothingIsInTheirWay) {
  Simulator simulator = ballOn("[{joint: z, stiffness_n_per_m: 1.0e3, force_limit_n: 0.02}]");
  press(simulator, -0.008);
  ASSERT_GT(simulator.jointDeflections(0)[2], 0.004);
  press(simulator, 0.001);
  EXPECT_EQ(simulator.jointDeflections(0)[2], 0.0);
  EXPECT_EQ(upwardForce(simulator), 0.0);
}

constexpr double kAxisHeight = 0.042;

/// Jaws that turn about y, 12 mm above a flap that they take between them; its lower end is fixed.
/// @param is_one the second jaw mimics the first, backwards. @param flap a tissue's geometry.
Simulator makeJaws(bool is_one, const std::string& flap) {
  const std::string jaw =
      "<collision><origin xyz='0 0 -0.015'/><geometry><box size='0.001 0.006 0.01'/></geometry></collision></link>";
  const auto joint = [](const std::string& name, const std::string& child, const std::string& axis,
                        const std::string& more) {
    return "<joint name='" + name + "' type='revolute'><parent link='base'/><child link='" + child + "'/><axis xyz='" +
           axis + "'/>" + more + "<limit lower='0' upper='1' effort='1' velocity='1'/></joint>";
  };
  const std::string other = is_one ? joint("other", "right", "0 -1 0", "<mimic joint='open' multiplier='-1'/>")
                                   : joint("other", "right", "0 1 0", "");
  const std::string urdf = "<robot name='gripper'><link name='base'/><link name='left'>" + jaw + "<link name='right'>" +
                           jaw + joint("open", "left", "0 -1 0", "") + other + "</robot>";
  const std::string compliance = is_one ? "[{joint: open, stiffness_n_m_per_rad: 0.5, torque_limit_n_m: 0.004}]"
                                        : "[{joint: open, stiffness_n_m_per_rad: 0.5, torque_limit_n_m: 0.002}, "
                                          "{joint: other, stiffness_n_m_per_rad: 0.5, torque_limit_n_m: 0.002}]";
  return makeSimulator(
      "gravity_m_per_s2: [0, 0, 0]\ntissues:\n  - name: flap\n" + flap +
          "    damping: {stiffness_s: 0.003, mass_per_s: 20}\n"
          "instruments:\n  - {name: gripper, robot_description: gripper, tip_link: base, contact_links: [left, "
          "right],\n"
          "     joint_state_topics: [/js], base_pose: {position_m: [0, 0, 0.042]}, compliant_joints: " +
          compliance + "}\nfriction: [{instrument: gripper, tissue: flap, static: 0.6, kinetic: 0.4}]\n",
      {{"gripper", urdf}});
}

/// Of the tissue on a jaw about its axis, N m, opening it.
double torqueOn(const Simulator& simulator, int link) {
  double torque = 0.0;
  for (const SolvedContact& solved : simulator.contacts()) {
    if (solved.contact.key.link != link) continue;
    const Vector3 from_axis = solved.contact.p_WC - Vector3(0.0, 0.0, kAxisHeight);
    torque += (link == 0 ? -1.0 : 1.0) * from_axis.cross(-solved.force_on_tissue_n).y();
  }
  return torque;
}

struct JawTorques {
  double left = 0.0, right = 0.0;  ///< means of the last 100 steps, between which contacts at edges come and go, N m
  double most = 0.0;               ///< of both together on the way, N m
};

/// The jaws close within a second to where they pass through each other, as recorded without a flap, and rest.
JawTorques closeJaws(Simulator& simulator) {
  const VectorX ones = simulator.instruments()[0].initialPositions().array() + 1.0;
  simulator.placeInstrument(0, 0.3 * ones);
  JawTorques torques;
  constexpr int kSteps = 2500;
  for (int k = 1; k <= kSteps; ++k) {
    simulator.advance(kStep, {std::max(0.3 - 0.5 * k * kStep, -0.2) * ones});
    torques.most = std::max(torques.most, torqueOn(simulator, 0) + torqueOn(simulator, 1));
    if (k <= kSteps - 100) continue;
    torques.left += 0.01 * torqueOn(simulator, 0);
    torques.right += 0.01 * torqueOn(simulator, 1);
  }
  return torques;
}

class Jaws : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(OneJointOrTwo, Jaws, ::testing::Bool(),
                         [](const auto& is_one) { return is_one.param ? "one" : "two"; });

TEST_P(Jaws, HoldAFlapWithTheTorqueThatTheyHave) {
  Simulator simulator =
      makeJaws(GetParam(),
               "    block: {size_m: [0.004, 0.01, 0.03], cells: [4, 5, 12]}\n"
               "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
               "    material: {youngs_modulus_pa: 20000, density_kg_per_m3: 1000, poissons_ratio: 0.3}\n");
  const JawTorques torques = closeJaws(simulator);
  EXPECT_NEAR(torques.left + torques.right, 0.004, 4e-5);
  EXPECT_NEAR(torques.left, 0.002, GetParam() ? 2e-4 : 4e-5);  // of one joint only the sum is given
  EXPECT_LT(torques.most, 1.15 * 0.004);
  EXPECT_GT(simulator.jointDeflections(0)[0], 0.2);

  const VectorX ones = simulator.instruments()[0].initialPositions().array() + 1.0;
  double least = 0.0;  // tissue that is let go holds no jaw back
  for (int k = 1; k <= 300; ++k) {
    simulator.advance(kStep, {(0.5 * std::min(1.0, k / 200.0) - 0.2) * ones});
    least = std::min(least, simulator.jointDeflections(0).minCoeff());
  }
  EXPECT_GT(least, -0.01);
  EXPECT_NEAR(simulator.jointDeflections(0).cwiseAbs().maxCoeff(), 0.0, 1e-4);
}

/// Both jaws press the same nodes of a sheet, from opposed sides.
TEST_P(Jaws, HoldASheet) {
  Simulator simulator = makeJaws(
      GetParam(),
      "    sheet: {size_m: [0.03, 0.01], cells: [12, 4], thickness_m: 0.001}\n"
      "    pose: {position_m: [0, 0, 0.015], rpy_rad: [0, 1.570796326794897, 0]}\n"
      "    fixed: [{box: {min_m: [0.0149, -1, -1], max_m: [1, 1, 1]}}]\n"
      "    material: {model: membrane, youngs_modulus_pa: 20000, density_kg_per_m3: 1000, poissons_ratio: 0.3}\n");
  const JawTorques torques = closeJaws(simulator);
  EXPECT_GT(simulator.jointDeflections(0)[0], 0.2);  // they do not go through
  const double mean = torques.left + torques.right;  // rigid shapes against each other: single steps swing about it
  EXPECT_GT(mean, 0.5 * 0.004);
  EXPECT_LT(mean, 4.0 * 0.004);
}

/// What one arm holds is not let go when another one jumps.
TEST(CompliantJoints, StayWhereTheyAreWhenAnotherArmJumps) {
  const std::string tissue = blockScene("[0.06, 0.06, 0.02]", "[6, 6, 3]");
  std::string arms = onlyBall("[0.001, 0.002, 0.0251]");
  arms.insert(arms.rfind("}\n"), ", compliant_joints: [{joint: z, stiffness_n_per_m: 20}]");
  arms += probeEntry("other", "/other", "[0, 0, 1]");
  Simulator simulator = makeSimulator(tissue + arms, {{"probe", probeUrdf(0.005)}});
  const Vector3 pressed(0.0, 0.0, -0.004);
  for (int k = 1; k <= 300; ++k) {
    simulator.advance(kStep, {Vector3(std::min(1.0, k / 200.0) * pressed), VectorX(Vector3::Zero())});
  }
  const double way = simulator.jointDeflections(0)[2];
  ASSERT_GT(way, 1e-3);
  simulator.advance(kStep, {pressed, Vector3(0.9, 0.0, 0.0)});
  ASSERT_TRUE(simulator.report().jumped);
  EXPECT_NEAR(simulator.jointDeflections(0)[2], way, 1e-3 * way);
}

TEST(CompliantJoints, AreNotRetuned) {
  Simulator simulator = ballOn("[{joint: z, stiffness_n_per_m: 20}]");
  const Simulator other = ballOn("[{joint: z, stiffness_n_per_m: 30}]");
  EXPECT_THROW(simulator.retune(other.scene()), std::invalid_argument);
  EXPECT_NO_THROW(simulator.retune(simulator.scene()));
}

TEST(CompliantJoints, AreSaved) {
  const std::string compliance = "[{joint: z, stiffness_n_per_m: 50, force_limit_n: 0.05}]";
  Simulator simulator = ballOn(compliance);
  press(simulator, -0.004, 0.0);
  const std::string state = simulator.saveState();
  Simulator other = ballOn(compliance);
  other.restoreState(state);
  EXPECT_EQ(other.jointDeflections(0)[2], simulator.jointDeflections(0)[2]);
  EXPECT_NE(other.jointDeflections(0)[2], 0.0);
  press(simulator, -0.006, 0.05);
  press(other, -0.006, 0.05);
  EXPECT_EQ(other.wrench(0).force, simulator.wrench(0).force);
  EXPECT_EQ(other.positions(0), simulator.positions(0));
  simulator.reset();
  EXPECT_EQ(simulator.jointDeflections(0)[2], 0.0);
  Simulator others = ballOn("[{joint: x, stiffness_n_per_m: 50, force_limit_n: 0.05}]");
  EXPECT_THROW(others.restoreState(state), std::invalid_argument);
}

TEST(CompliantJoints, AreNoneUnlessAsked) {
  Simulator simulator = makeSimulator(blockScene() + onlyBall("[0.001, 0.002, 0.0251]"), {{"probe", probeUrdf(0.005)}});
  EXPECT_EQ(simulator.jointDeflections(0).size(), 0);
}

/// A ball on stiff tissue, dragged at 5 mm/s along x; returns the largest of what `measure` makes of each step's force.
template <class Measure>
double mostInADrag(const std::string& youngs_modulus_pa, const std::string& compliance, const std::string& friction,
                   double depth_m, const Measure& measure) {
  std::string tissue = blockScene("[0.06, 0.03, 0.01]", "[6, 3, 1]", "poissons_ratio: 0.3");
  tissue.replace(tissue.find("5000"), 4, youngs_modulus_pa);
  std::string ball = onlyBall("[-0.01, 0, 0.0155]");
  ball.insert(ball.rfind("}\n"), ", compliant_joints: " + compliance);
  Simulator simulator = makeSimulator(tissue + ball + "friction: [{instrument: probe, tissue: block, " + friction +
                                          "}]\nsolver: {iterations: 100, tolerance: 1.0e-5}\n",
                                      {{"probe", probeUrdf(0.005)}});
  press(simulator, -0.0005 - depth_m);
  double most = 0.0;
  for (int k = 1; k <= 800; ++k) {
    simulator.advance(kStep, {Vector3(5e-6 * k, 0.0, -0.0005 - depth_m)});
    most = std::max(most, measure(simulator.wrench(0).force));
  }
  return most;
}

// A joint along the way gave way by all of its spring's force at once where the ball slid, friction turned round, and the ball went deeper by
// the square of its way: 7.2 N at .2 MPa where the joint that presses bears .1.
TEST(CompliantJoints, PressNoHarderThanTheirLimitWhileFrictionDragsThem) {
  for (const char* modulus : {"5.0e4", "2.0e5"}) {
    const double most = mostInADrag(
        modulus, "[{joint: x, stiffness_n_per_m: 200}, {joint: z, stiffness_n_per_m: 2000, force_limit_n: 0.1}]",
        "static: 0.6, kinetic: 0.3", 0.0005, [](const Vector3& force) { return force.z(); });
    EXPECT_LT(most, 0.2) << modulus;  // as it lets go, once
    EXPECT_GT(most, 0.1) << modulus;
  }
}

// One coefficient for both: friction is against the drag, always. It was up to .35 of the normal force along it.
TEST(CompliantJoints, FrictionDoesNotTurnRoundInADrag) {
  EXPECT_LT(mostInADrag("1.0e6", "[{joint: x, stiffness_n_per_m: 200}]", "static: 0.3", 1e-4,
                        [](const Vector3& force) { return force.x() / force.z(); }),
            0.02);
}

}  // namespace compliant_joints_test
}  // namespace tissue_contact
