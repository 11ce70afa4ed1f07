/// A ball that drags over a nodule fifty times as stiff as the tissue around it: the nodule is found to move as one.
#include <gtest/gtest.h>

#include "support/text_scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace stiff_nodule_test {

struct Drag {
  int iterations = 0;
  int unfinished = 0;  ///< steps that ended before the solver's tolerance
};

/// 2 mm deep and 12 mm along x in 2 ms steps. @param region a line of the tissue, or nothing.
Drag drag(const std::string& region) {
  const std::string scene =
      blockScene("[0.04, 0.04, 0.02]", "[16, 16, 8]", "model: corotational, poissons_ratio: 0.45") + region +
      onlyBall("[-0.006, 0, 0.025]") +
      "friction:\n  - {instrument: probe, tissue: block, static: 0.3, kinetic: 0.2}\nstep: {max_step_s: 0.002}\n";
  Simulator simulator = makeSimulator(scene, {{"probe", probeUrdf(0.005)}});
  Drag all;
  for (int k = 1; k <= 80; ++k) {
    const double along = 0.012 * std::max(0, k - 20) / 60.0;
    simulator.advance(0.002, {Vector3(along, 0.0, -0.002 * std::min(k, 20) / 20.0)});
    all.iterations += simulator.report().iterations;
    all.unfinished += simulator.report().stop == StopReason::kTolerance ? 0 : 1;
  }
  return all;
}

TEST(StiffNodule, TakesHardlyMoreIterationsThanTissueWithout) {
  const std::string nodule =
      "    regions: [{name: nodule, where: [{sphere: {center_m: [0, 0, 0.011], radius_m: 0.005}}],\n"
      "               material: {youngs_modulus_pa: 250000}}]\n";
  const Drag without = drag("");
  const Drag with = drag(nodule);
  EXPECT_LE(with.iterations, 1.5 * without.iterations) << with.iterations << " of " << without.iterations;
  EXPECT_LE(with.unfinished, without.unfinished + 1)
      << with.unfinished;  // of 80; a contact may cycle in one or the other
}

}  // namespace stiff_nodule_test
}  // namespace tissue_contact
