/// Form B: a free block on an incline. It holds exactly while tan(theta) < mu_s, slides with g (sin - mu cos), does not
/// creep; and form J: its weight is the sum of the contact forces, and it falls freely before it lands.
#include <gtest/gtest.h>

#include <cmath>

#include "support/test_scene.h"

namespace tissue_contact {
namespace {

constexpr double kGravity = 9.81;

/// 60 x 60 x 30 mm, 108 g, resting on a table tilted about y by `degrees`, so that +x of the table points downhill.
Simulator makeIncline(double degrees, double mu_static, double mu_kinetic, double height_m = 0.0) {
  const double theta = degrees * M_PI / 180.0;
  std::ostringstream yaml;
  yaml.precision(17);
  yaml
      << "gravity_m_per_s2: [0, 0, -9.81]\n"
      << "tissues:\n  - name: block\n    block: {size_m: [0.06, 0.06, 0.03], cells: [4, 4, 2]}\n"
      << "    pose: {position_m: [" << height_m * std::sin(theta) << ", 0, " << height_m * std::cos(theta)
      << "], rpy_rad: [0, " << theta << ", 0]}\n"
      << "    material: {model: corotational, youngs_modulus_pa: 1.0e5, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
      << "    damping: {stiffness_s: 0.005}\n"
      << "instruments:\n  - name: table\n    robot_description: table\n    tip_link: table\n"
      << "    base_pose: {position_m: [0, 0, 0], rpy_rad: [0, " << theta << ", 0]}\n    contact_links: [table]\n"
      << "friction:\n  - {instrument: table, tissue: block, static: " << mu_static << ", kinetic: " << mu_kinetic
      << "}\n"
      << "step: {max_step_s: 0.001}\nsolver: {iterations: 200, tolerance: 1.0e-9}\n";
  return test::makeSimulator(yaml.str(), {{"table", test::tableUrdf()}});
}

void run(Simulator& simulator, double seconds) {
  const std::vector<VectorX> no_joints(1, VectorX());
  for (int k = 0; k < static_cast<int>(std::lround(seconds / 0.001)); ++k) simulator.advance(0.001, no_joints);
}

Vector3 massCenter(const Simulator& simulator, const NodalVectors& values) {
  const VectorX& masses = simulator.tissues()[0].nodeMasses();
  return values * masses / masses.sum();
}

/// Mean downhill acceleration over one second, after half a second in which landing vibrations die.
double downhillAcceleration(double degrees, double mu) {
  Simulator simulator = makeIncline(degrees, mu, mu);
  const double theta = degrees * M_PI / 180.0;
  const Vector3 downhill(std::cos(theta), 0.0, -std::sin(theta));
  run(simulator, 0.5);
  const double before = downhill.dot(massCenter(simulator, simulator.velocities(0)));
  run(simulator, 1.0);
  return downhill.dot(massCenter(simulator, simulator.velocities(0))) - before;
}

// mu = 0.3: the critical angle is 16.699 degrees.
TEST(Incline, HoldsJustBelowTheCriticalAngleWithoutCreep) {
  Simulator simulator = makeIncline(16.6, 0.3, 0.3);
  run(simulator, 1.0);
  const Vector3 start = massCenter(simulator, simulator.positions(0));
  run(simulator, 60.0);
  const Vector3 end = massCenter(simulator, simulator.positions(0));
  EXPECT_EQ(simulator.report().kinetic_contacts, 0);
  EXPECT_GT(simulator.report().static_contacts, 3);
  // One micrometre in a minute: 0.3 nm per minute per newton is what double round-off alone would allow.
  EXPECT_LE((end - start).norm(), 1e-6);
}

TEST(Incline, SlidesJustAboveTheCriticalAngle) {
  EXPECT_NEAR(downhillAcceleration(16.8, 0.3), 0.0180, 1e-3 * kGravity);
}

TEST(Incline, SlidesWithGravityMinusFriction) { EXPECT_NEAR(downhillAcceleration(20.0, 0.3), 0.5897, 1e-3 * kGravity); }

// tan 20 = 0.364. Gravity sets in at once, so shear overshoots to up to twice its final value: mu_s must cover that.
TEST(Incline, StaticCoefficientHoldsWhatKineticWouldNot) {
  Simulator simulator = makeIncline(20.0, 0.8, 0.3);
  run(simulator, 1.0);
  const Vector3 start = massCenter(simulator, simulator.positions(0));
  run(simulator, 1.0);
  EXPECT_LE((massCenter(simulator, simulator.positions(0)) - start).norm(), 1e-7);
}

TEST(Incline, WeightIsTheContactForceAndItsMomentBalances) {
  Simulator simulator = makeIncline(10.0, 0.5, 0.5);
  run(simulator, 1.5);
  const double weight = kGravity * simulator.tissues()[0].nodeMasses().sum();
  const double theta = 10.0 * M_PI / 180.0;
  const Wrench on_table = simulator.wrench(0);  // in table axes
  EXPECT_NEAR(on_table.force.x(), weight * std::sin(theta), 1e-5 * weight);
  EXPECT_NEAR(on_table.force.y(), 0.0, 1e-5 * weight);
  EXPECT_NEAR(on_table.force.z(), -weight * std::cos(theta), 1e-5 * weight);
  // The table feels the weight through the block's mass centre.
  const Vector3 center = massCenter(simulator, simulator.positions(0));
  const Vector3 moment_W = center.cross(Vector3(0.0, 0.0, -weight));
  const Vector3 moment = Eigen::AngleAxisd(-theta, Vector3::UnitY()) * moment_W;
  EXPECT_LE((on_table.torque - moment).norm(), 1e-5 * weight * 0.03);
}

TEST(FreeFall, FollowsImplicitEulerExactlyUntilItLands) {
  Simulator simulator = makeIncline(0.0, 0.3, 0.3, 0.1);
  const Vector3 start = massCenter(simulator, simulator.positions(0));
  run(simulator, 0.1);
  const int steps = 100;
  const double fallen = kGravity * 1e-6 * 0.5 * steps * (steps + 1);  // sum of k g dt^2
  // The solver stops at a relative change of 1e-9 in each of the 100 steps.
  EXPECT_NEAR(massCenter(simulator, simulator.positions(0)).z() - start.z(), -fallen, 1e-7 * fallen);
  EXPECT_EQ(simulator.report().static_contacts + simulator.report().kinetic_contacts, 0);
  run(simulator, 1.5);
  EXPECT_NEAR(massCenter(simulator, simulator.positions(0)).z(), 0.015, 1e-4);  // landed, and settled under its weight
}

}  // namespace
}  // namespace tissue_contact
