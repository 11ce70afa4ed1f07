/// How far from a surface contacts are looked for: what lies elsewhere does not count.
#include "simulation/detection_margins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/text_scene.h"

namespace tissue_contact {
namespace detection_margins_test {

/// Coarse blocks of 20 mm cells, the upper one 74.5 mm above the lower; `fine`: 60 mm beside them lies a block of 1.5 mm cells.
Simulator makeFallingBlock(bool fine) {
  const std::string material =
      "    material: {youngs_modulus_pa: 20000, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
      "    damping: {stiffness_s: 0.01}\n";
  const std::string held = "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n";
  return makeSimulator(
      "gravity_m_per_s2: [0, 0, -9.81]\ntissues:\n"
      "  - name: bed\n    block: {size_m: [0.08, 0.08, 0.02], cells: [4, 4, 1]}\n" +
      material + held +
      "  - name: top\n    block: {size_m: [0.04, 0.04, 0.02], cells: [2, 2, 1]}\n"
      "    pose: {position_m: [0.003, 0.002, 0.0945]}\n" +
      material +
      (fine ? "  - name: fine\n    block: {size_m: [0.03, 0.03, 0.0045], cells: [20, 20, 3]}\n"
              "    pose: {position_m: [0.12, 0, 0]}\n" +
                  material + held
            : "") +
      "instruments: []\ntissue_pairs: [{tissue: bed, other: top}]\n"
      "friction: [{tissue: bed, other_tissue: top, static: 0.5}]\n"
      "step: {max_step_s: 0.01}\nsolver: {iterations: 20, tolerance: 1.0e-16}\n"
      "advisor: {sleep: never}\n");
}

/// Falls at 1.2 m/s, 12 mm in a step, of which 10 mm are left: two mean edges over all surfaces (3.7 mm) were too few to see it
/// come, and it ended 2 mm deep.
TEST(DetectionMargins, FineTissueElsewhereHidesNoContact) {
  Simulator alone = makeFallingBlock(false);
  Simulator beside = makeFallingBlock(true);
  for (int step = 0; step < 18; ++step) {
    alone.advance(0.01, {});
    beside.advance(0.01, {});
    ASSERT_EQ(alone.contacts().size(), beside.contacts().size()) << "step " << step;
    for (int tissue : {0, 1}) {
      ASSERT_LE((alone.positions(tissue) - beside.positions(tissue)).norm(), 1e-12) << "step " << step;
    }
  }
  EXPECT_FALSE(beside.contacts().empty());
}

/// At rest contacts are looked for within a hundredth of an edge.
std::size_t contactsAt(double gap_m, const std::string& block, double x_m) {
  const Simulator simulator = [&] {
    Simulator one = makeSimulator(
        "gravity_m_per_s2: [0, 0, 0]\ntissues:\n  - name: block\n    block: {size_m: [0.08, 0.04, 0.01], " + block +
        "}\n    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}\n"
        "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
        "instruments:\n" +
        probeEntry("probe", "/js", "[" + std::to_string(x_m) + ", 0, " + std::to_string(0.015 + gap_m) + "]") +
        "friction: [{instrument: probe, tissue: block, static: 0.5}]\n");
    one.advance(0.001, {Vector3::Zero()});
    return one;
  }();
  return simulator.contacts().size();
}

TEST(DetectionMargins, OfAGradedMeshAreThoseOfThePlace) {
  // Cells of 1.3 to 22 mm along x, of 5 mm along y. At -34.361 mm is a vertex: what is smooth beside its cells touches there.
  const std::string graded = "cells: [10, 8, 2], grading: {x: {growth: 1.37, fine_at: minimum}}";
  EXPECT_EQ(contactsAt(7e-5, graded, -0.034361), 0u);
  EXPECT_GT(contactsAt(7e-5, graded, 0.035), 0u);
  EXPECT_GT(contactsAt(2e-5, graded, -0.034361), 0u);
  EXPECT_GT(contactsAt(1.2e-4, graded, 0.03), 0u);
}

/// A slow tissue is not looked at farther because one that cannot reach it falls.
TEST(DetectionMargins, FollowTheSpeedOfWhatPairsJoin) {
  Simulator simulator = makeFallingBlock(true);
  const SurfaceEdges edges(simulator.tissues());
  DetectionMargins margins(edges, 3, {{0, 1}, {0, 0}});
  std::vector<NodalVectors> v;
  for (int tissue : {0, 1, 2}) v.emplace_back(NodalVectors::Zero(3, simulator.positions(tissue).cols()));
  v[1].row(2).setConstant(-2.0);
  margins.begin(v, Vector3::Zero(), 0.001, 0.0);
  EXPECT_DOUBLE_EQ(margins.ofTissues()[0], 0.003 + 0.01 * edges.largestScale(0));
  EXPECT_DOUBLE_EQ(margins.ofTissues()[1], 0.003 + 0.01 * edges.largestScale(1));
  EXPECT_DOUBLE_EQ(margins.ofTissues()[2], 0.01 * edges.largestScale(2));
  EXPECT_GT(edges.largestScale(0), 10.0 * edges.largestScale(2));
  EXPECT_NEAR(margins.ofPairs()[0], 0.006 + 0.01 * edges.largestScale(0), 1e-4);
  v[1].setConstant(1e200);  // its square overflows
  margins.begin(v, Vector3::Zero(), 0.001, 0.0);
  EXPECT_TRUE(std::isfinite(margins.ofTissues()[1]));
  EXPECT_DOUBLE_EQ(margins.ofPairs()[0], 2.0 * std::max(edges.largestScale(0), edges.largestScale(1)));
}

/// What falls on the first strikes the last through the one between, in the same step.
TEST(DetectionMargins, WhatIsStruckHandsTheSpeedOn) {
  const Simulator simulator = makeFallingBlock(true);
  const SurfaceEdges edges(simulator.tissues());
  std::vector<NodalVectors> v;
  for (int tissue : {0, 1, 2}) v.emplace_back(NodalVectors::Zero(3, simulator.positions(tissue).cols()));
  v[0].row(2).setConstant(-1.0);
  DetectionMargins joined(edges, 3, {{2, 1}, {0, 1}});
  joined.begin(v, Vector3::Zero(), 0.001, 0.0);
  EXPECT_GE(joined.ofPairs()[0], 0.0015);
  EXPECT_GE(joined.ofTissues()[2], 0.0015);
}

}  // namespace detection_margins_test
}  // namespace tissue_contact
