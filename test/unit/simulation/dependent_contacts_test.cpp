/// Contacts that are nearly dependent, of a ball that rests on a vertex and the four faces around it, or of two instruments on one node:
/// steps end all the same, and right.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/text_scene.h"

namespace tissue_contact {
namespace dependent_contacts_test {

struct Press {
  std::vector<double> forces_n;
  int ended_by_iterations = 0;
};

/// The press of the benchmark, 4.1 mm at 20 mm/s in steps of 1 ms.
Press pressed(const std::string& solver) {
  Simulator simulator =
      makeSimulator(blockScene("[0.10, 0.10, 0.04]", "[10, 10, 4]", "model: corotational, poissons_ratio: 0.45") +
                        onlyBall("[-0.01, 0, 0.0452]") +
                        "friction: [{instrument: probe, tissue: block, static: 0.5}]\nsolver: " + solver + "\n",
                    {{"probe", probeUrdf(0.005)}});
  Press press;
  for (int k = 1; k <= 215; ++k) {
    simulator.advance(0.001, {Vector3(0.0, 0.0, -2e-5 * k)});
    press.forces_n.push_back(simulator.wrench(0).force.z());
    press.ended_by_iterations += static_cast<int>(simulator.report().stop == StopReason::kIterations);
  }
  return press;
}

// Judged by impulses, which go on moving from one contact to the next, 28 of these steps end at the 30 iterations allowed; by
// the momentum these bring to nodes one. Forces are then off by 2e-5 of the largest one in the mean, 2e-4 at most, where the
// tolerance is 1e-4 of each step's.
TEST(DependentContacts, DoNotKeepAStepFromEnding) {
  const Press press = pressed("{tolerance: 1.0e-4}");
  EXPECT_LE(press.ended_by_iterations, 3);
  const Press exact = pressed("{tolerance: 1.0e-8, iterations: 1000, contact_passes: 100}");
  const double largest = *std::max_element(exact.forces_n.begin(), exact.forces_n.end());
  double sum = 0.0;
  for (std::size_t k = 0; k < exact.forces_n.size(); ++k) {
    const double off = std::abs(press.forces_n[k] - exact.forces_n[k]);
    EXPECT_LE(off, 1e-3 * largest) << "step " << k;
    sum += off;
  }
  EXPECT_LE(sum / static_cast<double>(exact.forces_n.size()), 1e-4 * largest);
}

/// Two boxes that share a row of nodes are pressed 2 mm deep and held; then the first is raised by .1 mm/s. @return its force, N.
std::vector<double> raisedBesideAnother(const std::string& solver) {
  const std::string box = "    contact_links: [{link: tip, shapes: [box: {size_m: [0.008, 0.008, 0.004]}]}]\n";
  const auto instrument = [&](const std::string& name, const std::string& x_m) {
    return "  - name: " + name + "\n    robot_description: probe\n    tip_link: tip\n    joint_state_topics: [/" +
           name + "]\n    base_pose: {position_m: [" + x_m + ", 0, 0.0221]}\n" + box;
  };
  Simulator simulator = makeSimulator(
      blockScene("[0.06, 0.06, 0.02]", "[6, 6, 2]", "model: corotational, poissons_ratio: 0.45") + "instruments:\n" +
          instrument("a", "-0.003") + instrument("b", "0.003") + "solver: " + solver + "\n",
      {{"probe", probeUrdf(0.005)}});
  std::vector<double> forces_n;
  for (int k = 1; k <= 300; ++k) {
    const double down = -2e-5 * std::min(k, 100);
    simulator.advance(0.001, {Vector3(0.0, 0.0, down + 1e-7 * std::max(0, k - 150)), Vector3(0.0, 0.0, down)});
    forces_n.push_back(simulator.wrench(0).force.z());
  }
  return forces_n;
}

// The node that both press passes from one to the other: what it gets is known at once, whose force that is takes longer. Without
// telling them apart the force is up to 12 % off for some steps (measured once). What both bear while they are held is not unique.
TEST(DependentContacts, OfTwoInstrumentsGiveEachItsForce) {
  const std::vector<double> forces = raisedBesideAnother("{tolerance: 1.0e-4}");
  const std::vector<double> exact = raisedBesideAnother("{tolerance: 1.0e-8, iterations: 1000, contact_passes: 100}");
  const double largest = *std::max_element(exact.begin(), exact.end());
  EXPECT_GT(largest, 0.1);
  for (std::size_t k = 150; k < exact.size(); ++k) EXPECT_NEAR(forces[k], exact[k], 0.01 * largest) << "step " << k;
}

}  // namespace dependent_contacts_test
}  // namespace tissue_contact
