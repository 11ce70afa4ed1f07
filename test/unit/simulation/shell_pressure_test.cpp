/// Closed shells inflated by more than their wall bears.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/temporary_directory.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace shell_pressure_test {

constexpr double kRadius = 0.03;  // m

/// An octahedron, normals outward, or one without a face.
std::string octahedron(bool is_closed) {
  std::string obj;
  for (const char* vertex : {"1 0 0", "-1 0 0", "0 1 0", "0 -1 0", "0 0 1", "0 0 -1"}) {
    obj += std::string("v ") + vertex + "\n";
  }
  obj += "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\n";
  return obj + (is_closed ? "f 1 4 6\n" : "");
}

class ShellPressure : public ::testing::Test {
 protected:
  Simulator make(double pressure_pa, bool is_closed = true, const std::string& more = "") {
    return makeSimulator("tissues:\n  - name: bag\n    shell: {file: " +
                         directory_.write(is_closed ? "bag.obj" : "bowl.obj", octahedron(is_closed)) +
                         ", thickness_m: 0.001, scale_m_per_unit: " + std::to_string(kRadius) +
                         "}\n    material: {youngs_modulus_pa: 50000, poissons_ratio: 0.4, density_kg_per_m3: 1000}\n"
                         "    damping: {stiffness_s: 0.005, mass_per_s: 2}\n    pressure_pa: " +
                         std::to_string(pressure_pa) +
                         "\n    fixed: [{plane: {point_m: [0, 0, -0.029], normal: [0, 0, 1]}}]\n" + more);
  }

  static std::vector<std::string> doubts(const Simulator& simulator) {
    std::vector<std::string> texts;
    for (const Advice& advice : simulator.advice()) {
      if (advice.is_warning) texts.push_back(advice.text);
    }
    return texts;
  }

 private:
  TemporaryDirectory directory_;
};

// Before, positions went on to 1e70 m; their state was written, and refused when it was read.
TEST_F(ShellPressure, WhatBlowsUpStopsAndItsStateIsReadAgain) {
  Simulator simulator = make(-6000.0);
  Simulator other = make(-6000.0);
  bool is_discarded = false;
  for (int k = 0; k < 20; ++k) {
    simulator.advance(0.05, {});
    is_discarded = is_discarded || simulator.report().discarded;
    EXPECT_TRUE(simulator.positions(0).cwiseAbs().maxCoeff() <= 1e9);
    EXPECT_TRUE(simulator.velocities(0).cwiseAbs().maxCoeff() <= 1e9);
    ASSERT_NO_THROW(other.restoreState(simulator.saveState())) << k;
    EXPECT_EQ(other.positions(0), simulator.positions(0));
  }
  EXPECT_TRUE(is_discarded);
}

// R = 3 V / A = .0173 m of the octahedron; E h / (2 (1 - nu) R) = 2406 Pa.
TEST_F(ShellPressure, MoreThanTheWallBearsIsTold) {
  EXPECT_EQ(doubts(make(-2300.0)), std::vector<std::string>());
  const std::vector<std::string> inflated = doubts(make(-2500.0));
  ASSERT_EQ(inflated.size(), 1U);
  EXPECT_EQ(
      inflated[0].find("tissue 'bag': its closed shell is inflated by 2500 Pa, more than the 2400 Pa that a ball"), 0U)
      << inflated[0];
  EXPECT_EQ(doubts(make(2500.0)), std::vector<std::string>());          // from outside
  EXPECT_EQ(doubts(make(-2500.0, false)), std::vector<std::string>());  // a bowl
  EXPECT_EQ(doubts(make(-2500.0, true, "    pressure_where: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n")),
            std::vector<std::string>());
}

}  // namespace shell_pressure_test
}  // namespace tissue_contact
