/// Sheets between two sides: what squeezes them meets their thickness (SheetThickness), by every solver, and compliant joints
/// come to rest on it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "support/text_scene.h"
#include "tissue_contact/scene/tuning.h"

namespace tissue_contact {
namespace sheet_thickness_test {

constexpr double kStep = 0.001;
constexpr double kThickness = 1e-3;  // m

/// Two boxes that face each other, their sides at the distance 2 (.003 + q) for positions q of both joints.
std::string jawsUrdf(const std::string& box_size) {
  const std::string link = "<collision><geometry><box size='" + box_size + "'/></geometry></collision></link>";
  const auto joint = [](const std::string& name, const std::string& sign) {
    return "<joint name='" + name + "_joint' type='prismatic'><parent link='base'/><child link='" + name +
           "'/><origin xyz='0 0 " + sign + "0.004'/><axis xyz='0 0 " + sign +
           "1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
  };
  return "<robot name='jaws'><link name='base'/><link name='upper'>" + link + "<link name='lower'>" + link +
         joint("upper", "") + joint("lower", "-") + "</robot>";  // boxes are 2 mm thick
}

struct Sheet {
  std::string cells = "[5, 5]";
  std::string youngs_modulus_pa = "50000";
  std::string poissons_ratio = "0.3";
};

/// A free sheet of 10 mm in the middle between the boxes.
Simulator sheetBetween(
    const std::string& box_size, const Sheet& sheet, const std::string& more_of_jaws = "",
    const std::string& end = "friction: [{instrument: jaws, tissue: sheet, static: 0.6, kinetic: 0.5}]\n") {
  return makeSimulator(
      "gravity_m_per_s2: [0, 0, 0]\ntissues:\n  - name: sheet\n    sheet: {size_m: [0.01, 0.01], cells: " +
          sheet.cells + ", thickness_m: 0.001}\n    material: {youngs_modulus_pa: " + sheet.youngs_modulus_pa +
          ", poissons_ratio: " + sheet.poissons_ratio +
          ", density_kg_per_m3: 1000}\n    damping: {stiffness_s: 0.003, mass_per_s: 20}\n"
          "instruments:\n  - {name: jaws, robot_description: jaws, tip_link: base, contact_links: [upper, lower], "
          "joint_state_topics: [/js]" +
          more_of_jaws + "}\n" + end,
      {{"jaws", jawsUrdf(box_size)}});
}

/// Force of the upper and the lower box on the sheet, along its normal, N.
Vector2 squeezeOf(const Simulator& simulator) {
  Vector2 force = Vector2::Zero();
  for (const SolvedContact& solved : simulator.contacts())
    force[solved.contact.key.link] += solved.force_on_tissue_n.z();
  return force;
}

/// Closes the jaws to this distance in .1 s and holds them there.
void closeTo(Simulator& simulator, double distance_m, double rest_s) {
  const double to = 0.5 * distance_m - 0.003;
  const auto steps = static_cast<int>(std::lround((0.1 + rest_s) / kStep));
  for (int k = 1; k <= steps; ++k) simulator.advance(kStep, {Vector2::Constant(to * std::min(k / 100.0, 1.0))});
}

/// (lambda + 2 mu) A (t - d) / t, as a sheet that does not stretch meanwhile has it.
double plateForce(double youngs_modulus_pa, double nu, double distance_m) {
  const double modulus = youngs_modulus_pa * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
  return modulus * 1e-4 * (kThickness - distance_m) / kThickness;
}

TEST(SheetThickness, PlatesMeetTheModulusOfTheSheet) {
  for (const char* end :
       {"friction: [{instrument: jaws, tissue: sheet, static: 0.6, kinetic: 0.5}]\n", "",
        "solver: {relaxation: cholesky}\n", "solver: {method: reference}\n", "solver: {method: cone4}\n"}) {
    for (const double distance : {0.9e-3, 0.5e-3}) {
      Simulator simulator = sheetBetween("0.02 0.02 0.002", {}, "", end);
      closeTo(simulator, distance, 0.3);
      const double expected = plateForce(50000, 0.3, distance);
      const Vector2 force = squeezeOf(simulator);
      EXPECT_NEAR(-force[0], expected, 2e-3 * expected) << end << distance;  // twice the solver's tolerance
      EXPECT_NEAR(force[1], expected, 2e-3 * expected) << end << distance;
      EXPECT_LE(simulator.residuals().penetration_m, 0.01 * (kThickness - distance))
          << "beyond the squeeze: ten times the tolerance";
      EXPECT_EQ(simulator.report().stop, StopReason::kTolerance) << end;
    }
  }
}

TEST(SheetThickness, NearlyIncompressibleSheetsFlowOut) {
  Simulator simulator = sheetBetween("0.02 0.02 0.002", {"[5, 5]", "50000", "0.49"});
  closeTo(simulator, 0.9e-3, 0.1);
  const double expected = plateForce(50000, 0.45, 0.9e-3);
  EXPECT_NEAR(squeezeOf(simulator)[1], expected, 2e-3 * expected);
}

/// Boxes smaller than the sheet have contacts at vertices, edges and faces, which share what the nodes resist with: of fine
/// cells the area of the boxes and half a cell around it.
TEST(SheetThickness, SmallJawsMeetTheAreaTheyCover) {
  constexpr double kCell = 0.5e-3;
  Simulator simulator = sheetBetween("0.004 0.003 0.002", {"[20, 20]", "50000", "0.3"});
  closeTo(simulator, 0.8e-3, 0.1);
  const double of_boxes = plateForce(50000, 0.3, 0.8e-3) * (0.004 * 0.003) / 1e-4;
  const double with_rim = plateForce(50000, 0.3, 0.8e-3) * ((0.004 + kCell) * (0.003 + kCell)) / 1e-4;
  EXPECT_GE(squeezeOf(simulator)[1], of_boxes);
  EXPECT_LE(squeezeOf(simulator)[1], 1.02 * with_rim);
}

/// Without the thickness the squeeze swung to three times the limit, for ever.
TEST(SheetThickness, CompliantJawsRestOnASheet) {
  const std::string both =
      ", compliant_joints: [{joint: upper_joint, stiffness_n_per_m: 1000, force_limit_n: 0.3}, "
      "{joint: lower_joint, stiffness_n_per_m: 1000, force_limit_n: 0.3}]";
  for (const char* youngs_modulus_pa : {"20000", "1000000"}) {
    Simulator simulator = sheetBetween("0.004 0.003 0.002", {"[8, 8]", youngs_modulus_pa, "0.4"}, both);
    closeTo(simulator, -0.001, 0.3);
    double most = 0.0;
    double least = 1e9;
    for (int k = 0; k < 50; ++k) {
      simulator.advance(kStep, {Vector2::Constant(-0.0035)});
      most = std::max(most, squeezeOf(simulator)[1]);
      least = std::min(least, squeezeOf(simulator)[1]);
    }
    EXPECT_NEAR(most, 0.3, 0.003) << youngs_modulus_pa;
    EXPECT_NEAR(least, 0.3, 0.003) << youngs_modulus_pa;
  }
}

TEST(SheetThickness, FollowsYoungsModulusInTheNextSteps) {
  Simulator simulator = sheetBetween("0.02 0.02 0.002", {});
  closeTo(simulator, 0.9e-3, 0.1);
  simulator.retune(tuned(simulator.scene(), {{"tissues/sheet/youngs_modulus_pa", 100000.0}}));
  for (int k = 0; k < 100; ++k) simulator.advance(kStep, {simulator.jointPositions(0)});
  const double expected = plateForce(100000, 0.3, 0.9e-3);
  EXPECT_NEAR(squeezeOf(simulator)[1], expected, 2e-3 * expected);
}

/// Contacts between tissues that are known, squeezed ones and the rate of momentum are all in a saved state.
TEST(SheetThickness, ASavedStateGoesOnWithTheSameBits) {
  const auto make = [] {
    return makeSimulator(
        blockScene("[0.04, 0.04, 0.02]", "[8, 8, 4]") +
            "  - name: layer\n    sheet: {size_m: [0.03, 0.03], cells: [8, 8], thickness_m: 0.001}\n"
            "    pose: {position_m: [0, 0, 0.0202]}\n    material: {youngs_modulus_pa: 50000, poissons_ratio: 0.4, "
            "density_kg_per_m3: 1000}\n    damping: {stiffness_s: 0.003, mass_per_s: 5}\n" +
            onlyBall("[0, 0, 0.026]") +
            "tissue_pairs: [{tissue: block, other: layer}]\n"
            "friction: [{instrument: probe, tissue: layer, static: 0.5, kinetic: 0.4}]\n",
        {{"probe", probeUrdf(0.005)}});
  };
  Simulator goes_on = make();
  const auto advance = [](Simulator& simulator, int step) {
    simulator.advance(kStep, {Vector3(0.0, 0.0, -2.5e-5 * step)});
  };
  for (int k = 1; k <= 120; ++k) advance(goes_on, k);
  Simulator loaded = make();
  loaded.restoreState(goes_on.saveState());
  for (int k = 121; k <= 150; ++k) {
    for (Simulator* simulator : {&goes_on, &loaded}) advance(*simulator, k);
    ASSERT_EQ(goes_on.wrench(0).force, loaded.wrench(0).force) << k;
    ASSERT_EQ(goes_on.forceErrors()[0].step_n, loaded.forceErrors()[0].step_n) << k;
    ASSERT_EQ(goes_on.contacts().size(), loaded.contacts().size()) << k;
  }
  EXPECT_GT(goes_on.wrench(0).force.z(), 0.01);
}

/// The other side may be a tissue: a sheet that lies on a stiff block gives way by half its thickness from each side as well.
TEST(SheetThickness, ASheetOnABlockIsSqueezedToo) {
  Simulator simulator = makeSimulator(
      "gravity_m_per_s2: [0, 0, 0]\ntissues:\n  - name: bed\n    block: {size_m: [0.02, 0.02, 0.01], cells: [4, 4, "
      "2]}\n"
      "    pose: {position_m: [0, 0, -0.01]}\n"
      "    material: {youngs_modulus_pa: 1.0e8, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
      "    damping: {stiffness_s: 0.003}\n    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
      "  - name: sheet\n    sheet: {size_m: [0.01, 0.01], cells: [5, 5], thickness_m: 0.001}\n"
      "    pose: {position_m: [0.0003, 0.0002, 0.0005]}\n"
      "    material: {youngs_modulus_pa: 50000, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
      "    damping: {stiffness_s: 0.003, mass_per_s: 20}\n"
      "instruments:\n  - {name: jaws, robot_description: jaws, tip_link: base, contact_links: [upper], "
      "joint_state_topics: "
      "[/js]}\ntissue_pairs: [{tissue: bed, other: sheet}]\nsolver: {relaxation: cholesky}\n",
      {{"jaws", jawsUrdf("0.02 0.02 0.002")}});
  simulator.placeInstrument(0, Vector2::Constant(-0.0019));  // just above the sheet
  for (int k = 1; k <= 200; ++k) simulator.advance(kStep, {Vector2::Constant(-0.0019 - 3e-6 * std::min(k, 100))});
  double force = 0.0;
  for (const SolvedContact& solved : simulator.contacts()) {
    if (solved.contact.key.instrument == 0) force -= solved.force_on_tissue_n.z();
  }
  const double expected = plateForce(50000, 0.3, 0.8e-3);
  EXPECT_NEAR(force, expected, 0.02 * expected);  // the block gives way by 1 % of that
}

}  // namespace sheet_thickness_test
}  // namespace tissue_contact
