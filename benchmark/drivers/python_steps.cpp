/// Presses the ball of config/press_drag.yaml 4 mm deep in steps of 1 ms, drags it 10 mm, and prints the processor time of all of them and
/// the last force: what python_steps.py, which does the same from Python, is compared with.
/// usage: python_steps
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "step_times.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/simulator.h"

int main() {
  using namespace tissue_contact;
  try {
    SceneEnvironment environment;
    environment.package_path = [](const std::string&) { return std::string(TISSUE_CONTACT_SOURCE_DIR); };
    Simulator simulator(loadScene(TISSUE_CONTACT_SOURCE_DIR "/config/press_drag.yaml", environment.package_path),
                        environment);
    double sum_n = 0.0;
    const double before = processorSeconds();
    for (int k = 1; k <= 700; ++k) {
      const double path = 0.00002 * k;  // m
      simulator.advance(0.001, {Vector3(std::max(path - 0.004, 0.0), 0.0, -0.01 - std::min(path, 0.004))});
      sum_n += simulator.wrench(0).force.z();
    }
    std::printf("%.6f %.17g\n", processorSeconds() - before, sum_n);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "python_steps: %s\n", error.what());
    return 2;
  }
  return 0;
}
