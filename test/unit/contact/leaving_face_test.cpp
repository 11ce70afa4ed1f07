// Through which face tissue leaves a tool with edges: the one below where the surface runs under the tool, its side where that faces the surface.
#include "contact/leaving_face.h"

#include <gtest/gtest.h>

#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace {

constexpr double kEdge = 0.002;  // m, of the cells
constexpr double kAbove = 1e-4;  // m, of the point above the lower face

struct Tool {
  const char* name;
  std::unique_ptr<ShapeDistance> shape;
};

/// Each ends at x = .006 and z = -.002.
std::vector<Tool> tools() {
  std::vector<Tool> all;
  all.push_back({"box", makeBoxDistance({0.006, 0.004, 0.002})});
  all.push_back({"cylinder", makeCylinderDistance(0.006, 0.002)});
  return all;
}

SignedDistance leave(const ShapeDistance& shape, double x, double above, const Vector3& outward, double edge = kEdge) {
  const Vector3 p(x, 0.0, -0.002 + above);
  return leavingFace(shape, p, outward.normalized(), edge, shape.at(p));
}

TEST(LeavingFace, AVertexBeforeTheSideIsLetUnderTheTool) {
  for (const Tool& tool : tools()) {
    EXPECT_TRUE(std::isinf(leave(*tool.shape, 0.00601, kAbove, Vector3::UnitZ()).distance)) << tool.name;
    EXPECT_TRUE(std::isinf(leave(*tool.shape, 0.00601, kAbove, Vector3(-0.3, 0.1, 1.0)).distance)) << tool.name;
  }
}

TEST(LeavingFace, AVertexJustInsideTheSideIsPushedOutBelow) {
  for (const Tool& tool : tools()) {
    for (const double inside : {1e-9, 1e-6, 2e-5}) {
      const SignedDistance left = leave(*tool.shape, 0.006 - inside, kAbove, Vector3(-0.1, 0.05, 1.0));
      EXPECT_LT((left.normal + Vector3::UnitZ()).norm(), 1e-12) << tool.name << " " << inside;
      EXPECT_NEAR(left.distance, -kAbove, 1e-8) << tool.name << " " << inside;  // half an edge by 2^-20
    }
  }
}

TEST(LeavingFace, AWallKeepsTheSideThatPushesIt) {
  for (const Tool& tool : tools()) {
    for (const double x : {0.00601, 0.00599}) {
      for (const Vector3& outward : {Vector3(-1, 0, 0), Vector3(-1, 0.2, 0.5)}) {
        const SignedDistance left = leave(*tool.shape, x, kAbove, outward);
        EXPECT_LT((left.normal - Vector3::UnitX()).norm(), 1e-12) << tool.name;
        EXPECT_NEAR(left.distance, x - 0.006, 1e-15) << tool.name;
      }
    }
  }
}

TEST(LeavingFace, AStepThatTheCellsCanShowIsOne) {
  for (const Tool& tool : tools()) {
    const SignedDistance left = leave(*tool.shape, 0.00599, 0.6 * kEdge, Vector3::UnitZ());
    EXPECT_LT((left.normal - Vector3::UnitX()).norm(), 1e-12) << tool.name;
  }
}

TEST(LeavingFace, BelowTheToolNothingChanges) {
  for (const Tool& tool : tools()) {
    const SignedDistance left = leave(*tool.shape, 0.003, 1e-5, Vector3(-0.1, 0.05, 1.0));
    EXPECT_LT((left.normal + Vector3::UnitZ()).norm(), 1e-12) << tool.name;
    EXPECT_NEAR(left.distance, -1e-5, 1e-15) << tool.name;
  }
}

TEST(LeavingFace, ABallHasNoEdges) {
  const auto ball = makeSphereDistance(0.006);
  const Vector3 p(0.00599, 0.0, 0.0);
  EXPECT_EQ(leavingFace(*ball, p, Vector3::UnitZ(), kEdge, ball->at(p)).normal, Vector3::UnitX());
}

}  // namespace
}  // namespace tissue_contact::contact_test
