// Exact signed distances, and the closest point of a triangle against a slow independent minimiser. Meshes:
// mesh_field_test.cpp.
#include <gtest/gtest.h>

#include <string>

#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace shape_distance_test {

struct NamedShape {
  std::string name;
  std::function<std::unique_ptr<ShapeDistance>()> make;
};

void PrintTo(const NamedShape& shape, std::ostream* os) { *os << shape.name; }

constexpr double kTolerance = 1.01e-6;  // of the size: the tie tolerance

class ConvexShape : public ::testing::TestWithParam<NamedShape> {
 protected:
  std::unique_ptr<ShapeDistance> shape_ = GetParam().make();
};

// Dimensions in metres, of instruments: tip, jaw, plate, shaft, disc.
INSTANTIATE_TEST_SUITE_P(All, ConvexShape,
                         ::testing::Values(NamedShape{"sphere", [] { return makeSphereDistance(0.005); }},
                                           NamedShape{"box",
                                                      [] {
                                                        return makeBoxDistance({0.01, 0.006, 0.004});
                                                      }},
                                           NamedShape{"plate",
                                                      [] {
                                                        return makeBoxDistance({0.01, 0.01, 0.001});
                                                      }},
                                           NamedShape{"cylinder", [] { return makeCylinderDistance(0.004, 0.01); }},
                                           NamedShape{"disc", [] { return makeCylinderDistance(0.008, 0.002); }}),
                         [](const auto& test) { return test.param.name; });

TEST_P(ConvexShape, NormalIsTheGradientOfTheDistance) {
  Random random(1);
  const double h = 1e-6 * shape_->size();
  int smooth = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3 p = random.vector(0.02);
    const SignedDistance here = shape_->at(p);
    ASSERT_NEAR(here.normal.norm(), 1.0, 1e-14);
    const double forward = (shape_->at(p + h * here.normal).distance - here.distance) / h;
    const double backward = (here.distance - shape_->at(p - h * here.normal).distance) / h;
    if (std::abs(forward - backward) > 1e-3) continue;  // on a ridge inside, where there is no gradient
    ++smooth;
    // Slope 1 along a unit vector of a function whose slope is nowhere above 1: that vector is the gradient.
    EXPECT_NEAR(forward, 1.0, 1e-5) << p.transpose();
  }
  EXPECT_GT(smooth, 1900);
}

TEST_P(ConvexShape, DistanceNeverChangesFasterThanTheWay) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Vector3 p = random.vector(0.02);
    const Vector3 q = p + random.number(0.0, 0.01) * random.direction();
    EXPECT_LE(std::abs(shape_->at(p).distance - shape_->at(q).distance), (p - q).norm() * (1.0 + 1e-12));
  }
}

TEST_P(ConvexShape, ClosestPointIsTheLowestOfTheTriangle) {
  Random random(3);
  int penetrating = 0;
  int separate = 0;
  for (int i = 0; i < 400; ++i) {
    const double size = random.number(0.001, 0.02);
    const Vector3 centre = random.vector(0.012);
    const TrianglePoints t(centre + random.vector(size), centre + random.vector(size), centre + random.vector(size));
    ClosestPoint closest;
    ASSERT_TRUE(shape_->closest(t, 1.0, closest));
    EXPECT_NEAR(closest.weights.sum(), 1.0, 1e-14);
    EXPECT_GE(closest.weights.minCoeff(), 0.0);
    EXPECT_EQ(closest.distance, shape_->at(t.pointAt(closest.weights)).distance);
    EXPECT_NEAR(closest.distance, bruteForceMinimum(*shape_, t), kTolerance * shape_->size()) << "triangle " << i;
    ++(closest.distance < 0.0 ? penetrating : separate);
  }
  EXPECT_GT(penetrating, 50);
  EXPECT_GT(separate, 50);
}

TEST_P(ConvexShape, ShallowContactFromEverySideIsExact) {
  Random random(4);
  for (int i = 0; i < 60; ++i) {
    // A triangle that grazes the shape: moved along its normal until it is 1e-6 of the size away or deep.
    const Vector3 n = random.direction();
    const Vector3 u = n.unitOrthogonal();
    const Vector3 v = n.cross(u);
    const auto triangleAt = [&](double offset) {
      const Vector3 o = offset * n;
      return TrianglePoints(o - 0.03 * u - 0.02 * v, o + 0.03 * u - 0.025 * v, o + 0.001 * u + 0.04 * v);
    };
    const double clear = 0.02;
    const double way = bruteForceMinimum(*shape_, triangleAt(clear));
    for (const double depth : {-1e-3, -1e-6, 1e-9, 1e-6, 1e-3}) {
      const TrianglePoints t = triangleAt(clear - way - depth * shape_->size());
      ClosestPoint closest;
      ASSERT_TRUE(shape_->closest(t, 1.0, closest));
      EXPECT_NEAR(closest.distance, bruteForceMinimum(*shape_, t), kTolerance * shape_->size()) << "depth " << depth;
    }
  }
}

TEST(ShapeDistance, SphereBoxAndCylinderInClosedForm) {
  const auto sphere = makeSphereDistance(2.0);
  EXPECT_DOUBLE_EQ(sphere->at({0.0, -3.0, 0.0}).distance, 1.0);
  EXPECT_EQ(sphere->at({0.0, -3.0, 0.0}).normal, Vector3(0.0, -1.0, 0.0));
  EXPECT_DOUBLE_EQ(sphere->at(Vector3::Zero()).distance, -2.0);

  const auto box = makeBoxDistance({1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(box->at({4.0, 6.0, 3.0}).distance, 5.0);
  EXPECT_TRUE(box->at({4.0, 6.0, 3.0}).normal.isApprox(Vector3(0.6, 0.8, 0.0), 1e-15));
  EXPECT_DOUBLE_EQ(box->at({0.0, -1.75, 0.0}).distance, -0.25);
  EXPECT_EQ(box->at({0.0, -1.75, 0.0}).normal, Vector3(0.0, -1.0, 0.0));

  const auto cylinder = makeCylinderDistance(1.0, 2.0);
  EXPECT_DOUBLE_EQ(cylinder->at({0.0, 4.0, -6.0}).distance, 5.0);
  EXPECT_TRUE(cylinder->at({0.0, 4.0, -6.0}).normal.isApprox(Vector3(0.0, 0.6, -0.8), 1e-15));
  EXPECT_DOUBLE_EQ(cylinder->at({0.3, 0.4, 1.75}).distance, -0.25);
  EXPECT_EQ(cylinder->at({0.3, 0.4, 1.75}).normal, Vector3::UnitZ());
  EXPECT_DOUBLE_EQ(cylinder->at({0.45, 0.6, 0.0}).distance, -0.25);
  EXPECT_TRUE(cylinder->at({0.45, 0.6, 0.0}).normal.isApprox(Vector3(0.6, 0.8, 0.0), 1e-15));
}

// All of the cap is as near, no edge of the triangle, and the middle of what is equally far along the axis lies beyond the cap.
TEST(ShapeDistance, ACapFindsALargeTriangleParallelToIt) {
  const auto cylinder = makeCylinderDistance(1.0, 2.0);
  for (const double z : {7.0, -7.0}) {
    const TrianglePoints t({-40.0, -2.0, z}, {5.0, -2.0, z}, {5.0, 4.0, z});
    ClosestPoint closest;
    ASSERT_TRUE(cylinder->closest(t, 5.01, closest));
    EXPECT_NEAR(closest.distance, 5.0, 1e-14);
    EXPECT_FALSE(cylinder->closest(t, 4.99, closest));
  }
}

TEST(ShapeDistance, NormalsArePerfectWhereTheGapIsRoundOff) {
  const std::unique_ptr<ShapeDistance> shapes[] = {makeBoxDistance({0.01, 0.006, 0.004}),
                                                   makeCylinderDistance(0.006, 0.004)};
  for (const auto& shape : shapes) {
    for (const double gap : {-1e-9, -1e-12, -1e-18, 0.0, 1e-18, 1e-12, 1e-9}) {
      const SignedDistance top = shape->at({0.0011, 0.0023, 0.004 + gap});
      EXPECT_LT((top.normal - Vector3::UnitZ()).norm(), 1e-15) << gap;
      EXPECT_NEAR(top.distance, gap, 1e-18);
    }
    // On an edge any direction between its faces will do, but it must be one of them and not noise.
    const SignedDistance edge = shape->at({0.0, 0.006 + 1e-19, 0.004 + 1e-19});
    EXPECT_NEAR(edge.normal.norm(), 1.0, 1e-15);
    EXPECT_GE(edge.normal.y(), 0.0);
    EXPECT_GE(edge.normal.z(), 0.0);
  }
}

TEST(ShapeDistance, RefusesUnusableMeshes) {
  TriangleMesh mesh;
  mesh.vertices = NodalVectors::Zero(3, 3);
  mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW(makeMeshDistance(mesh), std::invalid_argument);  // no area
  mesh.vertices = Matrix3::Identity();
  mesh.triangles = {{0, 1, 3}};
  EXPECT_THROW(makeMeshDistance(mesh), std::invalid_argument);  // no vertex 3
  CollisionShape shape;
  shape.geometry = MeshGeometry{"tip.stl", Vector3::Ones()};
  EXPECT_THROW(ShapeDistances({}).make(shape), std::invalid_argument);  // never loaded
}

// At the end of a ridge many normals of one side may come before the one of the other side.
TEST(GradientSet, KeepsTheMostDifferentHoweverManyThereAre) {
  GradientSet gradients;
  for (int i = 0; i < 20; ++i) gradients.add(Vector3(0.01 * std::cos(i), 0.01 * std::sin(i), 1.0).normalized());
  gradients.add(-Vector3::UnitZ());
  gradients.add(Vector3::UnitX());
  EXPECT_EQ(gradients.count(), GradientSet::kMost);
  EXPECT_LT(stationaryGradient(gradients, Matrix3::Identity()).norm(), 0.01);  // both sides are as near: no direction
  // Without a part along y, which most of the first have: the other two must have been kept.
  const Matrix3 along_xy = Vector3(1.0, 1.0, 0.0).asDiagonal();
  EXPECT_LT(Vector3(along_xy * stationaryGradient(gradients, along_xy)).norm(), 1e-12);
}

TEST(ShapeDistance, WorldBoxIsTight) {
  Random random(8);
  const std::unique_ptr<ShapeDistance> shapes[] = {makeSphereDistance(0.5), makeBoxDistance({0.5, 0.2, 0.1}),
                                                   makeCylinderDistance(0.3, 0.7)};
  for (const auto& shape : shapes) {
    for (int i = 0; i < 50; ++i) {
      const Matrix3 R_WS = random.pose(0.0).linear();
      const Vector3 half = shape->halfExtents(R_WS);
      for (int axis = 0; axis < 3; ++axis) {
        // A large triangle across the axis at the box's end just touches the shape.
        const Vector3 n = R_WS.transpose() * Vector3::Unit(axis);
        const Vector3 u = 20.0 * n.unitOrthogonal();
        const Vector3 v = n.cross(u);
        ClosestPoint closest;
        ASSERT_TRUE(shape->closest({half[axis] * n - u - v, half[axis] * n + u - v, half[axis] * n + v}, 1.0, closest));
        EXPECT_NEAR(closest.distance, 0.0, 1e-6 * shape->size());
      }
    }
  }
}

}  // namespace shape_distance_test
}  // namespace tissue_contact::contact_test
