/// @file
/// Room `validation`: a rigid sphere on an elastic block with its base fixed and cells that are smallest at the middle of its
/// upper face, in quasi-static steps.
#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include "support/text_scene.h"

namespace tissue_contact {

struct PressScene {
  Vector3 size_m = Vector3(0.06, 0.06, 0.03);
  std::array<int, 3> cells = {24, 24, 12};
  double growth = 1.15;  ///< of cells, away from the contact
  double youngs_modulus_pa = 1e4;
  double poissons_ratio = 0.45;
  double radius_m = 0.04;
  double mu = 0.0;
  std::string friction_keys;  ///< more of the rough sphere's entry in `friction`, each after a comma
  std::string model = "linear";
  std::string dilatation = "patch";
  std::string distortion = "auto";
  std::string solver = "{iterations: 150, tolerance: 1.0e-6}";

  double shearModulus() const { return youngs_modulus_pa / (2.0 * (1.0 + poissons_ratio)); }

  /// Edge of the cells at the contact, along x, m.
  double finestCell() const {
    double cells_of_half = 0.0;
    for (int i = 0; i < cells[0] / 2; ++i) cells_of_half += std::pow(growth, i);
    return 0.5 * size_m.x() / cells_of_half;
  }
};

/// Steps are long, so that implicit Euler damps what motion there is.
constexpr double kPressStep = 0.02;

/// Two spheres of the same size with joints x, y, z: instrument 0 has no friction, instrument 1 has it. Joints at 0: their
/// lowest point just touches the middle of the block's upper face.
inline Simulator makePress(const PressScene& scene) {
  std::ostringstream yaml;
  yaml.precision(17);
  const Vector3& size = scene.size_m;
  yaml << "tissues:\n  - name: block\n    block:\n      size_m: [" << size.x() << ", " << size.y() << ", " << size.z()
       << "]\n      cells: [" << scene.cells[0] << ", " << scene.cells[1] << ", " << scene.cells[2]
       << "]\n      grading: {x: {growth: " << scene.growth << "}, y: {growth: " << scene.growth
       << "}, z: {growth: " << scene.growth << ", fine_at: maximum}}\n"
       << "    material: {model: " << scene.model << ", dilatation: " << scene.dilatation
       << ", distortion: " << scene.distortion << ", youngs_modulus_pa: " << scene.youngs_modulus_pa
       << ", poissons_ratio: " << scene.poissons_ratio << ", density_kg_per_m3: 1000}\n"
       << "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
       << "instruments:\n";
  for (const char* const name : {"smooth", "rough"}) {
    yaml << "  - {name: " << name << ", robot_description: probe, tip_link: tip, contact_links: [tip],"
         << " joint_state_topics: [/" << name << "], base_pose: {position_m: [0, 0, " << size.z() + scene.radius_m
         << "]}}\n";
  }
  yaml << "friction:\n  - {instrument: rough, tissue: block, static: " << scene.mu << scene.friction_keys << "}\n"
       << "step: {max_step_s: " << kPressStep << "}\nsolver: " << scene.solver << "\n";
  Simulator simulator = makeSimulator(yaml.str(), {{"probe", probeUrdf(scene.radius_m)}});
  simulator.placeInstrument(1, Vector3(0.0, 0.0, 0.5));
  return simulator;
}

/// Presses the smooth sphere in by `depth_m` within 0.2 s and waits for `settle` steps.
inline void pressSmooth(Simulator& simulator, double depth_m, int settle = 15) {
  const Vector3 away(0.0, 0.0, 0.5);
  for (int k = 1; k <= 10 + settle; ++k) {
    simulator.advance(kPressStep, {Vector3(0.0, 0.0, -std::min(1.0, k / 10.0) * depth_m), away});
  }
}

}  // namespace tissue_contact
