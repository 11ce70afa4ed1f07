// How a mesh lies in its file, and parts of it that fall between the samples.
#include "contact/shape/grid_axes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "contact/shape/field_distance.h"
#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace grid_axes_test {

TriangleMesh boxBetween(const Vector3& low, const Vector3& high) {
  TriangleMesh box = boxMesh(0.5 * (high - low), 1);
  box.vertices.colwise() += 0.5 * (low + high);
  return box;
}

/// A blade, 8 mm wide and 12 mm long, at the end of a shaft of 8 x 8 x 400 mm.
TriangleMesh bladeOnShaft(double thickness_m) {
  TriangleMesh tool = boxBetween({-0.004, -0.5 * thickness_m, 0.0}, {0.004, 0.5 * thickness_m, 0.012});
  append(tool, boxBetween({-0.004, -0.004, 0.011}, {0.004, 0.004, 0.411}), Vector3::Zero());
  return tool;
}

Matrix3 turn() { return Eigen::AngleAxisd(0.87, Vector3(1.0, 1.0, 0.0).normalized()).toRotationMatrix(); }

TriangleMesh turned(TriangleMesh mesh) {
  mesh.vertices = NodalVectors(turn() * mesh.vertices);
  return mesh;
}

std::shared_ptr<const MeshField> fieldOf(const TriangleMesh& mesh, std::string* said = nullptr) {
  MeshPreparation preparation;
  if (said != nullptr) preparation.say = [said](const std::string& line) { *said += line + "\n"; };
  return prepareMeshField(mesh, "tool.stl", preparation);
}

TEST(GridAxes, AreTheFilesWhereOthersSaveLittle) {
  EXPECT_TRUE(gridAxes(bladeOnShaft(0.001)).isIdentity(0.0));
  EXPECT_TRUE(gridAxes(boxMesh({0.01, 0.006, 0.004}, 2)).isIdentity(0.0));
  EXPECT_TRUE(gridAxes(sphereMesh(0.005, 2)).isIdentity(0.0));
  EXPECT_TRUE(gridAxes(turned(boxMesh({0.01, 0.01, 0.0095}, 2))).isUnitary(1e-12));
}

// Along the file's axes samples were 3.36 mm apart, not 0.461, and nothing was left of the blade: its middle lay 0.82 mm
// outside. Such a tool pressed tissue with no force, where it was to be 0.16 N.
TEST(GridAxes, AMeshTurnedInItsFileActsAsBefore) {
  const auto straight = fieldOf(bladeOnShaft(0.001));
  const auto across = fieldOf(turned(bladeOnShaft(0.001)));
  EXPECT_NEAR(across->grid.spacing, straight->grid.spacing, 0.02 * straight->grid.spacing);
  const FieldDistance one(straight);
  const FieldDistance other(across);
  EXPECT_LT(other.at(turn() * Vector3(0.0, 0.0, 0.005)).distance, -0.0003);
  Random random(7);
  for (int i = 0; i < 500; ++i) {
    const Vector3 p(random.number(-0.006, 0.006), random.number(-0.006, 0.006), random.number(-0.002, 0.02));
    EXPECT_NEAR(other.at(turn() * p).distance, one.at(p).distance, 0.5 * straight->grid.spacing);
    const TrianglePoints triangle(p, p + random.vector(0.002), p + random.vector(0.002));
    const auto turnedPoint = [&](int k) { return Vector3(turn() * triangle.corners[k]); };
    ClosestPoint here;
    ClosestPoint there;
    const TrianglePoints turned_triangle(turnedPoint(0), turnedPoint(1), turnedPoint(2));
    if (!one.closest(triangle, 1.0, here) || !other.closest(turned_triangle, 1.0, there)) continue;
    EXPECT_NEAR(there.distance, here.distance, 0.5 * straight->grid.spacing);
    const Vector3 at = turned_triangle.pointAt(there.weights);
    EXPECT_NEAR(there.distance, other.at(at).distance, 1e-12);
    ASSERT_GT(there.gradients.count(), 0);
    if (there.gradients.count() == 1) {
      EXPECT_GT(there.gradients[0].normalized().dot(other.at(at).normal), 0.999);
    }
  }
  EXPECT_NEAR((other.boxCentre() - turn() * one.boxCentre()).norm(), 0.0, 1e-4);
  EXPECT_NEAR((other.halfExtents(turn().transpose()) - one.halfExtents(Matrix3::Identity())).norm(), 0.0, 1e-4);
  for (int v = 0; v < other.drawn()->vertices.cols(); ++v) {
    EXPECT_NEAR(other.at(other.drawn()->vertices.col(v)).distance, 0.0, 0.002)  // cells of 4 mm
        << v;
  }
}

// Less than a fifth of its surface: nothing was said, and "off the mesh by" a fraction of a millimetre.
TEST(ThinParts, ABladeThatIsLostIsToldWithItsPlaceAndThickness) {
  std::string said;
  const auto field = fieldOf(bladeOnShaft(0.0002), &said);
  EXPECT_NE(said.find("together, around ("), std::string::npos) << said;
  EXPECT_NE(said.find("where it is 0.2 mm thick"), std::string::npos) << said;
  EXPECT_NE(said.find("as shapes of their own"), std::string::npos) << said;
  EXPECT_GT(field->largest_deviation, 0.007) << "from the tip of the blade to the shaft";
  said.clear();
  fieldOf(bladeOnShaft(0.002), &said);
  EXPECT_EQ(said.find("less than about"), std::string::npos) << said;
}

}  // namespace grid_axes_test
}  // namespace tissue_contact::contact_test
