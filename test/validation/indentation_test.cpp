/// Form H, press: rigid sphere of 40 mm radius pressed 0.625 mm without friction into a bonded block of 60 x 60 x 30
/// mm, E = 10 kPa, nu = 0.45, linear: P = 0.0613 N. And form J: what the instrument feels is what the tissue does not.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "validation/text_scene.h"

namespace tissue_contact {
namespace {

/// Graded block: `cells` across, half as many deep, cells growing by 1.15 away from the contact.
Simulator makePress(int cells, double mu) {
  std::ostringstream yaml;
  yaml << "tissues:\n  - name: block\n    block:\n      size_m: [0.06, 0.06, 0.03]\n      cells: [" << cells << ", "
       << cells << ", " << cells / 2
       << "]\n      grading: {x: {growth: 1.15, fine_at: center}, y: {growth: 1.15, fine_at: center},"
       << " z: {growth: 1.15, fine_at: maximum}}\n"
       << "    material: {model: linear, youngs_modulus_pa: 1.0e4, poissons_ratio: 0.45, density_kg_per_m3: 1000}\n"
       << "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
       << "instruments:\n  - name: probe\n    robot_description: probe\n    tip_link: tip\n"
       << "    joint_state_topics: [/joint_states]\n    base_pose: {position_m: [0, 0, 0.07]}\n    contact_links: "
          "[tip]\n"
       << "friction:\n  - {instrument: probe, tissue: block, static: " << mu << ", kinetic: " << mu << "}\n"
       << "step: {max_step_s: 0.02}\nsolver: {iterations: 150, tolerance: 1.0e-6}\n";
  return makeSimulator(yaml.str(), {{"probe", probeUrdf(0.04)}});
}

/// Lowers the sphere by `depth_m` in 0.2 s and waits 0.3 s; implicit Euler at 20 ms damps what is left of the motion.
void press(Simulator& simulator, double depth_m) {
  for (int k = 1; k <= 25; ++k) {
    const double share = std::min(1.0, k / 10.0);
    simulator.advance(0.02, {Vector3(0.0, 0.0, -share * depth_m)});
  }
}

// 24 cells across: 1.03 mm at the contact, 5 per contact radius. The faceted surface may not cut the sphere, so its
// nodes lie deeper by up to edge^2 / (8 R) = 7 micrometres of 625, which together with the stiffness of linear
// tetrahedra that grow away from the contact makes the force 7 % too large here (8.3 % with 1.4 mm cells, 4.9 % with
// 0.86 mm).
TEST(Indentation, PressForceOfTheBenchmarkBlock) {
  Simulator simulator = makePress(24, 0.0);
  press(simulator, 0.000625);
  const Wrench wrench = simulator.wrench(0);
  EXPECT_NEAR(wrench.force.z(), 0.0613, 0.10 * 0.0613);
  EXPECT_GT(wrench.force.z(), 0.0613);  // from above, as both causes want
  // Symmetric load, and a grid whose 5-tetrahedron split is not: a few per mille remain sideways.
  EXPECT_LE(std::hypot(wrench.force.x(), wrench.force.y()), 0.01 * wrench.force.z());
  RecordProperty("press_force_n", std::to_string(wrench.force.z()));
}

// A held press must come to rest (0.3 % is left by 150 iterations). With one closest point per face alone it cycles by
// 6 % for ever.
TEST(Indentation, HeldPressComesToRest) {
  Simulator simulator = makePress(16, 0.0);
  press(simulator, 0.000625);
  const double force = simulator.wrench(0).force.z();
  for (int k = 0; k < 5; ++k) {
    simulator.advance(0.02, {Vector3(0.0, 0.0, -0.000625)});
    EXPECT_NEAR(simulator.wrench(0).force.z(), force, 5e-3 * force);
  }
}

// At rest the fixed base carries what the instrument presses: elastic forces of the elements on the fixed nodes against the
// published wrench, force and moment. A thousandth is left of the motion and of the solver's tolerance.
TEST(Indentation, BaseCarriesWhatTheInstrumentFeels) {
  Simulator simulator = makePress(8, 0.3);
  press(simulator, 0.002);
  for (int k = 1; k <= 10; ++k) simulator.advance(0.02, {Vector3(1e-4 * k, 5e-5 * k, -0.002)});
  for (int k = 1; k <= 50; ++k) simulator.advance(0.02, {Vector3(1e-3, 5e-4, -0.002)});
  const Tissue& tissue = simulator.tissues()[0];
  const std::unique_ptr<Elasticity::State> state = tissue.elasticity().makeState();
  NodalVectors forces(3, tissue.nodeCount());
  tissue.elasticity().update(simulator.positions(0), *state, forces);
  Vector3 force = Vector3::Zero();
  Vector3 moment = Vector3::Zero();
  const Vector3 tip = simulator.linkPoses(0).back().translation();
  for (int i = 0; i < tissue.nodeCount(); ++i) {
    if (!tissue.fixed()[i]) continue;
    force += forces.col(i);
    moment += (simulator.positions(0).col(i) - tip).cross(Vector3(forces.col(i)));
  }
  const Wrench wrench = simulator.wrench(0);  // tip axes are world axes here
  EXPECT_GT(wrench.force.norm(), 0.1);
  EXPECT_LE((force + wrench.force).norm(), 1e-3 * wrench.force.norm());
  // Lever arms are of the order of the sphere's radius. Linear elasticity balances moments about undeformed positions.
  EXPECT_LE((moment + wrench.torque).norm(), 0.04 * 0.04 * wrench.force.norm());
}

TEST(Indentation, SameInputGivesTheSameBits) {
  Simulator first = makePress(8, 0.3);
  Simulator second = makePress(8, 0.3);
  for (int k = 1; k <= 20; ++k) {
    const VectorX target = Vector3(2e-4 * k, -1e-4 * k, -1e-4 * k);
    first.advance(0.01, {target});
    second.advance(0.01, {target});
  }
  EXPECT_EQ(first.positions(0), second.positions(0));
  EXPECT_EQ(first.wrench(0).force, second.wrench(0).force);
  // A reset puts back everything that could matter.
  first.reset();
  for (int k = 1; k <= 20; ++k) first.advance(0.01, {Vector3(2e-4 * k, -1e-4 * k, -1e-4 * k)});
  EXPECT_EQ(first.positions(0), second.positions(0));
  EXPECT_EQ(first.wrench(0).torque, second.wrench(0).torque);
}

}  // namespace
}  // namespace tissue_contact
