/// Form C: a block of 1 kg on a spring of 100 N/m with friction 0.3, let go at 0.1 m: loses 0.05886 m per half swing and
/// stops at -0.01772 m after 0.6283 s. As a scene (a strip as the spring, its heavy end as the block, tilted gravity in
/// place of the initial displacement) and at the solver, with the midpoint rule in place of implicit Euler.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "validation/sliding_mass.h"
#include "validation/text_scene.h"

namespace tissue_contact {
namespace {

constexpr double kMass = 1.0;         // kg
constexpr double kStiffness = 100.0;  // N/m
constexpr double kMu = 0.3;
constexpr double kGravity = 9.81;
constexpr double kStart = 0.1;                                                   // m
constexpr double kLossPerHalfSwing = 2.0 * kMu * kMass * kGravity / kStiffness;  // 0.05886 m
constexpr double kFirstTurn = kLossPerHalfSwing - kStart;                        // -0.04114 m
constexpr double kRest = kStart - 2.0 * kLossPerHalfSwing;  // -0.01772 m, where 1.77 N of spring meet 2.94 N
const double kTimeToRest = 2.0 * M_PI / std::sqrt(kStiffness / kMass);

struct Motion {
  double first_turn_m = 0.0;  ///< lowest place
  double rest_m = 0.0;        ///< at the end
  double time_s = 0.0;        ///< when it came to rest
};

// The time step itself is second order and does not damp, so 1 % at 1 ms is what the block's two stops, each known to
// one step, leave: half a step at the turn is 1e-4 of the swing, two steps of 0.628 s are 0.3 %.
TEST(SpringBlock, StopsWhereItMustWithTheMidpointRule) {
  constexpr double dt = 0.001;
  SlidingMass block(kMass, kStiffness, kGravity, {kMu, kMu}, kStart);
  Motion motion;
  for (int k = 1; k <= 1000; ++k) {
    block.step(dt, 0.0);
    motion.first_turn_m = std::min(motion.first_turn_m, block.position());
    if (block.state() != ContactState::kStatic) motion.time_s = k * dt;
  }
  EXPECT_NEAR(motion.first_turn_m, kFirstTurn, 0.01 * std::abs(kFirstTurn));
  EXPECT_NEAR(block.position(), kRest, 0.01 * std::abs(kRest));
  EXPECT_NEAR(motion.time_s, kTimeToRest, 0.01 * kTimeToRest);
  std::cout << "midpoint rule, 1 ms: first turn " << motion.first_turn_m << " m (" << kFirstTurn << "), rest "
            << block.position() << " m (" << kRest << "), after " << motion.time_s << " s (" << kTimeToRest << ")\n";
}

/// A strip of 1 m and 100 N/m, 1 g, fixed at its left end; at its right one a stiff cell of 0.1 m and 1 kg. Gravity has a
/// component of 10 m/s^2 along the strip, which moves the place where the spring is free by 0.1 m.
Motion swingScene(double dt) {
  std::ostringstream yaml;
  yaml
      << "gravity_m_per_s2: [" << -kStart * kStiffness / kMass << ", 0, " << -kGravity << "]\n"
      << "tissues:\n  - name: strip\n    sheet: {size_m: [1.1, 0.1], cells: [11, 1], thickness_m: 0.01}\n"
      << "    material: {youngs_modulus_pa: 1.0e5, poissons_ratio: 0, density_kg_per_m3: 1, bending_stiffness_n_m: 0}\n"
      << "    regions: [{name: block, where: [{box: {min_m: [-0.55, -1, -1], max_m: [-0.45, 1, 1]}}],"
      << " material: {youngs_modulus_pa: 1.0e7, density_kg_per_m3: 1.0e4}}]\n"
      << "    fixed: [{plane: {point_m: [0.55, 0, 0], normal: [-1, 0, 0]}}]\n"
      << "instruments:\n  - {name: table, robot_description: table, tip_link: table, contact_links: [table],"
      << " base_pose: {position_m: [0, 0, -0.005]}}\n"
      << "friction:\n  - {instrument: table, tissue: strip, static: " << kMu << "}\n"
      << "step: {max_step_s: 0.001}\nsolver: {relaxation: cholesky, iterations: 200, tolerance: 1.0e-9}\n";
  Simulator simulator = makeSimulator(yaml.str(), {{"table", tableUrdf()}});
  const NodalVectors& rest = simulator.tissues()[0].restPositions();
  const VectorX& masses = simulator.tissues()[0].nodeMasses();
  const auto displacement = [&] {  // of the block's four nodes; what the strip weighs beside them is 0.1 %
    double sum = 0.0;
    double mass = 0.0;
    for (Eigen::Index i = 0; i < rest.cols(); ++i) {
      if (rest(0, i) > -0.44) continue;
      sum += masses[i] * (simulator.positions(0)(0, i) - rest(0, i));
      mass += masses[i];
    }
    return sum / mass;
  };
  Motion motion;
  const int steps = static_cast<int>(std::lround(1.0 / dt));
  for (int k = 1; k <= steps; ++k) {
    simulator.advance(dt, {VectorX()});
    motion.rest_m = displacement() + kStart;
    motion.first_turn_m = std::min(motion.first_turn_m, motion.rest_m);
    if (simulator.report().kinetic_contacts > 0) motion.time_s = k * dt;
  }
  return motion;
}

// Implicit Euler damps a swing at the rate omega^2 dt / 2, 1.6 % per half swing at 1 ms, which moves the place of rest by
// 7 %: to first order in dt, so 1 ms and 0.5 ms extrapolate to 0 within 1 %.
TEST(SpringBlock, SceneExtrapolatesToTheSameRest) {
  const Motion coarse = swingScene(1e-3);
  const Motion fine = swingScene(5e-4);
  const auto at_zero = [](double of_coarse, double of_fine) { return 2.0 * of_fine - of_coarse; };
  EXPECT_NEAR(at_zero(coarse.first_turn_m, fine.first_turn_m), kFirstTurn, 0.01 * std::abs(kFirstTurn));
  EXPECT_NEAR(at_zero(coarse.rest_m, fine.rest_m), kRest, 0.01 * std::abs(kRest));
  EXPECT_NEAR(fine.time_s, kTimeToRest, 0.01 * kTimeToRest);
  // First order: half the step, half the error.
  EXPECT_NEAR((fine.rest_m - kRest) / (coarse.rest_m - kRest), 0.5, 0.1);
  for (const Motion& motion : {coarse, fine}) {
    std::cout << "scene: first turn " << motion.first_turn_m << " m, rest " << motion.rest_m << " m, after "
              << motion.time_s << " s\n";
  }
}

}  // namespace
}  // namespace tissue_contact
