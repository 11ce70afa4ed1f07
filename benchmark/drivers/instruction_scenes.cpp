/// Runs one press-and-drag scene, for counting instructions: benchmark/drivers/count_instructions runs it under callgrind. The scenes
/// differ in friction alone, so that the cost of what a scene does not use can be read off.
/// usage: instruction_scenes frictionless|isotropic|orthotropic|stribeck
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "support/text_scene.h"

namespace {

using namespace tissue_contact;

constexpr int kSteps = 400;

const std::map<std::string, std::string>& frictionOfScenes() {
  static const std::map<std::string, std::string> all = {
      {"frictionless", "[]"},
      {"isotropic", "[{instrument: probe, tissue: block, static: 0.6, kinetic: 0.4}]"},
      {"orthotropic",
       "[{instrument: probe, tissue: block, law: orthotropic, static: [0.6, 0.3], kinetic: [0.4, 0.2], axis: "
       "{link_direction: [1, 0, 0]}}]"},
      {"stribeck",
       "[{instrument: probe, tissue: block, static: 0.6, kinetic: 0.4, speeds_m_per_s: [0, 0.02], speed_factors: [1, "
       "0.9]}]"}};
  return all;
}

Simulator makeScene(const std::string& friction) {
  return makeSimulator(
      blockScene("[0.10, 0.10, 0.04]", "[10, 10, 4]", "model: corotational, poissons_ratio: 0.45") + "instruments:\n" +
      probeEntry("probe", "/probe/joint_states", "[-0.01, 0, 0.0451]") +
      "step: {max_step_s: 0.001}\n"
      "solver: {iterations: 10, contact_passes: 2, tolerance: 1.0e-16}\n"  // nothing stops early: the same work in every step
      "friction: " +
      friction + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  const auto scene = argc == 2 ? frictionOfScenes().find(argv[1]) : frictionOfScenes().end();
  if (scene == frictionOfScenes().end()) {
    std::fprintf(stderr, "usage: instruction_scenes frictionless|isotropic|orthotropic|stribeck\n");
    return 2;
  }
  Simulator simulator = makeScene(scene->second);
  for (int k = 1; k <= kSteps; ++k) {
    const double path = 0.02 * 0.001 * k;  // 20 mm/s: 4.1 mm down, then along x
    simulator.advance(0.001, {Vector3(std::max(path - 0.0041, 0.0), 0.0, -std::min(path, 0.0041))});
  }
  std::printf("%d\n", kSteps);
  return 0;
}
