/// Form C: a block of 1 kg on a spring of 100 N/m with friction 0.3, let go at 0.1 m: loses 0.05886 m per half swing
/// and stops at -0.01772 m after 0.6283 s. As a scene (a strip as the spring, its heavy end as the block, tilted
/// gravity in place of the initial displacement), stepped by implicit Euler; and at the solver, with the midpoint rule
/// in place of it. Without friction, but damped, the strip's free swing.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "support/text_scene.h"
#include "validation/closed_forms.h"
#include "validation/report.h"
#include "validation/sliding_mass.h"

namespace tissue_contact {
namespace {

constexpr double kMass = 1.0;         // kg
constexpr double kStiffness = 100.0;  // N/m
constexpr double kOmega = 10.0;       // sqrt(k / m), rad/s
constexpr double kMu = 0.3;
constexpr double kGravity = 9.81;
constexpr double kStart = 0.1;                                                   // m
constexpr double kLossPerHalfSwing = 2.0 * kMu * kMass * kGravity / kStiffness;  // 0.05886 m
constexpr double kFirstTurn = kLossPerHalfSwing - kStart;                        // -0.04114 m
constexpr double kRest = kStart - 2.0 * kLossPerHalfSwing;  // -0.01772 m, where 1.77 N of spring meet 2.94 N
constexpr double kTimeToRest = 2.0 * M_PI / kOmega;
constexpr const char* kSource = "half swings about +-mu m g / k";

struct Motion {
  double first_turn_m = 0.0;  ///< lowest place
  double rest_m = 0.0;        ///< at the end
  double time_s = 0.0;        ///< when it came to rest
};

// 1 % of each is what validation asks for at 1 ms. That leaves room for stops known to one step: half a step at the
// turn moves it by 1e-4 of the swing, two steps of 0.628 s are 0.3 %.
void checkMotion(Report& report, const std::string& how, const Motion& motion) {
  report.near(how + ": loss of the first half swing", "m", kLossPerHalfSwing, kStart + motion.first_turn_m,
              0.01 * kLossPerHalfSwing, kSource);
  report.near(how + ": loss of the second half swing", "m", kLossPerHalfSwing, -motion.first_turn_m - motion.rest_m,
              0.01 * kLossPerHalfSwing, kSource);
  report.near(how + ": place of rest", "m", kRest, motion.rest_m, 0.01 * std::abs(kRest), kSource);
  report.near(how + ": time to rest", "s", kTimeToRest, motion.time_s, 0.01 * kTimeToRest, "one period of the spring");
}

// ---- the midpoint rule
// -----------------------------------------------------------------------------------------------

Motion swingWithMidpointRule(double dt) {
  SlidingMass block(kMass, kStiffness, kGravity, {kMu, kMu}, kStart);
  Motion motion;
  for (int k = 1; k <= static_cast<int>(std::lround(1.0 / dt)); ++k) {
    block.step(dt, 0.0);
    motion.first_turn_m = std::min(motion.first_turn_m, block.position());
    if (block.state() != ContactState::kStatic) motion.time_s = k * dt;
  }
  motion.rest_m = block.position();
  return motion;
}

// On the way to the first turn the place is smooth in dt. At the stops it is not: they fall anywhere within a step.
void midpointRuleIsSecondOrder(Report& report) {
  constexpr double kWhen = 0.256;  // s: a multiple of all steps, before the turn at 0.314 s
  constexpr double kCenter = 0.5 * kLossPerHalfSwing;
  ConvergenceStudy study = {"place after 0.256 s, midpoint rule", "m", "dt (s)", {}, 0.0};
  study.limit = kCenter + (kStart - kCenter) * std::cos(kOmega * kWhen);
  for (const double dt : {0.008, 0.004, 0.002, 0.001, 0.0005}) {
    SlidingMass block(kMass, kStiffness, kGravity, {kMu, kMu}, kStart);
    for (int k = 0; k < static_cast<int>(std::lround(kWhen / dt)); ++k) block.step(dt, 0.0);
    study.levels.push_back({dt, block.position()});
  }
  // (omega dt)^2 = 0.6 % at the longest step is what the next order adds.
  report.near("midpoint rule: observed order in dt", "", 2.0, study.observedOrder(), 0.02, "second order");
  report.convergence(study);
}

// ---- the scene
// -------------------------------------------------------------------------------------------------------

/// A strip of 1 m and 100 N/m, fixed at its right end; at its left one a stiff cell of 0.1 m and 1 kg. Gravity has a
/// component of 10 m/s^2 along the strip, which moves the place where the spring is free by 0.1 m. The strip weighs 0.1
/// g, whose own sag is 5 um; with 1 g it is 50 um, 0.3 % of what is looked for.
/// @param damping of the strip, and the same with another value for the region of the block; may be empty.
/// @param on_table else nothing touches it.
Simulator makeStrip(const std::string& damping, const std::string& region_damping, bool on_table) {
  std::ostringstream yaml;
  yaml << "gravity_m_per_s2: [" << -kStart * kStiffness / kMass << ", 0, " << (on_table ? -kGravity : 0.0) << "]\n"
       << "tissues:\n  - name: strip\n    sheet: {size_m: [1.1, 0.1], cells: [11, 1], thickness_m: 0.001}\n"
       << "    material: {youngs_modulus_pa: 1.0e6, poissons_ratio: 0, density_kg_per_m3: 1, bending_stiffness_n_m: "
          "0}\n"
       << "    regions: [{name: block, where: [{box: {min_m: [-0.55, -1, -1], max_m: [-0.45, 1, 1]}}],"
       << " material: {youngs_modulus_pa: 1.0e9, density_kg_per_m3: 1.0e5}" << region_damping << "}]\n"
       << damping << "    fixed: [{plane: {point_m: [0.55, 0, 0], normal: [-1, 0, 0]}}]\n"
       << "step: {max_step_s: 0.01}\nsolver: {relaxation: cholesky, iterations: 200, tolerance: 1.0e-9}\n";
  if (!on_table) return makeSimulator(yaml.str() + "instruments: []\n", {});
  yaml << "instruments:\n  - {name: table, robot_description: table, tip_link: table, contact_links: [table],"
       << " base_pose: {position_m: [0, 0, -0.0005]}}\n"
       << "friction:\n  - {instrument: table, tissue: strip, static: " << kMu << "}\n";
  return makeSimulator(yaml.str(), {{"table", tableUrdf()}});
}

/// Mean displacement of the block's four nodes; what the strip weighs beside them is 0.01 %.
double displacement(const Simulator& simulator) {
  const NodalVectors& rest = simulator.tissues()[0].restPositions();
  const VectorX& masses = simulator.tissues()[0].nodeMasses();
  double sum = 0.0;
  double mass = 0.0;
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    if (rest(0, i) > -0.44) continue;
    sum += masses[i] * (simulator.positions(0)(0, i) - rest(0, i));
    mass += masses[i];
  }
  return sum / mass;
}

Motion swingScene(double dt) {
  Simulator simulator = makeStrip("", "", true);
  Motion motion;
  for (int k = 1; k <= static_cast<int>(std::lround(1.0 / dt)); ++k) {
    simulator.advance(dt, {VectorX()});
    motion.rest_m = displacement(simulator) + kStart;
    motion.first_turn_m = std::min(motion.first_turn_m, motion.rest_m);
    if (simulator.report().kinetic_contacts > 0) motion.time_s = k * dt;
  }
  return motion;
}

/// What implicit Euler makes of the point mass itself: the velocity of each step in closed form.
double eulersPlaceOfRest(double dt) {
  double x = kStart;
  double v = 0.0;
  for (int k = 0; k < static_cast<int>(std::lround(1.0 / dt)); ++k) {
    const double momentum = kMass * v - dt * kStiffness * x;  // of the step without friction
    const double friction = std::min(std::abs(momentum), dt * kMu * kMass * kGravity);
    v = std::copysign(std::abs(momentum) - friction, momentum) / (kMass + dt * dt * kStiffness);
    x += dt * v;
  }
  return x;
}

// Implicit Euler damps a swing at the rate omega^2 dt / 2, 1.6 % per half swing at 1 ms, which moves the place of rest
// by 7 %: to first order in dt, so 1 ms and 0.5 ms extrapolate to 0 within 1 %.
void sceneConvergesToTheSameRest(Report& report) {
  ConvergenceStudy study = {"place of rest, the product's implicit Euler", "m", "dt (s)", {}, kRest};
  std::vector<Motion> motions;
  for (const double dt : {2e-3, 1e-3, 5e-4, 2.5e-4}) {
    motions.push_back(swingScene(dt));
    study.levels.push_back({dt, motions.back().rest_m});
    report.progress(std::min(1.0, 0.25 * static_cast<double>(motions.size())));
  }
  const Motion& coarse = motions[1];
  const Motion& fine = motions[2];
  const auto at_zero = [](double of_coarse, double of_fine) { return 2.0 * of_fine - of_coarse; };
  checkMotion(report, "scene, dt -> 0",
              {at_zero(coarse.first_turn_m, fine.first_turn_m), at_zero(coarse.rest_m, fine.rest_m), fine.time_s});
  // A swing at 2 ms is damped by 6 %: as much may the next order change the observed one.
  report.near("scene: observed order in dt", "", 1.0, study.observedOrder(), 0.06, "implicit Euler: first order");
  report.convergence(study);
  // The strip's own sag is 0.03 % of it, friction on the strip 0.01 %.
  report.near("scene at 1 ms: place of rest", "m", eulersPlaceOfRest(1e-3), coarse.rest_m, 0.001 * std::abs(kRest),
              "implicit Euler of a point mass");
  // Steps as long as users may set: a third and more than half too far from where the block should rest, as the rule itself has it.
  for (const double dt : {5e-3, 1e-2}) {
    std::ostringstream name;
    name << "scene at " << 1e3 * dt << " ms: place of rest";
    report.near(name.str(), "m", eulersPlaceOfRest(dt), swingScene(dt).rest_m, 0.001 * std::abs(kRest),
                "implicit Euler of a point mass");
  }
}

// ---- the same spring without friction, but damped
// ---------------------------------------------------------------------------

constexpr double kBeta = 0.01;  // s: zeta = beta omega / 2 = 0.05

/// How far it swings beyond the middle at the fifth turn, as a share of that at the first.
double shareLeft(double dt, const std::string& region_damping) {
  Simulator simulator = makeStrip("    damping: {stiffness_s: " + std::to_string(kBeta) + "}\n", region_damping, false);
  std::vector<double> turns;
  double before = 0.0;
  double last = 0.0;
  while (turns.size() < 5 && static_cast<double>(simulator.stepCount()) * dt < 3.0) {
    simulator.advance(dt, {});
    const double now = displacement(simulator);
    if ((last - before) * (now - last) < 0.0) turns.push_back(last + kStart);
    before = last;
    last = now;
  }
  return turns.size() == 5 ? std::abs(turns[4] / turns[0]) : 0.0;
}

// Implicit Euler of x'' + beta omega^2 x' + omega^2 x = 0: z^2 - z (2 + b - a)/(1 + b) + 1/(1 + b) = 0 with a = (omega dt)^2,
// b = omega^2 (beta + dt) dt, so that a step turns by theta, cos theta = (2 + b - a) / (2 sqrt(1 + b)), and shrinks by
// sqrt(1 + b). A turn is found to half a step: (omega dt)^2 / 8 of its height, 0.1 % at 10 ms, at both turns.
void freeSwingIsDampedByTheStepAsItsFormulaSays(Report& report) {
  const std::string other = ", damping: {stiffness_s: 0.012}";  // the block does not deform: only the matrix D is used
  for (const double dt : {0.01, 0.005, 0.002, 0.001}) {
    const double a = kOmega * kOmega * dt * dt;
    const double b = kOmega * kOmega * (kBeta + dt) * dt;
    const double theta = std::acos((2.0 + b - a) / (2.0 * std::sqrt(1.0 + b)));
    const double expected = std::pow(1.0 + b, -2.0 * M_PI / theta);
    std::ostringstream name;
    name << "free swing, beta 10 ms, dt " << 1e3 * dt << " ms: ";
    report.near(name.str() + "fifth turn / first", "", expected, shareLeft(dt, ""), 0.003 * expected,
                "implicit Euler of a point mass");
    report.near(name.str() + "the same with a damping matrix", "", expected, shareLeft(dt, other), 0.003 * expected,
                "same");
  }
}

}  // namespace

void validateSpringBlock(Report& report) {
  checkMotion(report, "midpoint rule, 1 ms", swingWithMidpointRule(0.001));
  midpointRuleIsSecondOrder(report);
  sceneConvergesToTheSameRest(report);
  freeSwingIsDampedByTheStepAsItsFormulaSays(report);
}

}  // namespace tissue_contact
