/// Hard cases of the step: lengths from 0.1 to 33 ms, and friction from none to mu = 2 and from 1.0 down to 0.1 at the
/// slip.
#include "validation/hard_cases.h"
#include "validation/hard_scene.h"

namespace tissue_contact {
void validateHardTimeSteps(Report& report) {
  PadScene scene;
  scene.block = "{size_m: [0.06, 0.06, 0.03], cells: [7, 7, 3]}";
  PressDrag path;
  scene.step_s = 1e-4;
  path.period_s = 0.2;
  runPad("0.1 ms", scene, path, {}, report, 0.0, 0.2);
  scene.step_s = 1e-3;
  path.period_s = 0.4;
  runPad("1 ms", scene, path, {}, report, 0.2, 0.4);
  scene.step_s = 5e-3;
  path.period_s = 1.0;
  runPad("5 ms", scene, path, {}, report, 0.4, 0.6);
  scene.solver = "{relaxation: cholesky}";
  scene.step_s = 0.01;
  runPad("10 ms", scene, path, {}, report, 0.6, 0.8);
  scene.step_s = 0.033;
  path.period_s = 2.0;
  runPad("33 ms", scene, path, {}, report, 0.8, 1.0);
}

void validateHardFriction(Report& report) {
  PadScene scene;
  const struct {
    const char* name;
    double mu_static;
    double mu_kinetic;
  } kinds[] = {{"mu 0", 0, 0}, {"mu .01", .01, .01}, {"mu 1", 1, 1}, {"mu 2", 2, 2}, {"mu 1 / .1", 1.0, 0.1}};
  double done = 0.0;
  for (const auto& kind : kinds) {
    scene.mu_static = kind.mu_static;
    scene.mu_kinetic = kind.mu_kinetic;
    HardBands bands;
    if (kind.mu_static > kind.mu_kinetic) bands.force = kStickSlip;
    runPad(kind.name, scene, {}, bands, report, done, done + 0.2);
    done += 0.2;
  }
}

}  // namespace tissue_contact
