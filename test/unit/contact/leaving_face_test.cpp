// Through which face tissue leaves a tool with edges: the one below where the surface runs under the tool, its side where that faces the surface.
#include "contact/leaving_face.h"

#include <gtest/gtest.h>

#include <cmath>

#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace leaving_face_test {

constexpr double kEdge = 0.002;  // m, of the cells
constexpr double kAbove = 1e-4;  // m, of the point above the lower face

/// @param normals of the triangles around the vertex.
SignedDistance leaveAt(const ShapeDistance& shape, const Vector3& p, const std::vector<Vector3>& normals,
                       double edge = kEdge) {
  const SignedDistance here = shape.at(p);
  VertexSurroundings around;
  for (const Vector3& normal : normals) {
    around.add(p, {p, p + edge * Vector3::UnitX(), p + 2.0 * edge * Vector3::UnitY()}, normal.normalized(),
               here.normal);
  }
  return leavingFace(shape, p, around, here);
}

SignedDistance leave(const ShapeDistance& shape, double x, double above, const std::vector<Vector3>& normals) {
  return leaveAt(shape, Vector3(x, 0.0, -0.002 + above), normals);
}

TEST(LeavingFace, AVertexBeforeTheSideIsLetUnderTheTool) {
  for (const EdgedTool& tool : edgedTools()) {
    EXPECT_TRUE(std::isinf(leave(*tool.shape, 0.00601, kAbove, {Vector3::UnitZ()}).distance)) << tool.name;
    EXPECT_TRUE(std::isinf(leave(*tool.shape, 0.00601, kAbove, {Vector3(-0.3, 0.1, 1.0)}).distance)) << tool.name;
  }
}

// The gap goes on from 0, where the vertex comes in at the side, to the depth.
TEST(LeavingFace, AVertexInsideTheSideIsPushedOutBelow) {
  for (const EdgedTool& tool : edgedTools()) {
    for (const double inside : {1e-9, 1e-6, 2e-5, 9e-5, 9.9e-5}) {
      const SignedDistance left = leave(*tool.shape, 0.006 - inside, kAbove, {Vector3(-0.1, 0.05, 1.0)});
      EXPECT_LT((left.normal + Vector3::UnitZ()).norm(), 1e-12) << tool.name << " " << inside;
      EXPECT_NEAR(left.distance, -inside, 1e-15) << tool.name << " " << inside;
    }
    const SignedDistance below = leave(*tool.shape, 0.005, kAbove, {Vector3(-0.1, 0.05, 1.0)});
    EXPECT_NEAR(below.distance, -kAbove, 1e-15) << tool.name;
  }
}

TEST(LeavingFace, AWallKeepsTheSideThatPushesIt) {
  const Vector3 up = Vector3::UnitZ();
  const Vector3 wall = -Vector3::UnitX();
  for (const EdgedTool& tool : edgedTools()) {
    for (const double x : {0.00601, 0.00599}) {
      // The last two: the rim of a block, with more triangles above than beside.
      for (const auto& normals :
           {std::vector<Vector3>{wall}, {Vector3(-1.0, 0.2, 0.5)}, {wall, up, up}, {up, up, up, wall, up}}) {
        const SignedDistance left = leave(*tool.shape, x, kAbove, normals);
        EXPECT_LT((left.normal - Vector3::UnitX()).norm(), 1e-12) << tool.name;
        EXPECT_NEAR(left.distance, x - 0.006, 1e-15) << tool.name;
      }
    }
  }
}

TEST(LeavingFace, AStepThatTheCellsCanShowIsOne) {
  for (const EdgedTool& tool : edgedTools()) {
    const SignedDistance left = leave(*tool.shape, 0.00599, 0.6 * kEdge, {Vector3::UnitZ()});
    EXPECT_LT((left.normal - Vector3::UnitX()).norm(), 1e-12) << tool.name;
  }
}

TEST(LeavingFace, BelowTheToolNothingChanges) {
  for (const EdgedTool& tool : edgedTools()) {
    const SignedDistance left = leave(*tool.shape, 0.003, 1e-5, {Vector3(-0.1, 0.05, 1.0)});
    EXPECT_LT((left.normal + Vector3::UnitZ()).norm(), 1e-12) << tool.name;
    EXPECT_NEAR(left.distance, -1e-5, 1e-15) << tool.name;
  }
}

class Beside : public ShapesBeside {
 public:
  explicit Beside(bool closes) : closes_(closes) {}
  bool closeWay(const Vector3& p_S, const Vector3& end_S, const Vector3& /*normal_S*/) const override {
    from_S = p_S;
    to_S = end_S;
    ++asked;
    return closes_;
  }

  mutable Vector3 from_S = Vector3::Zero();
  mutable Vector3 to_S = Vector3::Zero();
  mutable int asked = 0;

 private:
  const bool closes_;
};

// Only where another shape is near the way below, not where there is one at all.
TEST(LeavingFace, WhatClosesTheWayBelowKeepsTheSide) {
  for (const EdgedTool& tool : edgedTools()) {
    for (const double x : {0.00601, 0.00599}) {
      const Beside near(true);
      const Beside far(false);
      const auto left_by = [&](const Beside& beside, double above) {
        const Vector3 p(x, 0.0, -0.002 + above);
        const SignedDistance here = tool.shape->at(p);
        VertexSurroundings around;
        around.add(p, {p, p + kEdge * Vector3::UnitX(), p + kEdge * Vector3::UnitY()}, Vector3::UnitZ(), here.normal);
        return leavingFace(*tool.shape, p, around, here, &beside);
      };
      EXPECT_NEAR(left_by(near, kAbove).distance, x - 0.006, 1e-15) << tool.name;
      EXPECT_LT(left_by(far, kAbove).normal.z(), -0.99) << tool.name;
      for (const Beside* const beside : {&near, &far}) {
        EXPECT_EQ(beside->from_S.z(), -0.002 + kAbove) << tool.name;
        EXPECT_NEAR(beside->to_S.z(), -0.002, 1e-8) << tool.name;
      }
      left_by(far, 0.6 * kEdge);
      EXPECT_EQ(far.asked, 1) << tool.name << ": what stays anyway is not asked for";
    }
  }
}

// Where it is round the nearest point is the one that holds, however the surface lies.
TEST(LeavingFace, WhatIsRoundHasNoEdges) {
  const auto ball = makeSphereDistance(0.005);
  const auto rod = makeCylinderDistance(0.005, 0.02);
  for (const ShapeDistance* const shape : {ball.get(), rod.get()}) {
    for (int degrees = 0; degrees <= 90; ++degrees) {
      const double angle = degrees * M_PI / 180.0;
      for (const double out : {0.0052, 0.00499}) {
        const Vector3 p(out * std::sin(angle), -out * std::cos(angle), 0.0);
        const SignedDistance here = shape->at(p);
        const SignedDistance left = leaveAt(*shape, p, {Vector3::UnitY()}, 0.01);
        EXPECT_EQ(left.distance, here.distance) << degrees;
        EXPECT_EQ(left.normal, here.normal) << degrees;
      }
    }
  }
}

}  // namespace leaving_face_test
}  // namespace tissue_contact::contact_test
