/// The likely error of a force: of meshes, steps and solvers that are known to be wrong by so much, and where nothing is known.
#include "tissue_contact/simulation/force_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support/replaced.h"
#include "validation/press_scene.h"

namespace tissue_contact {
namespace force_error_test {

std::string scene(const std::string& more, const std::string& geometry = "", double mu = 0.0) {
  const std::string tissue =
      geometry.empty() ? blockScene("[0.10, 0.10, 0.04]", "[10, 10, 4]", "poissons_ratio: 0.45") : geometry;
  return tissue + onlyBall("[0, 0, 0.045]") +
         "friction: [{instrument: probe, tissue: block, static: " + std::to_string(mu) + "}]\n" + more;
}

Simulator simulatorOf(const std::string& yaml) { return makeSimulator(yaml, {{"probe", probeUrdf(0.005)}}); }

/// 20 mm/s down by 2 mm. @return the estimate at its end.
ForceErrorEstimate pressed(Simulator& simulator, double step_s) {
  const int steps = static_cast<int>(std::lround(0.1 / step_s));
  for (int k = 1; k <= steps; ++k) simulator.advance(step_s, {Vector3(0.0, 0.0, -0.002 * k / steps)});
  return simulator.forceErrors().at(0);
}

TEST(ForceError, ThereIsNoneWithoutContact) {
  Simulator simulator = simulatorOf(scene(""));
  ASSERT_EQ(simulator.forceErrors().size(), 1u);
  EXPECT_EQ(simulator.forceErrors()[0].total_n(), 0.0);
  simulator.advance(0.01, {Vector3(0.0, 0.0, 0.01)});
  EXPECT_EQ(simulator.forceErrors()[0].total_n(), 0.0);
  pressed(simulator, 0.005);
  EXPECT_GT(simulator.forceErrors()[0].total_n(), 0.0);
  simulator.reset();
  EXPECT_EQ(simulator.forceErrors()[0].total_n(), 0.0);
}

// Form H (validation case benchmark-block): a ball of 40 mm, .625 mm deep, .06166 N at nu .45 and .05431 N at .3. What likelyMeshError() was fitted to are
// deep presses. In so shallow a one contact at vertices is soft enough to take back most of what coarse cells are too stiff, by
// luck: found 12, .2, 8 and 2 %, expected 30, 10, 35 and 13 %. It must not be the other way round.
TEST(ForceError, OfFormHIsNeverTooSmall) {
  for (const auto& [nu, truth] : {std::pair(0.45, 0.06166), std::pair(0.3, 0.05431)}) {
    double of_coarser = truth;
    for (const int cells : {12, 18, 24}) {
      PressScene press;
      press.poissons_ratio = nu;
      press.cells = {cells, cells, cells / 2};
      press.growth = 1.0;
      Simulator simulator = makePress(press);
      pressSmooth(simulator, 0.000625);
      const double found = std::abs(simulator.wrench(0).force.z() - truth);
      const double expected = simulator.forceErrors()[0].total_n();
      EXPECT_GT(expected, 0.5 * found) << nu << ' ' << cells;
      EXPECT_LT(expected, of_coarser) << nu << ' ' << cells;
      of_coarser = expected;
    }
    EXPECT_LT(of_coarser, 0.1 * truth) << nu;
  }
}

// A ball of 10 mm, .4 to .8 of its radius deep, refined for it: 3 to 5 % too soft, since vertices alone carry it, where the strain expects 2.2 to .7 %.
// Truth: axially symmetric elements of second order, 1 mm at the ball, on a cylinder of the block's area (written for this; known to .6 %).
TEST(ForceError, OfDeepPressesKnowsThatVerticesAreSoft) {
  Simulator simulator =
      makeSimulator(blockScene("[0.08, 0.08, 0.04]", "[20, 20, 10]", "model: neo_hookean, poissons_ratio: 0.45") +
                        "    refinement: auto\n" + onlyBall("[0, 0, 0.05]") +
                        "friction: [{instrument: probe, tissue: block, static: 0}]\nstep: {max_step_s: 0.01}\n",
                    {{"probe", probeUrdf(0.01)}});
  const auto press = [&](double depth_m) { simulator.advance(0.01, {Vector3(0.0, 0.0, -depth_m)}); };
  for (const auto& [depth_mm, truth_n] : {std::pair(4, 0.22855), std::pair(6, 0.42003), std::pair(8, 0.64089)}) {
    for (int k = 1; k <= 20; ++k) press(1e-3 * depth_mm - 1e-4 * (20 - k));
    for (int k = 0; k < 10; ++k) press(1e-3 * depth_mm);
    const double found_n = std::abs(simulator.wrench(0).force.z() - truth_n);
    const ForceErrorEstimate& expected = simulator.forceErrors()[0];
    EXPECT_GT(found_n, 0.02 * truth_n) << depth_mm;
    EXPECT_GT(expected.mesh_n, 0.4 * found_n) << depth_mm;  // .43 of it at .8 of the radius; .17 by the strain alone
    EXPECT_LT(expected.mesh_n, 2.0 * found_n) << depth_mm;
  }
}

// Neo-Hookean tissue as it comes averages a part of all strain alone, and still locks: cells of 5 mm under a ball of 5 mm.
// Truth: cells of 1.67 mm with all of it averaged (the last line of what is computed here), by which half and more of the force is too much.
TEST(ForceError, OfNeoHookeanTissueKnowsThatItLocks) {
  for (const double nu : {0.45, 0.49}) {
    const auto press = [nu](const std::string& cells, const std::string& material) {
      const std::string block = blockScene("[0.06, 0.06, 0.02]", cells,
                                           "model: neo_hookean, poissons_ratio: " + std::to_string(nu) + material);
      Simulator simulator = simulatorOf(
          block + onlyBall("[0.0013, 0.0007, 0.025]") +
          "friction: [{instrument: probe, tissue: block, static: 0}]\nsolver: {iterations: 500, tolerance: 1.0e-4}\n");
      const double error_n = pressed(simulator, 0.01).total_n();
      return std::pair(std::abs(simulator.wrench(0).force.z()), error_n);
    };
    const auto [force_n, expected_n] = press("[12, 12, 4]", "");
    const double truth_n = press("[36, 36, 12]", ", dilatation: patch").first;
    EXPECT_GT(expected_n, 0.5 * (force_n - truth_n)) << nu;
    EXPECT_LT(expected_n, 2.0 * (force_n - truth_n)) << nu;
  }
}

/// 20 mm/s: down by 2 mm, then along x by 5 mm. @return forces every 8 ms.
std::vector<Vector3> dragged(double step_s, std::vector<double>* expected_n = nullptr) {
  const std::string block =
      blockScene("[0.10, 0.10, 0.04]", "[10, 10, 4]", "poissons_ratio: 0.45") + "    refinement: auto\n";
  Simulator simulator = simulatorOf(
      scene("solver: {iterations: 100, tolerance: 1.0e-4}\nstep: {max_step_s: " + std::to_string(step_s) + "}\n", block,
            0.5));
  std::vector<Vector3> forces;
  for (int k = 1; k <= 44; ++k) {
    const double way = 1.6e-4 * k;
    simulator.advance(0.008, {Vector3(std::max(way - 0.002, 0.0), 0.0, -std::min(way, 0.002))});
    forces.push_back(simulator.wrench(0).force);
    if (expected_n != nullptr) expected_n->push_back(simulator.forceErrors()[0].step_n);
  }
  return forces;
}

// Against steps of 0.5 ms, the mesh following the ball. In the press nodes come into contact and meshes move at other times; no slip, so next to
// nothing is expected; found are 0.8 % in the drag, 2.5 % in the press.
TEST(ForceError, TellsWhatTheStepDoesInADragWithinAFactorOfTwo) {
  std::vector<double> expected_n;
  const std::vector<Vector3> coarse = dragged(0.008, &expected_n);
  const std::vector<Vector3> fine = dragged(0.0005);
  const auto rootOfSum = [&](std::size_t first, std::size_t end, const auto& value) {
    double sum = 0.0;
    for (std::size_t k = first; k < end; ++k) sum += value(k) * value(k);
    return std::sqrt(sum);
  };
  const auto found_n = [&](std::size_t k) { return (coarse[k] - fine[k]).norm(); };
  const auto told_n = [&](std::size_t k) { return expected_n[k]; };
  const auto force_n = [&](std::size_t k) { return fine[k].norm(); };
  const double of_drag = rootOfSum(20, 44, force_n);
  EXPECT_GT(rootOfSum(20, 44, found_n), 0.005 * of_drag);
  EXPECT_NEAR(std::log(rootOfSum(20, 44, told_n) / rootOfSum(20, 44, found_n)), 0.0, std::log(2.0));
  const double of_press = rootOfSum(0, 12, force_n);
  EXPECT_LT(rootOfSum(0, 12, found_n), 0.03 * of_press);
  EXPECT_LT(rootOfSum(0, 12, told_n), 0.01 * of_press);
}

// A ball of 2 mm pressed into cells of 20 mm: the force is that of one node, some thirty times too large, and the strain of the few elements around as
// smooth as can be. (An organ of 98 nodes under a ball of 5 mm: .77 N, .094 N refined; the strain alone expects .16 N of error.)
TEST(ForceError, CellsFarLargerThanTheShapeAreNotTakenForSmooth) {
  const auto simulator = [](const std::string& refinement) {
    return makeSimulator(scene("", blockScene("[0.10, 0.10, 0.04]", "[5, 5, 2]", "poissons_ratio: 0.45") +
                                       "    refinement: " + refinement + "\n"),
                         {{"probe", probeUrdf(0.002)}});
  };
  Simulator coarse = simulator("never");
  Simulator fine = simulator("auto");
  for (int k = 1; k <= 120; ++k) {  // the ball's lowest point begins 3 mm above the block
    for (Simulator* one : {&coarse, &fine}) one->advance(0.001, {Vector3(0.01, 0.01, -4e-5 * k)});
  }
  const double found = (coarse.wrench(0).force - fine.wrench(0).force).norm();
  ASSERT_GT(found, 0.8 * coarse.wrench(0).force.norm());
  EXPECT_GT(coarse.forceErrors()[0].mesh_n, 0.5 * found);
  EXPECT_LT(coarse.forceErrors()[0].mesh_n, 1.2 * found);
}

// Two balls of one instrument, 40 mm apart: between them nothing is strained.
TEST(ForceError, JudgesTheMeshUnderEachShape) {
  const std::string ball = "<geometry><sphere radius='" + std::to_string(0.005) + "'/></geometry>";
  const std::string one = "<collision>" + ball + "</collision>";
  const std::string two = "<collision><origin xyz='-0.02 0 0'/>" + ball +
                          "</collision><collision><origin xyz='0.02 0 0'/>" + ball + "</collision>";
  Simulator single = simulatorOf(scene(""));
  Simulator pair = makeSimulator(scene(""), {{"probe", replaced(probeUrdf(0.005), one, two)}});
  const ForceErrorEstimate of_one = pressed(single, 0.001);
  const ForceErrorEstimate of_two = pressed(pair, 0.001);
  const double share_of_one = of_one.mesh_n / single.wrench(0).force.norm();
  const double share_of_two = of_two.mesh_n / pair.wrench(0).force.norm();
  EXPECT_GT(share_of_one, 0.1);
  EXPECT_NEAR(share_of_two, share_of_one, 0.3 * share_of_one);
}

TEST(ForceError, ASolverThatStopsEarlyHasMore) {
  Simulator early = simulatorOf(scene("solver: {iterations: 1}\n", "", 0.5));
  Simulator late = simulatorOf(scene("solver: {iterations: 200, tolerance: 1.0e-8}\n", "", 0.5));
  EXPECT_GT(pressed(early, 0.001).solver_n, 100.0 * pressed(late, 0.001).solver_n);
}

/// A large ball goes 6 mm deep into a thin block in steps of 10 ms, without friction; `step` is called after each.
template <typename Step>
void pressThinBlock(const std::string& solver, const Step& step) {
  Simulator simulator =
      makeSimulator(blockScene("[0.03, 0.03, 0.01]", "[12, 12, 4]", "model: neo_hookean, poissons_ratio: 0.45") +
                        onlyBall("[0.0003, 0.0004, 0.03]") + "step: {max_step_s: 0.01}\nsolver: {" + solver +
                        ", relaxation: cholesky}\n",
                    {{"probe", probeUrdf(0.02)}});
  for (int k = 1; k <= 30; ++k) {
    simulator.advance(0.01, {Vector3(0.0, 0.0, -0.0002 * k)});
    step(simulator);
  }
}

// Momentum is exact after each back-substitution, so what is left is in the contacts: told were .1 to .25 of what is found.
TEST(ForceError, KnowsWhatIsLeftInTheContactsWhereCholeskyIsCutShort) {
  std::vector<Vector3> exact;
  pressThinBlock("iterations: 1000, contact_passes: 100, tolerance: 1.0e-8",
                 [&](const Simulator& simulator) { exact.push_back(simulator.wrench(0).force); });
  for (const char* const solver :
       {"iterations: 1, contact_passes: 1", "iterations: 3, contact_passes: 1", "iterations: 3"}) {
    std::size_t k = 0;
    double found = 0.0;
    double told = 0.0;
    pressThinBlock(solver, [&](const Simulator& simulator) {
      const Vector3& right = exact[k++];
      if (k <= 8) return;
      found += (simulator.wrench(0).force - right).squaredNorm();
      told += std::pow(simulator.forceErrors()[0].solver_n, 2);
    });
    EXPECT_LT(std::abs(std::log(told / found)), 2.0 * std::log(3.0)) << solver << ": " << std::sqrt(told / found);
  }
}

// A column pushed at its top, by 20 mm/s in steps of 2 ms: it gives way as a whole, which each node's own defect hardly tells.
TEST(ForceError, OfABodyThatGivesWayAsAWholeIsKnownAndFollowsTheTolerance) {
  const std::string column = blockScene("[0.06, 0.06, 0.16]", "[6, 6, 16]", "poissons_ratio: 0.45") +
                             onlyBall("[-0.036, 0.001, 0.143]") +
                             "friction: [{instrument: probe, tissue: block, static: 0.3}]\nstep: {max_step_s: 0.002}\n";
  const auto simulator = [&](const std::string& tolerance) {
    return simulatorOf(column + "solver: {iterations: 1000, tolerance: " + tolerance + "}\n");
  };
  Simulator exact = simulator("1.0e-9");
  std::vector<Simulator> early;
  const std::vector<double> most = {0.05, 0.009};  // between what it was and is
  for (const char* const tolerance : {"0.01", "0.001"}) early.push_back(simulator(tolerance));
  std::vector<double> found(2), expected(2);
  double squares = 0.0;
  for (int k = 1; k <= 200; ++k) {
    const std::vector<VectorX> q = {Vector3(4e-5 * k, 0.0, 0.0)};
    exact.advance(0.002, q);
    squares += exact.wrench(0).force.squaredNorm();
    for (std::size_t i = 0; i < early.size(); ++i) {
      early[i].advance(0.002, q);
      found[i] += (early[i].wrench(0).force - exact.wrench(0).force).squaredNorm();
      expected[i] += std::pow(early[i].forceErrors()[0].solver_n, 2);
    }
  }
  for (std::size_t i = 0; i < early.size(); ++i) {
    // 3.0 and .7 %; by the defects of single nodes alone it was 13 and 1.1 %.
    EXPECT_LT(std::sqrt(found[i] / squares), most[i]);
    EXPECT_LT(std::abs(std::log(expected[i] / found[i])), 2.0 * std::log(3.0));
  }
}

// A block that a ball shakes by 10 mm at 3.2 Hz, the same mesh in steps of 4 and .5 ms. Slip alone tells a seventh of what is found.
TEST(ForceError, TissueThatSwingsHasMoreInLongSteps) {
  const std::string tissue = blockScene("[0.06, 0.06, 0.04]", "[8, 8, 5]", "poissons_ratio: 0.45");
  const auto simulator = [&](const std::string& step) {
    return simulatorOf(scene("gravity_m_per_s2: [0, 0, 0]\nstep: {max_step_s: " + step + "}\n", tissue, 0.5));
  };
  Simulator fine = simulator("0.0005");
  Simulator coarse = simulator("0.004");
  double found = 0.0;
  double expected = 0.0;
  for (int k = 1; k <= 250; ++k) {
    const double t = 0.004 * k;
    const std::vector<VectorX> q = {Vector3(0.01 * std::sin(20.0 * t), 0.0, -0.004 * std::min(t / 0.2, 1.0))};
    fine.advance(0.004, q);
    coarse.advance(0.004, q);
    if (k <= 60) continue;
    found += (coarse.wrench(0).force - fine.wrench(0).force).squaredNorm();
    expected += std::pow(coarse.forceErrors()[0].step_n, 2);
  }
  EXPECT_LT(std::abs(std::log(expected / found)), 2.0 * std::log(2.0));
}

// By Newton's second law: what pushes a loose block is all the rate of its momentum, in each step.
TEST(ForceError, OfTissueThatNothingHoldsAllOfTheForceIsInertia) {
  const std::string block = blockScene("[0.06, 0.06, 0.04]", "[8, 8, 5]", "poissons_ratio: 0.45");
  const std::string held = "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n";
  Simulator loose = simulatorOf(
      scene("gravity_m_per_s2: [0, 0, 0]\nsolver: {tolerance: 1.0e-6, iterations: 300}\n", replaced(block, held, "")));
  double most_n = 0.0;
  for (int k = 1; k <= 100; ++k) {
    loose.advance(0.001, {Vector3(0.0, 0.0, -5e-5 * k)});
    const double force_n = loose.wrench(0).force.norm();
    if (k <= 2) continue;  // not known yet
    EXPECT_NEAR(loose.forceErrors()[0].inertia_n, force_n, 0.005 * force_n + 1e-6) << k;
    most_n = std::max(most_n, force_n);
  }
  EXPECT_GT(most_n, 0.01);
  Simulator pressed_slowly = simulatorOf(scene("", block));
  const double inertia_n = pressed(pressed_slowly, 0.001).inertia_n;
  EXPECT_LT(inertia_n, 0.05 * pressed_slowly.wrench(0).force.norm());
}

// Patches of a sheet bend as well as stretch; what the recovery of strain tells of them has not been compared with anything.
TEST(ForceError, TellsWhereTheMeshIsNotJudged) {
  const std::string sheet =
      "tissues:\n  - name: block\n    sheet: {size_m: [0.1, 0.1], cells: [10, 10], thickness_m: 0.002}\n"
      "    pose: {position_m: [0, 0, 0.039]}\n"
      "    material: {model: membrane, youngs_modulus_pa: 50000, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
      "    damping: {stiffness_s: 0.003}\n    fixed: [{box: {min_m: [-1, -1, -1], max_m: [-0.045, 1, 1]}}, {box: "
      "{min_m: "
      "[0.045, -1, -1], max_m: [1, 1, 1]}}]\n";
  Simulator simulator = simulatorOf(scene("", sheet));
  const ForceErrorEstimate error = pressed(simulator, 0.001);
  EXPECT_GT(simulator.wrench(0).force.norm(), 0.0);
  EXPECT_FALSE(error.knows_mesh);
  EXPECT_EQ(error.mesh_n, 0.0);
  EXPECT_GT(error.total_n(), 0.0);
}

TEST(ForceError, AskingForItChangesNothing) {
  for (const char* const solver : {"", "solver: {relaxation: cholesky, iterations: 1, contact_passes: 1}\n"}) {
    Simulator asked = simulatorOf(scene(solver, "", 0.5));
    Simulator left = simulatorOf(scene(solver, "", 0.5));
    for (int k = 1; k <= 50; ++k) {
      for (Simulator* simulator : {&asked, &left}) simulator->advance(0.001, {Vector3(1e-5 * k, 0.0, -4e-5 * k)});
      EXPECT_GE(asked.forceErrors()[0].total_n(), 0.0);
      ASSERT_EQ(asked.wrench(0).force, left.wrench(0).force) << solver << k;
    }
  }
}

constexpr MeshErrorFactors kByElement = {2.2, 0.5};
constexpr MeshErrorFactors kAveraged = {0.97, 0.3};

TEST(LikelyMeshError, IsAShareOfTheForce) {
  for (const MeshErrorFactors& factors : {kByElement, kAveraged}) {
    const double stiffened = factors.of_strain * std::pow(0.04, 1.7);
    EXPECT_NEAR(likelyMeshError(0.04, 0.0, factors), std::sqrt(1.36) * stiffened, 1e-15);
    EXPECT_NEAR(likelyMeshError(0.0, 0.03, factors), 0.03, 1e-15);
    EXPECT_NEAR(likelyMeshError(0.04, stiffened, factors), 0.6 * stiffened, 1e-15);  // opposite signs
    EXPECT_EQ(likelyMeshError(0.0, 0.0, factors), 0.0);
    EXPECT_EQ(likelyMeshError(5.0, 0.0, factors), 1.0);
    EXPECT_EQ(likelyMeshError(std::numeric_limits<double>::quiet_NaN(), 0.0, factors), 1.0);
    EXPECT_EQ(likelyMeshError(0.0, std::numeric_limits<double>::quiet_NaN(), factors), 1.0);
  }
}

// Press and drag of a ball of 5 mm: 138 % with even cells of 10 mm (edges of 11.4), 2 % refined to 1.5 mm (1.7); by element 164 and 4 %.
TEST(ExpectedMeshError, IsWithinAFactorOfTwoOfWhatIsMet) {
  EXPECT_NEAR(std::log(expectedMeshError(0.0114, 0.005, kAveraged) / 1.38), 0.0, std::log(2.0));
  EXPECT_NEAR(std::log(expectedMeshError(0.0114, 0.005, kByElement) / 1.64), 0.0, std::log(2.0));
  EXPECT_NEAR(std::log(expectedMeshError(0.0017, 0.005, kAveraged) / 0.022), 0.0, std::log(2.0));
  EXPECT_NEAR(std::log(expectedMeshError(0.0017, 0.005, kByElement) / 0.04), 0.0, std::log(2.0));
}

}  // namespace force_error_test
}  // namespace tissue_contact
