/// Hard cases of the number of contacts: from one to two thousand at once, and tissue pinched between two instruments.
#include "validation/hard/hard_cases.h"
#include "validation/hard/hard_scene.h"

namespace tissue_contact {
namespace {

constexpr double kModulus = 5000.0;

/// A free plate of 31 x 31 cells, 60 x 60 x 4 mm, on a table and under one: up to 2048 nodes touch. nu = 0, so that it
/// does not spread and the stress is E delta / h everywhere, whatever the friction.
Simulator makePlate() {
  std::ostringstream yaml;
  yaml << "tissues:\n  - name: plate\n    block: {size_m: [0.06, 0.06, 0.004], cells: [31, 31, 1]}\n"
       << "    material: {model: linear, youngs_modulus_pa: " << kModulus
       << ", poissons_ratio: 0, density_kg_per_m3: 1000}\n    damping: {stiffness_s: 0.003}\n"
       << "instruments:\n  - {name: table, robot_description: table, tip_link: table, contact_links: [table]}\n"
       << "  - {name: press, robot_description: press, tip_link: tip, contact_links: [tip],"
       << " joint_state_topics: [/js], base_pose: {position_m: [0, 0, 0.0141]}}\n"
       << "friction:\n  - {instrument: table, tissue: plate, static: 0.5}\n"
       << "  - {instrument: press, tissue: plate, static: 0.5}\n";
  return makeSimulator(yaml.str(), {{"table", tableUrdf()}, {"press", tipUrdf("<box size='0.08 0.08 0.02'/>")}});
}

void pressPlate(Report& report) {
  Simulator simulator = makePlate();
  HardRun run(simulator, 0);
  const auto down = [](double depth) { return std::vector<VectorX>{VectorX(), Vector3(0.0, 0.0, -0.0001 - depth)}; };
  constexpr double kDepth = 2e-4;
  for (int k = 1; k <= 2000; ++k) {
    simulator.advance(0.001, down(kDepth * std::min(1.0, k / 500.0)));
    if (k % 20 == 0) report.progress(0.5 * k / 2000);
  }
  run.report("2000 contacts", {}, report);
  report.atLeast("2000 contacts: most at once", "", 2000, run.mostContacts(), "31 x 31 cells, both faces");
  const double force = kModulus * 0.06 * 0.06 * kDepth / 0.004;
  report.near("2000 contacts: force on the upper plate", "N", force, simulator.wrench(1).force.z(), 2e-3 * force,
              "E A delta / h; default settings 0.2 %");
  report.near("2000 contacts: force on the table", "N", -force, simulator.wrench(0).force.z(), 2e-3 * force,
              "E A delta / h; default settings 0.2 %");
}

/// A ball of half a metre settles on a fine pad: from the first contact to a few hundred.
void growingContact(Report& report) {
  PadScene scene;
  scene.block = "{size_m: [0.06, 0.06, 0.006], cells: [16, 16, 1]}";
  scene.radius_m = 0.5;
  PressDrag path;
  path.at_m.z() = -0.024;
  path.depth_m = 0.002;
  path.way_m = 0.001;
  path.period_s = 1.0;
  runPad("1 to 300 contacts", scene, path, {}, report, 0.5, 1.0);
}

/// A pad fixed at one end between two balls that close on it, go up and down together, and open.
void pinch(const std::string& name, const std::string& solver, double closing, Report& report, double from, double to) {
  std::ostringstream yaml;
  yaml << "tissues:\n  - name: flap\n    block: {size_m: [0.04, 0.02, 0.006], cells: [12, 6, 2]}\n"
       << "    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.45, density_kg_per_m3: 1000}\n"
       << "    damping: {stiffness_s: 0.003}\n    fixed: [{plane: {point_m: [-0.0199, 0, 0], normal: [1, 0, 0]}}]\n"
       << "instruments:\n";
  for (const auto& [side, z] : {std::pair("lower", "-0.005"), std::pair("upper", "0.011")}) {
    yaml << "  - {name: " << side << ", robot_description: probe, tip_link: tip, contact_links: [tip],"
         << " joint_state_topics: [/" << side << "], base_pose: {position_m: [0.01, 0, " << z << "]}}\n";
  }
  yaml << "friction:\n  - {instrument: lower, tissue: flap, static: 0.6, kinetic: 0.4}\n"
       << "  - {instrument: upper, tissue: flap, static: 0.6, kinetic: 0.4}\nsolver: " << solver << "\n";
  Simulator simulator = makeSimulator(yaml.str(), {{"probe", probeUrdf(0.005)}});
  HardRun run(simulator, 23);
  double imbalance = 0.0;
  for (int k = 1; k <= 2500; ++k) {
    const double t = 0.001 * k;
    const double close = closing * (std::min(1.0, t / 0.3) - std::max(0.0, std::min(1.0, (t - 1.5) / 0.3)));
    const double lift = 0.004 * std::sin(2.0 * M_PI * std::min(1.0, std::max(0.0, t - 0.4)));
    simulator.advance(0.001, {Vector3(lift, 0.0, close + lift), Vector3(lift, 0.0, lift - close)});
    if (t > 0.3 && t < 0.4) {  // held still: the flap itself carries little
      const Vector3 sum = simulator.wrench(0).force + simulator.wrench(1).force;
      imbalance = std::max(imbalance, sum.norm() / simulator.wrench(1).force.norm());
    }
    if (k % 50 == 0) report.progress(from + (to - from) * k / 2500);
  }
  run.report(name, {}, report);
  report.note(name + ": sum of both forces over one, while closed: " + std::to_string(imbalance));
  const double away = (simulator.positions(0) - simulator.tissues()[0].restPositions()).colwise().norm().maxCoeff();
  report.atMost(name + ": left of the deformation 0.7 s after", "m", 5e-5, away, "elastic, 1 % of its travel");
}

}  // namespace

void validateHardManyContacts(Report& report) {
  pressPlate(report);
  growingContact(report);
}

void validateHardPinch(Report& report) {
  pinch("pinched by a third", "{}", 0.001, report, 0.0, 0.5);
  pinch("pinched by two thirds", "{}", 0.002, report, 0.5, 1.0);
}

}  // namespace tissue_contact
