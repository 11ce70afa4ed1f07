/// Form F: a rigid sphere pressed without friction into an elastic layer on a rigid base. Hertz on a half space, times a
/// series in chi = contact radius / thickness for a layer bonded to its base (Dimitriadis et al. 2002).
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "validation/press_scene.h"

namespace tissue_contact {
namespace {

constexpr double kRadius = 0.04;
constexpr double kDepth = 0.000625;  // contact radius 5 mm
constexpr double kThickness = 0.03;  // chi = 1/6

/// Hertz: what a half space would take, N.
double halfSpaceForce(double E, double nu) {
  return 4.0 / 3.0 * E / (1.0 - nu * nu) * std::sqrt(kRadius) * std::pow(kDepth, 1.5);
}

double layerForce(double E, double nu) {
  const double alpha = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1.0 - nu);
  const double beta = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1.0 - nu);
  const double pi = M_PI;
  const double chi = std::sqrt(kRadius * kDepth) / kThickness;
  const double cubic = -8.0 / std::pow(pi, 3) * (std::pow(alpha, 3) + 4.0 * pi * pi * beta / 15.0);
  const double quartic = 16.0 * alpha / std::pow(pi, 4) * (std::pow(alpha, 3) + 3.0 * pi * pi * beta / 5.0);
  const double series = 1.0 - 2.0 * alpha / pi * chi + 4.0 * alpha * alpha / (pi * pi) * chi * chi +
                        cubic * std::pow(chi, 3) + quartic * std::pow(chi, 4);
  return halfSpaceForce(E, nu) * series;
}

/// 90 mm wide, three thicknesses: its free sides take less than 1 % off. `refinement` 1: 20 x 20 x 8 cells of 2.2 mm at
/// the contact, 1.154 times longer each; at another one all cells are smaller by that ratio, the same mesh otherwise.
double pressForce(double refinement, double nu) {
  PressScene scene;
  scene.size_m = Vector3(0.09, 0.09, kThickness);
  const int across = static_cast<int>(std::lround(20 * refinement));
  scene.cells = {across, across, static_cast<int>(std::lround(8 * refinement))};
  scene.growth = std::pow(1.1537, 1.0 / refinement);
  scene.poissons_ratio = nu;
  scene.radius_m = kRadius;
  scene.solver = "{iterations: 300, tolerance: 1.0e-6}";
  Simulator simulator = makePress(scene);
  pressSmooth(simulator, kDepth, 6);
  return simulator.wrench(0).force.z();
}

// Both errors of the mesh make it stiffer and go with the square of its cells: facets that may not cut the sphere (their
// corners lie deeper by a quarter of cell^2 / R, 2 % of the depth at 1.4 mm) and linear tetrahedra. 9 % are left at 1.4 mm
// cells; two meshes of the ratio 1.5 extrapolate to 5 % or less. A half space would be 14 to 17 % off.
TEST(LayerIndentation, ForceOfASphereOnABondedLayer) {
  constexpr double kRatio = 1.5;
  for (const double nu : {0.3, 0.45}) {
    const double expected = layerForce(1e4, nu);
    const double coarse = pressForce(1.0, nu);
    const double fine = pressForce(kRatio, nu);
    const double extrapolated = (kRatio * kRatio * fine - coarse) / (kRatio * kRatio - 1.0);
    std::cout << "nu " << nu << ": " << expected << " N; 2.2 mm cells " << 100.0 * (coarse / expected - 1.0)
              << " %, 1.4 mm " << 100.0 * (fine / expected - 1.0) << " %, extrapolated "
              << 100.0 * (extrapolated / expected - 1.0) << " %; half space "
              << 100.0 * (halfSpaceForce(1e4, nu) / expected - 1.0) << " %\n";
    EXPECT_GT(coarse, fine);
    EXPECT_GT(fine, expected);
    EXPECT_NEAR(fine, expected, 0.10 * expected);
    EXPECT_NEAR(extrapolated, expected, 0.05 * expected);
  }
}

}  // namespace
}  // namespace tissue_contact
