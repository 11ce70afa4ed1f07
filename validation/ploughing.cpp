/// Friction is judged in contact frames: |tangential| = mu_k normal where a contact slides, <= mu_s normal where it holds.
/// A ball that ploughs deep has tissue in front of it, so that the ratio of its horizontal to its vertical force is not mu:
/// a ball of 5 mm radius, 8 mm deep, gives 1.1 to 1.3 at mu = .5. Also: forces are impulses over dt, so that a slow press
/// gives the same force whatever the step.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "support/text_scene.h"
#include "validation/closed_forms.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

/// A ball of 5 mm radius that just touches a block with its base fixed, 30 mm high, cells of 5 mm, 10 mm behind the middle
/// of its upper face.
Simulator makeBall(const std::string& size_m, const std::string& cells, double step_s, double mu_static,
                   double mu_kinetic) {
  std::ostringstream yaml;
  yaml
      << "tissues:\n  - name: block\n    block: {size_m: " << size_m << ", cells: " << cells << "}\n"
      << "    material: {model: corotational, youngs_modulus_pa: 5000, poissons_ratio: 0.45, density_kg_per_m3: 1000}\n"
      << "    damping: {stiffness_s: 0.002}\n"
      << "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
      << "instruments:\n  - name: ball\n    robot_description: probe\n    tip_link: tip\n    contact_links: [tip]\n"
      << "    joint_state_topics: [/joint_states]\n    base_pose: {position_m: [-0.01, 0, 0.035]}\n"
      << "friction:\n  - {instrument: ball, tissue: block, static: " << mu_static << ", kinetic: " << mu_kinetic
      << "}\n"
      << "step: {max_step_s: " << step_s << "}\n"
      << "solver: {relaxation: cholesky, iterations: 200, tolerance: 1.0e-5}\n";
  return makeSimulator(yaml.str(), {{"probe", probeUrdf(0.005)}});
}

Simulator makeSmall(double step_s, double mu_static, double mu_kinetic) {
  return makeBall("[0.05, 0.04, 0.03]", "[10, 8, 6]", step_s, mu_static, mu_kinetic);
}

/// Worst values over all contacts of a run.
struct InContactFrames {
  double off_kinetic = 0.0;  ///< | |f_t| / f_n - mu_k |, sliding contacts
  double off_static = 0.0;   ///< |f_t| / f_n - mu_s, where positive, held contacts
  int kinetic = 0;           ///< contacts seen
  int held = 0;

  void add(const Simulator& simulator, double mu_static, double mu_kinetic) {
    for (const SolvedContact& solved : simulator.contacts()) {
      const Vector3 f = solved.contact.R_WC.transpose() * solved.force_on_tissue_n;
      if (solved.state == ContactState::kOpen || !(f.x() > 0.0)) continue;
      const double ratio = f.tail<2>().norm() / f.x();
      if (solved.state == ContactState::kKinetic) {
        ++kinetic;
        off_kinetic = std::max(off_kinetic, std::abs(ratio - mu_kinetic));
      } else {
        ++held;
        off_static = std::max(off_static, ratio - mu_static);
      }
    }
  }
};

/// Presses 8 mm deep and drags by 20 mm at 20 mm/s. @return mean horizontal over mean vertical force over the last two
/// cells: the force swings as the ball passes from cell to cell.
double plough(Simulator simulator, double mu_static, double mu_kinetic, InContactFrames& frames) {
  constexpr double kStep = 0.005;
  for (int k = 1; k <= 80; ++k) simulator.advance(kStep, {Vector3(0.0, 0.0, -0.008 * k / 80.0)});
  double horizontal = 0.0;
  double vertical = 0.0;
  for (int k = 1; k <= 200; ++k) {
    simulator.advance(kStep, {Vector3(1e-4 * k, 0.0, -0.008)});
    frames.add(simulator, mu_static, mu_kinetic);
    if (k <= 100) continue;
    horizontal += std::abs(simulator.wrench(0).force.x());
    vertical += simulator.wrench(0).force.z();
  }
  return horizontal / vertical;
}

void judge(const std::string& name, const InContactFrames& frames, Report& report) {
  const char* const source = "Coulomb's law in the contact frame";
  report.atLeast(name + "sliding contacts seen", "", 100.0, frames.kinetic, "a drag");
  // Sliding impulses come from one formula per contact: round-off.
  report.atMost(name + "sliding: | |f_t| / f_n - mu_k |", "", 1e-9, frames.off_kinetic, source);
  report.atMost(name + "held: |f_t| / f_n - mu_s", "", 1e-9, frames.off_static, source);
}

void ploughingDrag(Report& report) {
  InContactFrames frames;
  const double ratio = plough(makeBall("[0.1, 0.07, 0.03]", "[20, 14, 6]", 0.005, 0.5, 0.5), 0.5, 0.5, frames);
  judge("mu .5: ", frames, report);
  // Other simulations give 1.1 to 1.3. Here, with cells as large as the ball, it is 1.1 to 1.4 with plain tetrahedra, by where
  // the path begins, and 1.5 with averaged dilatation: no figure to hold a simulator to, but far above mu.
  report.atLeast("mu .5, 8 mm deep: horizontal over vertical force", "", 1.0, ratio, "twice mu: it ploughs");
  report.progress(0.4);
  InContactFrames with_hysteresis;
  plough(makeSmall(0.005, 0.6, 0.3), 0.6, 0.3, with_hysteresis);
  judge("mu .6 / .3: ", with_hysteresis, report);
  report.atLeast("mu .6 / .3: held contacts seen", "", 1.0, with_hysteresis.held, "a drag starts from rest");
}

/// Vertical force after a press of 2 mm within 2 s and .2 s of rest.
double pressForce(double step_s, double mu) {
  Simulator simulator = makeSmall(step_s, mu, mu);
  const int steps = static_cast<int>(std::lround(2.2 / step_s));
  for (int k = 1; k <= steps; ++k) {
    simulator.advance(step_s, {Vector3(0.0, 0.0, -0.002 * std::min(1.0, 0.5 * k * step_s))});
  }
  return simulator.wrench(0).force.z();
}

void pressAtAnyStep(Report& report) {
  for (const double mu : {0.0, 0.5}) {
    const double force = pressForce(0.001, mu);
    report.progress(mu == 0.0 ? 0.7 : 0.95);
    for (const double step_s : {0.005, 0.01}) {
      std::ostringstream name;
      name << "slow press, mu " << mu << ", dt " << 1e3 * step_s << " ms: force";
      // Rest is the same for every step. Friction holds a point where the step ends in which it touches: up to 10 um of the
      // way of 2 mm from where it met the ball, at 10 ms: .5 % of it.
      report.near(name.str(), "N", force, pressForce(step_s, mu), (mu == 0.0 ? 2e-3 : 6e-3) * force, "that at 1 ms");
    }
  }
}

/// One step, and several in one interval: the wrench is the sum of the last step's impulses over its dt.
void forcesAreImpulsesOverDt(Report& report) {
  Simulator simulator = makeSmall(0.002, 0.5, 0.3);
  for (const double interval_s : {0.002, 0.01}) {
    for (int k = 1; k <= 10; ++k) {
      VectorX target = simulator.jointPositions(0) + Vector3(1e-5, 0.0, -2e-4);
      simulator.advance(interval_s, {target});
    }
    Vector3 impulse = Vector3::Zero();
    const ContactProblem& problem = simulator.lastProblem();
    for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
      impulse -= problem.contacts[c].R_WC * simulator.lastSolution().impulses[c];
    }
    const Vector3 force = simulator.wrench(0).force;  // tip axes are world axes here
    const bool one = interval_s == 0.002;
    report.near(std::string(one ? "one step" : "five steps") + " of 2 ms: impulse over dt", "N", force.norm(),
                impulse.norm() / 0.002, 1e-12 * force.norm(), "lambda / dt = force");
    report.require(std::string(one ? "one step" : "five steps") + ": as many as said, and pressing",
                   simulator.report().substeps == (one ? 1 : 5) && force.z() > 0.0, "max_step_s: 2 ms");
  }
}

}  // namespace

void validatePloughing(Report& report) {
  ploughingDrag(report);
  pressAtAnyStep(report);
  forcesAreImpulsesOverDt(report);
}

}  // namespace tissue_contact
