/// Hard cases of time: a contact held for ten minutes, and a thousand cycles of press, drag and lift.
#include "validation/hard/hard_cases.h"
#include "validation/hard/hard_scene.h"

namespace tissue_contact {

/// 10 ms steps, with the relaxation that is for them. The probe holds the tissue aside by static friction.
void validateHardLongHold(Report& report) {
  PadScene scene;
  scene.block = "{size_m: [0.06, 0.06, 0.03], cells: [5, 5, 2]}";
  scene.step_s = 0.01;
  scene.solver = "{relaxation: cholesky}";
  scene.mu_static = scene.mu_kinetic = 1.0;
  Simulator simulator = makePad(scene);
  HardRun run(simulator, 997);
  const Vector3 there(0.002, 0.0, -0.004);
  for (int k = 1; k <= 50; ++k) simulator.advance(0.01, {Vector3(0.0, 0.0, there.z() * k / 50)});
  for (int k = 1; k <= 50; ++k) simulator.advance(0.01, {Vector3(there.x() * k / 50, 0.0, there.z())});
  for (int k = 1; k <= 900; ++k) simulator.advance(0.01, {there});
  const NodalVectors start = simulator.positions(0);
  const Vector3 force = simulator.wrench(0).force;
  double changed = 0.0;
  for (int k = 1; k <= 60000; ++k) {
    simulator.advance(0.01, {there});
    if (k % 100 == 0) {
      changed = std::max(changed, (simulator.wrench(0).force - force).norm());
      report.progress(k / 60000.0);
    }
  }
  run.report("10 min", {}, report);
  report.atLeast("10 min: static contacts at the end", "", 1, simulator.report().static_contacts, "friction holds");
  report.atMost("10 min: farthest any node went", "m", 1e-6,
                (simulator.positions(0) - start).colwise().norm().maxCoeff(), "no creep: 1 um as for 60 s");
  report.atMost("10 min: change of the force over the force", "", 1e-3, changed / force.norm(), "no drift");
  report.note("held force " + std::to_string(force.norm()) + " N, " +
              std::to_string(simulator.report().static_contacts) + " static contacts");
}

namespace {

/// Cycles of 40 steps of 2.5 ms without a pause, then 2 s of rest. @return what is left of the deformation, m.
double cycleAndRest(const std::string& name, int cycles, const PadScene& scene, Report& report) {
  constexpr int kSteps = 40;
  Simulator simulator = makePad(scene);
  HardRun run(simulator, 211);  // a prime: every part of the cycle comes up
  PressDrag path;
  path.period_s = kSteps * scene.step_s;
  double reference = 0.0;
  double drift = 0.0;
  double peak = 0.0;
  for (int k = 1; k <= cycles * kSteps; ++k) {
    simulator.advance(scene.step_s, {path.at(k * scene.step_s)});
    peak = std::max(peak, simulator.wrench(0).force.norm());
    if (k % kSteps != 0) continue;
    const int cycle = k / kSteps;
    if (cycle == 10) reference = peak;  // the first cycles start from rest
    if (cycle > 10) drift = std::max(drift, std::abs(peak - reference));
    peak = 0.0;
    if (cycle % 20 == 0) report.progress(static_cast<double>(cycle) / cycles);
  }
  for (int k = 1; k <= 800; ++k) simulator.advance(scene.step_s, {path.at(0.0)});
  run.report(name, {}, report);
  report.atMost(name + ": change of the largest force, share", "", 1e-3, drift / reference, "every cycle is the same");
  return (simulator.positions(0) - simulator.tissues()[0].restPositions()).colwise().norm().maxCoeff();
}

}  // namespace

void validateHardCycles(Report& report) {
  PadScene scene;
  scene.block = "{size_m: [0.06, 0.06, 0.03], cells: [4, 4, 2]}";
  scene.step_s = 0.0025;
  const double left = cycleAndRest("1000 cycles", 1000, scene, report);
  report.atMost("1000 cycles: left of the deformation after 2 s", "m", 1e-3 * 0.015, left,
                "advisor.sleep_error: a thousandth of an edge of 15 mm");
  scene.more = "advisor: {sleep: never}\n";
  report.atMost("100 cycles, no sleep: left after 2 s", "m", 1e-8,
                cycleAndRest("100 cycles, no sleep", 100, scene, report), "returns to rest");
}

}  // namespace tissue_contact
