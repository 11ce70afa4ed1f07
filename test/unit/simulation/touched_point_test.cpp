/// Forces of a contact act where the tool touches the sheet, not in the sheet's middle surface (touched_point.h).
#include "tissue_contact/simulation/touched_point.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/text_scene.h"

namespace tissue_contact {
namespace touched_point_test {

constexpr double kRadius = 0.005;     // m
constexpr double kThickness = 0.004;  // m

// A ball dragged over a sheet on springs: forces on a ball act at its surface, so their moment about its middle is R n x f and that of the normal
// parts nothing. In the middle surface, R + t / 2 away, it was 1.39 times that.
TEST(TouchedPoint, FrictionOnABallHasTheArmOfItsRadius) {
  Simulator simulator = makeSimulator(
      "gravity_m_per_s2: [0, 0, 0]\nstep: {max_step_s: 0.005}\ntissues:\n  - name: sheet\n"
      "    sheet: {size_m: [0.04, 0.04], cells: [16, 16], thickness_m: 0.004}\n"
      "    material: {youngs_modulus_pa: 5.0e5, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
      "    damping: {stiffness_s: 0.01}\n"
      "    attachments: [{where: [box: {min_m: [-1, -1, -1], max_m: [1, 1, 1]}], stiffness_pa_per_m: 3.0e6}]\n" +
          onlyBall("[0, 0, 0.0071]") + "friction: [{instrument: probe, tissue: sheet, static: 0.5}]\n",
      {{"probe", probeUrdf(kRadius)}});
  for (int k = 1; k <= 60; ++k) {
    simulator.advance(0.005, {Vector3(1e-4 * std::max(k - 20, 0), 0.0, -6e-4 * std::min(k / 20.0, 1.0))});
  }
  const Wrench wrench = simulator.wrench(0);
  Vector3 torque = Vector3::Zero();
  const Vector3 centre = simulator.linkPoses(0).back().translation();
  for (const SolvedContact& one : simulator.contacts()) {
    if (one.state == ContactState::kOpen) continue;
    torque -= kRadius * one.contact.R_WC.col(0).cross(one.force_on_tissue_n);
    // What is left of a gap of the step's start.
    EXPECT_NEAR((touchedPoint(one.contact, simulator.tissues()) - centre).norm(), kRadius, 0.03 * kRadius);
    EXPECT_NEAR((one.contact.p_WC - centre).norm(), kRadius + 0.5 * kThickness, 0.03 * kRadius);
  }
  EXPECT_GT(wrench.force.head<2>().norm(), 0.3 * wrench.force.z());  // it slides
  EXPECT_NEAR(wrench.torque.y(), torque.y(), 0.03 * torque.norm());  // vertices are pressed along mean normals
}

}  // namespace touched_point_test
}  // namespace tissue_contact
