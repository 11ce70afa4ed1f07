/// Hard cases of the material: nearly incompressible tissue, and stiffness that changes a thousandfold within a mesh.
#include "validation/hard/hard_cases.h"
#include "validation/hard/hard_scene.h"

namespace tissue_contact {
namespace {

/// What a run with the default settings, which are not for this scene, still owes: to stay finite, and to say when the
/// tolerance was missed (1919 of 2000 steps without deflation, some 900 with it). The rest as a note.
void noteDefaults(const std::string& name, PadScene scene, Report& report) {
  scene.solver = "{}";
  Simulator simulator = makePad(scene);
  simulator.placeInstrument(0, PressDrag().at(0.0));
  HardRun run(simulator, 41);
  long missed = 0;
  for (int k = 1; k <= 2000; ++k) {
    simulator.advance(scene.step_s, {PressDrag().at(k * scene.step_s)});
    missed += simulator.report().stop == StopReason::kIterations;
  }
  Report found;
  run.report(name, {}, found);
  report.require(name + ": finite, no step discarded", run.finite(), "stability");
  report.atLeast(name + ": steps whose status says 'missed'", "", 500, static_cast<double>(missed),
                 "a wrong answer is not silent");
  report.atMost(name + ": error of steps whose status says 'met'", "", 0.01, run.errorWhereMet(),
                "reference solver on the same step");
  for (const std::string& note : found.notes()) report.note(note);
  for (const Check& check : found.checks()) {
    if (check.passed()) continue;
    report.note(check.quantity + " is " + std::to_string(check.got) + ": wants relaxation: cholesky");
  }
}

}  // namespace
void validateHardIncompressible(Report& report) {
  PadScene scene;
  scene.poissons_ratio = 0.49;
  runPad("nu .49", scene, {}, {}, report, 0.0, 0.2);
  scene.solver = "{relaxation: cholesky}";
  scene.poissons_ratio = 0.495;
  runPad("nu .495", scene, {}, {}, report, 0.2, 0.6);
  scene.poissons_ratio = 0.499;
  runPad("nu .499", scene, {}, {}, report, 0.6, 1.0);
}

/// Gauss-Seidel carries a force over one cell per sweep, so parts in which sound crosses several cells per step (here
/// 22 m/s x 1 ms = 3 cells) take more iterations than there are: stiff parts want Cholesky.
void validateHardStiffnessContrast(Report& report) {
  const auto layer = [](double pascal) {
    return "[{name: layer, where: [plane: {point_m: [0, 0, 0.0225], normal: [0, 0, -1]}], material: "
           "{youngs_modulus_pa: " +
           std::to_string(pascal) + ", poissons_ratio: 0.45, density_kg_per_m3: 1000}}]";
  };
  PadScene scene;
  scene.youngs_modulus_pa = 5.0e5;
  scene.regions = layer(500.0);
  runPad("soft on stiff", scene, {}, {}, report, 0.0, 0.2);
  scene.youngs_modulus_pa = 500.0;
  scene.regions = layer(5.0e5);
  noteDefaults("stiff on soft, defaults", scene, report);
  scene.solver = "{relaxation: cholesky}";
  HardBands stiff_on_soft;
  stiff_on_soft.force = 0.01;  // a tolerance of 1e-3 leaves 0.0055, one of 5e-4 less than 0.005
  runPad("stiff on soft", scene, {}, stiff_on_soft, report, 0.4, 0.7);
  scene.regions =
      "[{name: stone, where: [sphere: {center_m: [0, 0, 0.02], radius_m: 0.01}],"
      " material: {youngs_modulus_pa: 5.0e5, poissons_ratio: 0.45, density_kg_per_m3: 1000}}]";
  runPad("stone in fat", scene, {}, {}, report, 0.7, 1.0);
}

}  // namespace tissue_contact
