/// @file
/// Energy and momentum where steps end before the solver's tolerance, as under a deadline, and where they end at it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "support/text_scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace step_cut_short_test {

struct Press {
  double peak_n = 0.0;
  double last_n = 0.0;
};

/// A ball goes 2 mm deep, 4 mm along x, and stays, in steps of 10 ms.
Press press(const std::string& model, const std::string& solver) {
  Simulator simulator =
      makeSimulator(blockScene("[0.08, 0.06, 0.03]", "[26, 20, 8]", "model: " + model + ", poissons_ratio: 0.45") +
                        onlyBall("[-0.002, 0, 0.035]") +
                        "friction: [{instrument: probe, tissue: block, static: 0.6, kinetic: 0.4}]\n"
                        "step: {max_step_s: 0.01}\nsolver: {" +
                        solver + "}\n",
                    {{"probe", probeUrdf(0.005)}});
  Press all;
  for (int k = 1; k <= 150; ++k) {
    const double along = 0.004 * std::clamp((k - 40) / 60.0, 0.0, 1.0);
    simulator.advance(0.01, {Vector3(along, 0.0, -0.002 * std::min(k, 40) / 40.0)});
    all.last_n = simulator.wrench(0).force.norm();
    all.peak_n = std::max(all.peak_n, all.last_n);
  }
  return all;
}

/// Before up to 1e8 N of .07 (one iteration), 1.06 N (three), .39 N (five).
TEST(StepCutShort, BringsNoEnergyIntoTheTissue) {
  constexpr double kErrs = 0.03;
  for (const char* model : {"corotational", "neo_hookean"}) {
    const Press whole = press(model, "iterations: 200");
    for (const int iterations : {1, 2, 3, 5, 8}) {
      const Press cut = press(model, "iterations: " + std::to_string(iterations));
      EXPECT_NEAR(cut.peak_n, whole.peak_n, kErrs * whole.peak_n) << model << ", iterations: " << iterations;
      EXPECT_NEAR(cut.last_n, whole.last_n, kErrs * whole.last_n) << model << ", iterations: " << iterations;
    }
  }
}

/// A ball of 5 mm swings 15 mm to and fro in tissue whose mesh follows it, up to 4 mm deep. For five seconds each fifth of a
/// second has one step of one iteration, if `overloaded`; then all have what they need, and the ball is thrice as fast.
/// @return the force where it is 4 mm deep then, N.
double swingInTissue(bool overloaded) {
  Simulator simulator = makeSimulator(blockScene("[0.08, 0.06, 0.03]", "[16, 12, 6]", "poissons_ratio: 0.45") +
                                          "    refinement: auto\n" + onlyBall("[0, 0, 0.045]") +
                                          "friction: [{instrument: probe, tissue: block, static: 0.6, kinetic: 0.4}]\n",
                                      {{"probe", probeUrdf(0.005)}});
  int iterations = 1;
  const auto at = [](double t) {
    return Vector3(0.015 * std::sin(3.0 * t), 0.01 * std::cos(2.0 * t), -0.012 - 0.002 * std::sin(M_PI * t));
  };
  if (overloaded) {
    Scene scene = simulator.scene();
    std::swap(scene.solver.iterations, iterations);
    simulator.retune(scene);
    AdvanceLimits limits;
    limits.most_steps = 1;
    simulator.placeInstrument(0, at(0.0));
    for (int k = 1; k <= 25; ++k) simulator.advance(0.2, {at(0.2 * k)}, limits);
    std::swap(scene.solver.iterations, iterations);
    simulator.retune(scene);
  } else {
    simulator.placeInstrument(0, at(5.0));
  }
  for (int k = 1; k <= 25; ++k) simulator.advance(0.02, {at(5.0 + 0.06 * k)});
  return simulator.wrench(0).force.norm();
}

/// Elements that such steps had turned inside out stayed so for ever: .44 N for .14.
TEST(StepCutShort, LeavesNoTissueTangled) {
  const double right_n = swingInTissue(false);
  EXPECT_NEAR(swingInTissue(true), right_n, 0.05 * right_n);
}

/// How far down the free end of a flap (80 mm) is after each tenth of a second of its swing, m.
std::vector<double> swing(double youngs_modulus_pa, double step_s, double seconds, const std::string& solver) {
  Simulator simulator = makeSimulator(
      "gravity_m_per_s2: [0, 0, -9.81]\ntissues:\n  - name: flap\n    block: {size_m: [0.08, 0.01, 0.01], cells: [16, "
      "2, 2]}\n"
      "    material: {model: corotational, youngs_modulus_pa: " +
          std::to_string(youngs_modulus_pa) +
          ", poissons_ratio: 0.45, density_kg_per_m3: 1000}\n    damping: {stiffness_s: 0.003}\n"
          "    fixed: [{plane: {point_m: [-0.0399, 0, 0], normal: [1, 0, 0]}}]\n" +
          onlyBall("[0, 0, 2]") + "step: {max_step_s: " + std::to_string(step_s) + "}\nsolver: {" + solver + "}\n",
      {{"probe", probeUrdf(0.005)}});
  Eigen::Index end = 0;
  simulator.positions(0).row(0).maxCoeff(&end);
  const double z = simulator.positions(0)(2, end);
  std::vector<double> down;
  for (int k = 0; k < 10 * seconds; ++k) {
    simulator.advance(0.1, {Vector3(0.0, 0.0, 0.0)});
    down.push_back(z - simulator.positions(0)(2, end));
  }
  return down;
}

/// Turns of half a radian in a step, which the quadratic energy of a step knows nothing of: 1e12 to 1e30 m before.
TEST(StepCutShort, AFlapThatSwingsGainsNoEnergy) {
  for (const double step_s : {0.01, 0.02}) {
    for (const int iterations : {3, 5, 8, 12}) {
      const std::vector<double> down = swing(1e4, step_s, 2.0, "iterations: " + std::to_string(iterations));
      for (const double at : down) EXPECT_LT(std::abs(at), 0.09) << step_s << " s, iterations: " << iterations;
    }
  }
}

/// A tolerance over the momentum, in place of its change, let it swing from 50 mm below to 22 above.
TEST(SolverTolerance, AFlapThatSwingsComesToRest) {
  const std::vector<double> down = swing(3e5, 0.001, 4.0, "tolerance: 0.01");
  const std::vector<double> whole = swing(3e5, 0.001, 4.0, "iterations: 300, tolerance: 1.0e-6");
  for (std::size_t k = 30; k < down.size(); ++k) EXPECT_NEAR(down[k], whole[k], 0.001);
}

/// By momentum .72 of the speed.
TEST(SolverTolerance, ABodyFallsByItsWeight) {
  Simulator simulator = makeSimulator(
      "gravity_m_per_s2: [0, 0, -9.81]\ntissues:\n  - name: block\n    block: {size_m: [0.08, 0.06, 0.03], cells: [10, "
      "8, 4]}\n"
      "    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.45, density_kg_per_m3: 1000}\n    damping: "
      "{stiffness_s: 0.003}\n" +
          onlyBall("[0, 0, 2]") + "step: {max_step_s: 0.001}\nsolver: {tolerance: 0.01}\n",
      {{"probe", probeUrdf(0.005)}});
  simulator.advance(0.5, {Vector3(0.0, 0.0, 0.0)});
  EXPECT_NEAR(simulator.velocities(0).row(2).mean(), -9.81 * 0.5, 1e-3 * 9.81 * 0.5);
}

}  // namespace step_cut_short_test
}  // namespace tissue_contact
