/// @file
/// A block on springs or under pressure, and how far it has come: for the tests and the validation case of both.
#pragma once

#include <string>

#include "support/text_scene.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

inline const std::string kHeavy = "gravity_m_per_s2: [0, 0, -9.81]\n";
inline const std::string kAwake = "advisor: {sleep: never}\n";
inline const std::string kCholesky = "solver: {relaxation: cholesky, iterations: 100, tolerance: 1.0e-10}\n";
constexpr double kGravity = 9.81;

/// 40 x 30 x 20 mm with origin in the middle of its lowest face, 60 nodes; rho g h = 196.2 Pa, m = 24 g.
/// @param material, tissue, scene more lines of each.
inline Simulator makeHeldBlock(const std::string& material, const std::string& tissue, const std::string& scene) {
  return makeSimulator(
      "tissues:\n  - name: block\n    block: {size_m: [0.04, 0.03, 0.02], cells: [4, 3, 2]}\n"
      "    material: {density_kg_per_m3: 1000, " +
      material + "}\n" + tissue + scene);
}

inline NodalVectors displacement(const Simulator& simulator) {
  return simulator.positions(0) - simulator.tissues()[0].restPositions();
}

/// Mean over the area of the lowest face, m.
inline double meanSinking(const Simulator& simulator) {
  const Tissue& tissue = simulator.tissues()[0];
  const NodalVectors u = displacement(simulator);
  double sum = 0.0;
  double area = 0.0;
  for (const Triangle& triangle : tissue.surface()) {
    double height = 0.0;
    for (const int node : triangle) height += tissue.restPositions()(2, node);
    if (height > 1e-9) continue;
    const double own = triangleArea(tissue.restPositions(), triangle);
    area += own;
    for (const int node : triangle) sum -= own / 3.0 * u(2, node);
  }
  return sum / area;
}

/// Root of 3 K e = -p (1 + e)^2: the stress 3 K e of a uniform dilatation acts on undeformed areas, the pressure on
/// deformed ones. To first order -p / (3 K).
inline double uniformStrain(double pressure, double bulk_modulus) {
  double e = 0.0;
  for (int k = 0; k < 100; ++k) e = -pressure * (1.0 + e) * (1.0 + e) / (3.0 * bulk_modulus);
  return e;
}

}  // namespace tissue_contact
