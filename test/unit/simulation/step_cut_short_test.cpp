/// @file
/// Steps that end long before the solver's tolerance, as under a deadline: they bring no energy into the tissue.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

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

/// Without the guard up to 1e8 N of .07 (one iteration), 1.06 N (three), .39 N (five). What is cut errs, at most by 1.1 % here.
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

}  // namespace step_cut_short_test
}  // namespace tissue_contact
