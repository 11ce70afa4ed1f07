#include "tissue_contact/instrument/collision_shape.h"

#include <gtest/gtest.h>

#include <limits>
#include <variant>

#include "instrument_fixture.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "unit/mesh/mesh_fixture.h"

namespace tissue_contact {
namespace collision_shape_test {

const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInfinity = std::numeric_limits<double>::infinity();

std::string refusalOf(const ShapeGeometry& geometry, const Pose& X_LS = Pose::Identity()) {
  return refusal([&] { makeCollisionShape({geometry, X_LS}); });
}

TEST(MakeCollisionShape, KeepsPrimitivesAsTheyAre) {
  const CollisionShape sphere = makeCollisionShape({SphereGeometry{0.005}, translation(1, 2, 3)});
  EXPECT_EQ(std::get<SphereGeometry>(sphere.geometry).radius_m, 0.005);
  expectSamePose(sphere.X_LS, translation(1, 2, 3), 0.0);
  EXPECT_EQ(sphere.mesh, nullptr);
  EXPECT_NO_THROW(makeCollisionShape({BoxGeometry{Vector3(1, 2, 3)}, Pose::Identity()}));
  EXPECT_NO_THROW(makeCollisionShape({CylinderGeometry{1, 2}, Pose::Identity()}));
}

TEST(MakeCollisionShape, ReadsMeshesWithTheirScale) {
  const TemporaryDirectory directory;
  const MeshGeometry geometry{directory.write("a.stl", binaryStl()), Vector3::Constant(0.1)};
  const CollisionShape shape = makeCollisionShape({geometry, Pose::Identity()});
  ASSERT_NE(shape.mesh, nullptr);
  EXPECT_NEAR(enclosedVolume(*shape.mesh), 1e-3, 1e-12);
}

TEST(MakeCollisionShape, RefusesBadSizes) {
  for (const double bad : {0.0, -0.01, kNan, kInfinity}) {
    SCOPED_TRACE(bad);
    expectContains(refusalOf(SphereGeometry{bad}), {"sphere radius", " m;", "finite and > 0"});
    expectContains(refusalOf(BoxGeometry{Vector3(1, bad, 1)}), {"box size y", "finite and > 0"});
    expectContains(refusalOf(CylinderGeometry{bad, 1}), {"cylinder radius", "finite and > 0"});
    expectContains(refusalOf(CylinderGeometry{1, bad}), {"cylinder length", "finite and > 0"});
  }
}

TEST(MakeCollisionShape, RefusesBadOrigins) {
  expectContains(refusalOf(SphereGeometry{1}, translation(0, kNan, 0)), {"origin", "not finite"});
  Pose X = Pose::Identity();
  X.linear() *= 2.0;
  expectContains(refusalOf(SphereGeometry{1}, X), {"origin", "rotation"});
  X.linear() = Vector3(1, 1, -1).asDiagonal();
  expectContains(refusalOf(SphereGeometry{1}, X), {"origin", "rotation"});
}

TEST(MakeCollisionShape, RefusesMeshesWithoutAPlace) {
  expectContains(refusalOf(MeshGeometry{"package://ghost/a.stl", Vector3::Ones()}),
                 {"package://ghost/a.stl", "ROS package \"ghost\"", "ROS_PACKAGE_PATH"});
  expectContains(refusalOf(MeshGeometry{"a.stl", Vector3::Ones()}), {"'a.stl'", "it is relative", "urdf"});
  expectContains(refusalOf(MeshGeometry{"http://host/a.stl", Vector3::Ones()}),
                 {"http://host/a.stl", "scheme \"http\""});
  expectContains(refusalOf(MeshGeometry{"/none/a.stl", Vector3::Ones()}), {"/none/a.stl", "does not exist"});
}

// Nothing tells which side of a sheet is inside, so a tool made of one would pull tissue from the wrong side.
TEST(MakeCollisionShape, RefusesOpenSheets) {
  const TemporaryDirectory directory;
  const std::string sheet = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
  expectContains(refusalOf(MeshGeometry{directory.write("sheet.obj", sheet), Vector3::Ones()}),
                 {"sheet.obj", "open sheet", "4 of its 6", "closed solid"});
}

}  // namespace collision_shape_test
}  // namespace tissue_contact
