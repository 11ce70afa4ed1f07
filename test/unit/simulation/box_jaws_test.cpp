/// @file
/// A free block hangs in friction between two boxes smaller than its face: the tissue bends around their edges, where contacts lie on
/// the ridge between two faces of a box.
#include <gtest/gtest.h>

#include <string>

#include "support/text_scene.h"

namespace tissue_contact {
namespace box_jaws_test {

constexpr double kStep_s = 0.005, kWeight_n = 0.012 * 9.81, kSqueeze_m = 0.0016;

std::string slideUrdf(const std::string& axis) {
  return "<robot name='slide'><link name='base'/><link name='tip'/><joint name='x' type='prismatic'><parent "
         "link='base'/>"
         "<child link='tip'/><axis xyz='" +
         axis + "'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
}

std::string boxOn(const std::string& name, const std::string& position_m, const std::string& size_m) {
  return "  - {name: " + name + ", robot_description: " + name + ", tip_link: tip, joint_state_topics: [/" + name +
         "], base_pose: {position_m: " + position_m +
         "}, contact_links: [{link: tip, shapes: [{box: {size_m: " + size_m + "}}]}]}\n";
}

/// 20 x 20 x 30 mm of 6 kPa, .118 N, on a floor; faces of 16 x 16 mm stand .1 mm beside its own.
Simulator blockBetweenJaws(const std::string& relaxation) {
  return makeSimulator(
      "tissues:\n  - name: block\n    block: {size_m: [0.02, 0.02, 0.03], cells: [4, 4, 4]}\n"
      "    material: {youngs_modulus_pa: 6000, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n    damping: "
      "{stiffness_s: 0.003}\ngravity_m_per_s2: [0, 0, -9.81]\ninstruments:\n" +
          boxOn("left", "[-0.0151, 0, 0.015]", "[0.01, 0.016, 0.016]") +
          boxOn("right", "[0.0151, 0, 0.015]", "[0.01, 0.016, 0.016]") +
          boxOn("floor", "[0, 0, -0.01]", "[0.2, 0.2, 0.02]") +
          "friction:\n  - {instrument: left, tissue: block, static: 0.6, kinetic: 0.4}\n  - {instrument: right, "
          "tissue: "
          "block, static: 0.6, kinetic: 0.4}\nstep: {max_step_s: 0.005}\nsolver: {tolerance: 1e-4, iterations: 100, "
          "relaxation: " +
          relaxation + "}\n",
      {{"left", slideUrdf("1 0 0")}, {"right", slideUrdf("-1 0 0")}, {"floor", slideUrdf("0 0 1")}});
}

void advance(Simulator& simulator, double squeeze_m, double floor_m, int steps) {
  for (int k = 0; k < steps; ++k) {
    simulator.advance(kStep_s, std::vector<VectorX>{VectorX::Constant(1, squeeze_m), VectorX::Constant(1, squeeze_m),
                                                    VectorX::Constant(1, floor_m)});
  }
}

/// Squeezed by 15 %, the floor taken away, for .5 s.
Simulator heldBlock(const std::string& relaxation) {
  Simulator simulator = blockBetweenJaws(relaxation);
  for (int k = 1; k <= 40; ++k) advance(simulator, k / 40.0 * kSqueeze_m, 0.0, 1);
  advance(simulator, kSqueeze_m, -0.05, 100);
  return simulator;
}

// It walked up by 19 um in the first second and a half, 4 um/s after that, while what carries it swung.
TEST(BoxJaws, AFreeBlockHangsStill) {
  for (const std::string relaxation : {"cholesky", "gauss_seidel"}) {
    Simulator simulator = heldBlock(relaxation);
    const auto height = [&] { return simulator.positions(0).row(2).mean(); };
    const double before = height();
    double least = 1.0, most = 0.0;
    for (int k = 0; k < 200; ++k) {
      advance(simulator, kSqueeze_m, -0.05, 1);
      const double squeeze = -simulator.wrench(0).force.x();
      least = std::min(least, squeeze);
      most = std::max(most, squeeze);
      EXPECT_NEAR(-simulator.wrench(0).force.z() - simulator.wrench(1).force.z(), kWeight_n, 0.005 * kWeight_n);
    }
    EXPECT_NEAR(height(), before, 5e-7) << relaxation;
    EXPECT_LT(most - least, 2e-3 * most) << relaxation;
  }
}

}  // namespace box_jaws_test
}  // namespace tissue_contact
