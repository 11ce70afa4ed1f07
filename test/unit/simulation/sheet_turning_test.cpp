/// Sheets that turn with the tools that hold them: their surfaces move beside their middle surfaces (StepContacts).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/text_scene.h"

namespace tissue_contact {
namespace sheet_turning_test {

constexpr double kStep = 0.002;     // s
constexpr double kHalfJaw = 0.005;  // m

/// Two boxes that close along z, on a wrist that turns about y.
const char* const kGripper =
    "<robot name='gripper'><link name='base'/><link name='wrist'/><joint name='turn' type='revolute'>"
    "<parent link='base'/><child link='wrist'/><axis xyz='0 1 0'/><limit lower='-9' upper='9' effort='1' "
    "velocity='1'/></joint><joint name='close' type='prismatic'><parent link='wrist'/><child link='up'/>"
    "<axis xyz='0 0 -1'/><limit lower='-9' upper='9' effort='1' velocity='1'/></joint><joint name='other' "
    "type='prismatic'><parent link='wrist'/><child link='low'/><axis xyz='0 0 1'/><mimic joint='close'/><limit "
    "lower='-9' upper='9' effort='1' velocity='1'/></joint><link name='up'><collision><geometry><box size='0.03 0.03 "
    "0.01'/></geometry></collision></link><link name='low'><collision><geometry><box size='0.03 0.03 0.01'/>"
    "</geometry></collision></link></robot>";

struct Turned {
  int sliding = 0;          ///< contacts, over all steps
  double along_n = 0.0;     ///< of the upper jaw along x of the wrist, at the end
  double normal_n = 0.0;    ///< of the upper jaw
  double walked_m = 0.0;    ///< the tissue's middle over the wrist
  double moment_n_m = 0.0;  ///< on both jaws, at the end
};

Vector3 middleOf(const Simulator& simulator) { return simulator.positions(0).rowwise().mean(); }

/// Closes on the tissue in .2 s, by a tenth of its thickness, turns by `angle` in .5 s and holds for .1 s.
Turned turnGrip(const std::string& tissue, double thickness_m, double angle) {
  Simulator simulator = makeSimulator(
      "gravity_m_per_s2: [0, 0, 0]\ntissues:\n  - name: held\n    " + tissue +
          "\n    material: {youngs_modulus_pa: 50000, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n    damping: "
          "{stiffness_s: 0.002}\ninstruments:\n  - {name: grip, robot_description: gripper, tip_link: wrist, "
          "contact_links: [up, low], joint_state_topics: [/js]}\nfriction: [{instrument: grip, tissue: held, static: "
          "0.6, kinetic: 0.3}]\nstep: {max_step_s: 0.002}\nsolver: {iterations: 200, tolerance: 1.0e-4}\n",
      {{"gripper", kGripper}});
  const double clear = 0.5 * thickness_m + kHalfJaw + 5e-4;
  const double closed = 0.45 * thickness_m + kHalfJaw;
  simulator.placeInstrument(0, Vector2(0.0, -clear));
  for (int k = 1; k <= 100; ++k) simulator.advance(kStep, {Vector2(0.0, -clear + (clear - closed) * k / 100)});
  for (int k = 1; k <= 50; ++k) simulator.advance(kStep, {Vector2(0.0, -closed)});
  Turned found;
  const Vector3 before = middleOf(simulator);
  for (int k = 1; k <= 300; ++k) {
    const double share = 0.5 * (1.0 - std::cos(M_PI * std::min(k / 250.0, 1.0)));
    simulator.advance(kStep, {Vector2(angle * share, -closed)});
    found.sliding += simulator.report().kinetic_contacts;
  }
  const Matrix3 R_WT = simulator.linkPoses(0)[1].linear();
  Vector3 upper = Vector3::Zero();
  for (const SolvedContact& solved : simulator.contacts()) {
    if (solved.contact.key.link == 0) upper -= R_WT.transpose() * solved.force_on_tissue_n;
  }
  found.along_n = upper.x();
  found.normal_n = upper.z();
  found.walked_m = (R_WT.transpose() * middleOf(simulator) - before).norm();
  found.moment_n_m = simulator.wrench(0).torque.norm();
  return found;
}

// A turn as one changes nothing. The sheet walked by half its thickness times the angle, .4 mm, until all contacts of one jaw let go; the jaws then opposed
// each other by .3 of 1.35 N. Without friction's limit they would have by all that the sheet resists in shear.
TEST(SheetTurning, AGripThatTurnsHoldsItsSheet) {
  for (const double thickness : {0.001, 0.0005}) {
    const Turned found = turnGrip(
        "sheet: {size_m: [0.02, 0.01], cells: [8, 4], thickness_m: " + std::to_string(thickness) + "}", thickness, 1.0);
    EXPECT_GT(found.normal_n, 1.0);
    EXPECT_EQ(found.sliding, 0) << thickness;
    EXPECT_LT(std::abs(found.along_n), 2e-3 * found.normal_n) << thickness;
    EXPECT_LT(found.walked_m, 2e-6) << thickness;
    EXPECT_LT(found.moment_n_m, 1e-3 * found.normal_n * thickness) << thickness;
  }
}

/// A sheet lies on a plate that tilts to .5 rad and back, on a block that lies there or on the plate itself.
double walkOnPlate(bool on_block, double thickness_m) {
  std::string tissues =
      "  - name: sheet\n    sheet: {size_m: [0.02, 0.02], cells: [4, 4], thickness_m: " + std::to_string(thickness_m) +
      "}\n    pose: {position_m: [0, 0, " + std::to_string((on_block ? 0.01 : 0.0) + 0.5 * thickness_m) + "]}\n";
  const std::string material =
      "    material: {youngs_modulus_pa: 2.0e5, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n    damping: "
      "{stiffness_s: 0.002}\n";
  tissues += material;
  std::string pairs = "friction:\n  - {instrument: plate, tissue: sheet, static: 3}\n";
  if (on_block) {
    tissues += "  - name: block\n    block: {size_m: [0.03, 0.03, 0.01], cells: [4, 4, 2]}\n" + material;
    pairs +=
        "  - {instrument: plate, tissue: block, static: 3}\n  - {tissue: sheet, other_tissue: block, static: 3}\n"
        "tissue_pairs: [{tissue: sheet, other: block}]\n";
  }
  Simulator simulator = makeSimulator(
      "gravity_m_per_s2: [0, 0, -9.81]\ntissues:\n" + tissues +
          "instruments:\n  - {name: plate, robot_description: gripper, tip_link: wrist, contact_links: [{link: wrist, "
          "shapes: [{box: {size_m: [0.4, 0.4, 0.02]}, pose: {position_m: [0, 0, -0.01]}}]}], joint_state_topics: "
          "[/js]}\n" +
          pairs + "step: {max_step_s: 0.005}\nsolver: {relaxation: cholesky, iterations: 100, tolerance: 1.0e-5}\n",
      {{"gripper", kGripper}});
  const auto go = [&](double angle) { simulator.advance(0.005, {Vector2(angle, 0.0)}); };
  for (int k = 0; k < 60; ++k) go(0.0);
  const Vector3 before = middleOf(simulator);
  double farthest = 0.0;
  for (int k = 1; k <= 200; ++k) {
    go(0.25 * (1.0 - std::cos(0.01 * M_PI * k)));
    const Vector3 now = simulator.linkPoses(0)[1].linear().transpose() * middleOf(simulator);
    farthest = std::max(farthest, std::abs(now.x() - before.x()));
  }
  return farthest;
}

// Half the thickness times the angle before: .5 mm.
TEST(SheetTurning, ASheetStaysWhereItLies) {
  EXPECT_LT(walkOnPlate(false, 0.002), 1e-5);
  EXPECT_LT(walkOnPlate(true, 0.002), 5e-5);  // the block shears by some of it
}

}  // namespace sheet_turning_test
}  // namespace tissue_contact
