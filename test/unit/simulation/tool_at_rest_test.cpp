/// Tools that stand still on tissue come to rest.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/text_scene.h"

namespace tissue_contact {
namespace tool_at_rest_test {

// A ball of 5 mm, 2.35 mm deep over a node of cells of 7.5 mm, without friction: its force swung by 17 % for ever, with every step solved, since
// the gap of points beside the creases of its dent changed by up to three times what a step foresaw (conforming_gap.h).
TEST(ToolAtRest, ABallOverANodeOfCoarseCells) {
  Simulator simulator = makeSimulator("gravity_m_per_s2: [0, 0, 0]\nstep: {max_step_s: 0.001}\n" +
                                          blockScene("[0.06, 0.06, 0.03]", "[8, 8, 4]", "poissons_ratio: 0.45") +
                                          onlyBall("[0, 0, 0.036]"),
                                      {{"probe", probeUrdf(0.005)}});
  simulator.advance(0.6, {Vector3(0.0, 0.0, -0.00335)});
  simulator.advance(1.5, {Vector3(0.0, 0.0, -0.00335)});
  double least = simulator.wrench(0).force.z();
  double most = least;
  for (int k = 0; k < 100; ++k) {
    simulator.advance(0.001, {Vector3(0.0, 0.0, -0.00335)});
    least = std::min(least, simulator.wrench(0).force.z());
    most = std::max(most, simulator.wrench(0).force.z());
  }
  EXPECT_GT(least, 0.05);
  EXPECT_LT(most - least, 0.01 * least);
}

}  // namespace tool_at_rest_test
}  // namespace tissue_contact
