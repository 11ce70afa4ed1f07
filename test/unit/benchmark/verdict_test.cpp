/// What the verdict on a user's own scene says, and how scenes are refined.
#include "benchmark/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <variant>

namespace tissue_contact {
namespace verdict_test {

Scene blockScene() {
  Scene scene;
  scene.tissues.resize(2);
  scene.tissues[0].name = "block";
  BlockDescription block;
  block.cells = {10, 5, 4};
  block.grading[2].growth = 1.3;
  scene.tissues[0].geometry = block;
  scene.tissues[1].name = "cloth";
  SheetDescription sheet;
  sheet.cells = {3, 2};
  scene.tissues[1].geometry = sheet;
  return scene;
}

TEST(ErrorVerdictTest, NamesTheLargestEstimateItsRemedyAndCost) {
  const ErrorVerdict verdict = judgeErrors({{"solver", 0.02, 0.02, "solver: {iterations: 60}", 2.0},
                                            {"step", 0.01, 0.02, "step: {max_step_s: 0.0005}", 2.0},
                                            {"mesh", 0.03, 0.09, "block: cells: [15, 15, 6]", 4.26}});
  EXPECT_EQ(verdict.dominating, 2);
  EXPECT_EQ(verdict.summary,
            "The mesh dominates: about 9.0 %. Change block: cells: [15, 15, 6]: costs 4.3 times the time.");
}

TEST(ErrorVerdictTest, SaysSoWhereNothingHelped) {
  EXPECT_EQ(judgeErrors({{"solver", 0.05, 0.05, "", 0.0}}).summary,
            "The solver dominates: about 5.0 %. None of the settings tried leaves less.");
}

TEST(ErrorVerdictTest, SmallErrorsNeedNoAdvice) {
  const ErrorVerdict verdict = judgeErrors({{"solver", 0.001, 0.001, "", 0.0}, {"step", 0.002, 0.01, "", 0.0}});
  EXPECT_EQ(verdict.dominating, -1);
  EXPECT_EQ(verdict.summary, "No source of error that was measured exceeds 1 %: keep the settings.");
}

TEST(ErrorVerdictTest, WhatWasNotMeasuredDoesNotDominate) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(judgeErrors({{"solver", nan, nan, "", 0.0}, {"step", 0.02, 0.04, "s", 2.0}}).dominating, 1);
  EXPECT_EQ(judgeErrors({{"solver", nan, nan, "", 0.0}}).dominating, -1);
}

TEST(RefinedSceneTest, RefinesGeneratedMeshesAndKeepsTheirGrading) {
  const auto refined = refinedScene(blockScene(), 1.5, 1e5);
  ASSERT_TRUE(refined.has_value());
  const auto& block = std::get<BlockDescription>(refined->tissues[0].geometry);
  EXPECT_EQ(block.cells, (std::array<int, 3>{15, 8, 6}));
  // Over the whole axis the cells still grow as much.
  EXPECT_NEAR(std::pow(block.grading[2].growth, 6), std::pow(1.3, 4), 1e-12);
  EXPECT_EQ(block.grading[0].growth, 1.0);
  EXPECT_EQ(std::get<SheetDescription>(refined->tissues[1].geometry).cells, (std::array<int, 2>{5, 3}));
  EXPECT_EQ(cellsText(*refined), "block: cells: [15, 8, 6]; cloth: cells: [5, 3]");
}

TEST(RefinedSceneTest, NothingToRefineOrTooManyNodes) {
  EXPECT_FALSE(refinedScene(blockScene(), 1.5, 1000.0).has_value());
  Scene scene = blockScene();
  scene.tissues.resize(1);
  scene.tissues[0].geometry = MeshDescription();
  EXPECT_FALSE(refinedScene(scene, 1.5, 1e5).has_value());
  EXPECT_EQ(cellsText(scene), "");
}

}  // namespace verdict_test
}  // namespace tissue_contact
