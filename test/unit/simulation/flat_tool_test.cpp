// A flat tool with sharp edges slides over cells that are far larger than it is deep: tangential over normal force is the coefficient of
// friction, since all of its load goes through its flat face. Before leaving_face.h its side pushed nodes ahead: .5 to 1.3 in the middle of the drag, 2.7 at most.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "support/text_scene.h"

namespace tissue_contact {
namespace flat_tool_test {

constexpr double kMu = 0.4;
constexpr double kStep = 0.01;  // s

Simulator makeTool(const std::string& shape) {
  return makeSimulator(
      "tissues:\n  - name: layer\n    block: {size_m: [0.030, 0.024, 0.003], cells: [15, 12, 2]}\n"
      "    pose: {position_m: [0, 0, -0.003]}\n"
      "    material: {model: neo_hookean, dilatation: patch, youngs_modulus_pa: 10000, poissons_ratio: 0.45,"
      " density_kg_per_m3: 1000}\n"
      "    damping: {stiffness_s: 0.01}\n"
      "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
      "instruments:\n  - name: tool\n    robot_description: probe\n    tip_link: tip\n"
      "    joint_state_topics: [/joint_states]\n    base_pose: {position_m: [-0.003, 0, 0.002]}\n"
      "    contact_links: [{link: tip, shapes: [{" +
          shape +
          "}]}]\n"
          "friction:\n  - {instrument: tool, tissue: layer, static: 0.55, kinetic: 0.4}\n"
          "step: {max_step_s: 0.01}\n",
      {{"probe", probeUrdf(0.005)}});
}

/// Tangential over normal force of each step of a drag of 6 mm at 2 mm/s, after the first 2 mm.
std::vector<double> drag(const std::string& shape, double depth) {
  Simulator simulator = makeTool(shape);
  for (int k = 1; k <= 40; ++k) simulator.advance(kStep, {Vector3(0.0, 0.0, -depth * std::min(1.0, k / 20.0))});
  std::vector<double> ratios;
  for (int k = 1; k <= 300; ++k) {
    simulator.advance(kStep, {Vector3(2e-5 * k, 0.0, -depth)});
    const Vector3 force = simulator.wrench(0).force;
    if (k > 100) ratios.push_back(force.head<2>().norm() / force.z());
  }
  std::sort(ratios.begin(), ratios.end());
  return ratios;
}

/// The box of 12 x 8 x 4 mm as a file.
std::string boxMesh() {
  const std::string file = testing::TempDir() + "flat_tool_test.stl";
  std::ofstream stream(file);
  stream << "solid box\n";
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vector3 corners[4];  // of a face, outwards: around the axis of its side
      for (int k = 0; k < 4; ++k) {
        corners[k][axis] = side;
        corners[k][(axis + 1) % 3] = k == 0 || k == 3 ? -side : side;
        corners[k][(axis + 2) % 3] = k < 2 ? -1.0 : 1.0;
        corners[k] = corners[k].cwiseProduct(Vector3(0.006, 0.004, 0.002)).eval();
      }
      for (const auto& triangle : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
        stream << "facet normal 0 0 0\nouter loop\n";
        for (const int k : triangle) stream << "vertex " << corners[k].transpose() << "\n";
        stream << "endloop\nendfacet\n";
      }
    }
  }
  stream << "endsolid box\n";
  return "mesh: {file: " + file + "}";
}

class FlatTool : public testing::TestWithParam<const char*> {};

// At a tenth of a cell the tissue before the edge rises by some of the depth, which the tool really pushes: found .43 for .4 mm, .53 to .55 at most. Which vertices
// the edge catches hangs on round-off: of depths 1e-9 of themselves apart one in six gives .46 or .47.
TEST_P(FlatTool, SlidesByItsFriction) {
  for (const double depth : {1e-4, 2e-4, 4e-4}) {
    const std::vector<double> ratios = drag(GetParam(), depth);
    EXPECT_NEAR(ratios[ratios.size() / 2], kMu, (depth < 3e-4 ? 0.05 : 0.2) * kMu) << depth;
    EXPECT_LT(ratios.back(), 1.5 * kMu) << depth;
  }
}

// Of a mesh points of faces and edges, not vertices alone, still meet the side: found .40, .66, .57; before 2.7, 2.2, 1.0.
TEST(FlatMesh, IsHeldLessByItsSides) {
  for (const double depth : {1e-4, 2e-4, 4e-4}) {
    const std::vector<double> ratios = drag(boxMesh(), depth);
    EXPECT_LT(ratios[ratios.size() / 2], 2.0 * kMu) << depth;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, FlatTool,
                         testing::Values("cylinder: {radius_m: 0.006, length_m: 0.004}",
                                         "box: {size_m: [0.012, 0.008, 0.004]}"));

// What is far from its lower face: with a shaft on top or above it the box had .47 (1.22 at most), .52 (.84), .47 (.61), as a box in two
// layers .70; now the same as without.
INSTANTIATE_TEST_SUITE_P(WithMoreShapes, FlatTool,
                         testing::Values("box: {size_m: [0.012, 0.008, 0.004]}}, {cylinder: {radius_m: 0.002, "
                                         "length_m: 0.04}, pose: {position_m: [0, 0, 0.022]}",
                                         "box: {size_m: [0.012, 0.008, 0.002]}, pose: {position_m: [0, 0, -0.001]}}, "
                                         "{box: {size_m: [0.012, 0.008, 0.002]}, pose: {position_m: [0, 0, 0.001]}"));

}  // namespace flat_tool_test
}  // namespace tissue_contact
