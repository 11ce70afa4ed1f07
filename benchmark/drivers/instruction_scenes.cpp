/// Runs one press-and-drag scene, for counting instructions: benchmark/drivers/count_instructions runs it under callgrind. Each scene
/// but the first two is `isotropic` with one thing more, so that the cost of what a scene does not use can be read off.
/// usage: instruction_scenes frictionless|isotropic|orthotropic|stribeck|pressure_dependent|attached|pressed|viscoelastic
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "support/text_scene.h"

namespace {

using namespace tissue_contact;

constexpr int kSteps = 400;

struct Parts {
  std::string friction = "static: 0.6, kinetic: 0.4";  ///< keys of its only pair; empty: none
  std::string material = {};                           ///< more keys of it
  std::string tissue = {};                             ///< more lines of it
};

const std::map<std::string, Parts>& partsOfScenes() {
  static const std::map<std::string, Parts> all = {
      {"frictionless", {""}},
      {"isotropic", {}},
      {"orthotropic", {"law: orthotropic, static: [0.6, 0.3], kinetic: [0.4, 0.2], axis: {link_direction: [1, 0, 0]}"}},
      {"stribeck", {"static: 0.6, kinetic: 0.4, speeds_m_per_s: [0, 0.02], speed_factors: [1, 0.9]"}},
      {"pressure_dependent", {"static: 0.6, kinetic: 0.4, pressures_pa: [0, 5000], pressure_factors: [1, 0.9]"}},
      {"attached",
       {Parts().friction, "",
        "    attachments: [{where: [{plane: {point_m: [0.05, 0, 0], normal: [-1, 0, 0]}}], stiffness_pa_per_m: "
        "1e5}]\n"}},
      {"pressed", {Parts().friction, "", "    pressure_pa: 50\n"}},
      {"viscoelastic", {Parts().friction, ", prony_series: [{modulus_ratio: 0.5, time_s: 0.1}]", ""}}};
  return all;
}

Simulator makeScene(const Parts& parts) {
  const std::string friction =
      parts.friction.empty() ? "[]" : "[{instrument: probe, tissue: block, " + parts.friction + "}]";
  return makeSimulator(
      blockScene("[0.10, 0.10, 0.04]", "[10, 10, 4]", "model: corotational, poissons_ratio: 0.45" + parts.material) +
      parts.tissue + "instruments:\n" + probeEntry("probe", "/probe/joint_states", "[-0.01, 0, 0.0451]") +
      "step: {max_step_s: 0.001}\n"
      // nothing stops early: the same work in every step
      "solver: {iterations: 10, contact_passes: 2, tolerance: 1.0e-16}\n"
      "friction: " +
      friction + "\n");
}

}  // namespace

int main(int argc, char** argv) {
  const auto scene = argc == 2 ? partsOfScenes().find(argv[1]) : partsOfScenes().end();
  if (scene == partsOfScenes().end()) {
    std::fprintf(stderr,
                 "usage: instruction_scenes frictionless|isotropic|orthotropic|stribeck|pressure_dependent|attached|"
                 "pressed|viscoelastic\n");
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
