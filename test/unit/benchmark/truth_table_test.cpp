/// Stored truths: what is read, what is refused, and that the product, refined where it counts, comes near them.
#include "benchmark/truth_table.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "benchmark/measures.h"
#include "benchmark/scenes.h"
#include "support/refusal.h"
#include "support/temporary_directory.h"

namespace tissue_contact {
namespace truth_table_test {

using RunRecord = Run;  // Run alone is a member of testing::Test

class TruthTableTest : public testing::Test {
 protected:
  std::string write(const std::string& text) const { return directory_.write("truth.csv", text); }

  void expectRefused(const std::string& text, const std::string& words) const {
    expectRefusal([&] { readTruthTable(write(text)); }, {words});
  }

  const std::string head_ = "# how: by hand\n# uncertainty: 0.004\n";
  const std::string columns_ = "time_s,force_x_n,force_y_n,force_z_n\n";
  TemporaryDirectory directory_;
};

TEST_F(TruthTableTest, GivesForcesAtTheTimesOfARun) {
  const TruthTable table = readTruthTable(write(head_ + columns_ + "0.01,1,2,3\n0.02,4,5,6\n0.03,7,8,9\n"));
  EXPECT_EQ(table.how, "by hand");
  EXPECT_EQ(table.uncertainty, 0.004);
  RunRecord like;
  like.times_s = {0.01, 0.03};
  like.wrenches.assign(2, std::vector<Wrench>(2));
  const RunRecord truth = truthAt(table, like);
  ASSERT_EQ(truth.wrenches.size(), 2U);
  EXPECT_EQ(truth.wrenches[0][0].force, Vector3::Zero());
  EXPECT_EQ(truth.wrenches[0][1].force, Vector3(1, 2, 3));
  EXPECT_EQ(truth.wrenches[1][1].force, Vector3(7, 8, 9));
  like.times_s = {0.015};
  EXPECT_THROW(truthAt(table, like), std::invalid_argument);
  like.times_s = {0.04};
  EXPECT_THROW(truthAt(table, like), std::invalid_argument);
}

TEST_F(TruthTableTest, NamesTheLineItRefuses) {
  expectRefused(head_ + "time_s,force_z_n\n0,1\n", "truth.csv:3: the columns must be");
  expectRefused(head_ + columns_ + "0,1,2,3\n0,1,2,3\n", ":5: times must ascend");
  for (const char* row : {"0,1,2\n", "0,1,2,3,4\n", "0,1,2,x\n", "0,1,2,nan\n", "\n"}) {
    expectRefused(head_ + columns_ + row, ":4: four finite numbers");
  }
  for (const char* head : {"# how: by hand\n", "# uncertainty: 0.1\n", "# how: by hand\n# uncertainty: 0\n",
                           "# how: by hand\n# uncertainty: nan\n", "# how: by hand\n# uncertainty: inf\n"}) {
    expectRefused(head + columns_ + "0,1,2,3\n", "'# uncertainty: <share of the force, > 0>', '# how: <words>'");
  }
  expectRefused(head_ + columns_, "rows are needed");
}

double errorOf(const ScenePlan& plan, const Settings& settings) {
  const RunRecord run = runScene(plan.scene, settings);
  return wrenchError(run, truthAt(readTruthTable(plan.truth.table), run)).relative;
}

// Press and the first 4 mm of the drag; cells of 2.3 mm across the drag and 1.6 mm deep under the ball in place of 10 mm. The
// mesh's error is 6 %, all of one sign (too stiff): a truth or a scene that changed by more than 1.5 % shows.
TEST(StoredTruthTest, PressAndDragComesNearItWithFineCellsUnderTheBall) {
  SceneOptions beginning;
  beginning.quick = true;
  ScenePlan plan = pressDragPlan(beginning);
  Settings settings = shippedSettings(plan.scene);
  settings.dt_s = 0.002;
  EXPECT_GT(errorOf(plan, settings), 0.5);
  auto& block = std::get<BlockDescription>(plan.scene.scene.tissues[0].geometry);
  block.cells = settings.cells = {30, 18, 9};
  block.grading[0].growth = 1.05;
  block.grading[1].growth = 1.2;
  block.grading[2].growth = 1.25;
  block.grading[2].fine_at = AxisGrading::FineAt::kMaximum;
  EXPECT_NEAR(errorOf(plan, settings), 0.059, 0.015);
}

// Grasped, lifted and held, with the finest mesh of the benchmark, 1729 nodes. Its error is 15 %: a truth or a scene that changed by three
// times what the truth is known to shows.
TEST(StoredTruthTest, GraspComesNearIt) {
  const ScenePlan plan = graspPlan({});
  Settings settings = shippedSettings(plan.scene);
  settings.dt_s = 0.002;
  settings.cells = plan.meshes.back();
  EXPECT_NEAR(errorOf(plan, settings), 0.152, 0.03);
}

// Touched by the recorded arm, as shipped, 1575 nodes. Its error is 10 %, nearly all the mesh's: a truth or a scene that changed by
// four times what the truth is known to shows.
TEST(StoredTruthTest, RecordedRobotComesNearIt) {
  SceneOptions options;
  options.robot_bag = TISSUE_CONTACT_SHARED_DATA "/dvrk/psm2_classic_motion.bag";
  if (!std::filesystem::exists(options.robot_bag)) GTEST_SKIP() << "no recording " << options.robot_bag;
  const ScenePlan plan = robotPlan(options);
  EXPECT_NEAR(errorOf(plan, shippedSettings(plan.scene)), 0.098, 0.016);
}

// Cells of 1 mm, 4.8 per contact radius.
TEST(StoredTruthTest, PartialSlipComesNearIt) {
  const ScenePlan plan = partialSlipPlan({});
  Settings settings = shippedSettings(plan.scene);
  settings.cells = plan.meshes.back();
  settings.solver.iterations = 150;
  EXPECT_LT(errorOf(plan, settings), 0.02);
}

/// Of a run's samples with a tenth of its largest true force at least.
struct EstimateRecord {
  double found = 0.0;     ///< RMS error over RMS force
  double expected = 0.0;  ///< the same of what the simulator expects
  double within = 0.0;    ///< share of the samples where the two differ by less than a factor of two
};

EstimateRecord estimatesOf(const ScenePlan& plan, RefinementDescription::Mode refinement) {
  Scene scene = plan.scene.scene;
  scene.tissues[0].refinement.mode = refinement;
  scene.step.max_step_s = 0.002;
  Simulator simulator(scene, plan.scene.environment);
  const RunRecord truth = readTruthTable(plan.truth.table).run;
  double force = 0.0, found = 0.0, expected = 0.0;
  int samples = 0, within = 0;
  plan.scene.motion(simulator, [&](double time_s) {
    for (std::size_t i = 0; i < truth.times_s.size(); ++i) {
      const Vector3 right = truth.wrenches[i].back().force;
      if (std::abs(truth.times_s[i] - time_s) > 1e-6 || right.norm() < 0.012) continue;
      const double error_n = (simulator.wrench(0).force - right).norm();
      const double expected_n = simulator.forceErrors()[0].total_n();
      force += right.squaredNorm();
      found += error_n * error_n;
      expected += expected_n * expected_n;
      ++samples;
      within += static_cast<int>(expected_n > 0.5 * error_n && expected_n < 2.0 * error_n);
    }
  });
  return {std::sqrt(found / force), std::sqrt(expected / force), static_cast<double>(within) / samples};
}

// The simulator's own estimate against the truth: 1.29 found and 1.17 expected on 605 nodes, .027 and .049 refined; within a factor of two in
// 87 and 38 of a hundred samples (refined the error goes through 0 again and again, where the estimate is too large).
TEST(StoredTruthTest, TheSimulatorKnowsItsErrorOfPressAndDrag) {
  const ScenePlan plan = pressDragPlan({});
  const EstimateRecord coarse = estimatesOf(plan, RefinementDescription::Mode::kNever);
  EXPECT_GT(coarse.found, 1.1);
  EXPECT_NEAR(std::log(coarse.expected / coarse.found), 0.0, std::log(2.0));
  EXPECT_GT(coarse.within, 0.8);
  const EstimateRecord refined = estimatesOf(plan, RefinementDescription::Mode::kAuto);
  EXPECT_LT(refined.found, 0.04);
  EXPECT_NEAR(std::log(refined.expected / refined.found), 0.0, std::log(2.0));
  EXPECT_GT(refined.within, 0.3);
}

}  // namespace truth_table_test
}  // namespace tissue_contact
