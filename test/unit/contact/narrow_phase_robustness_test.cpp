// Contacts where detection is easily fooled: thin sheets, deep and inside, degenerate triangles; and what must not
// change them: unit of length, rigid motion, order of triangles.
#include <gtest/gtest.h>

#include <string>

#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace narrow_phase_robustness_test {

const Vector3 kBlock(0.1, 0.1, 0.03);
constexpr double kPi = 3.14159265358979323846;

struct NamedShape {
  std::string name;
  std::function<std::unique_ptr<ShapeDistance>(double)> make;  // of a size, m per unit
};

void PrintTo(const NamedShape& shape, std::ostream* os) { *os << shape.name; }

TriangleMesh scaled(TriangleMesh mesh, double scale) {
  mesh.vertices *= scale;
  return mesh;
}

class AnyShape : public ::testing::TestWithParam<NamedShape> {
 protected:
  std::unique_ptr<ShapeDistance> shape_ = GetParam().make(1.0);
};

class ExactShape : public AnyShape {};  // whose contacts are the same to round-off

const auto nameOf = [](const auto& test) { return test.param.name; };
const auto exactShapes() {
  return ::testing::Values(
      NamedShape{"sphere", [](double s) { return makeSphereDistance(0.005 * s); }},
      NamedShape{"box", [](double s) { return makeBoxDistance(s * Vector3(0.008, 0.005, 0.005)); }},
      NamedShape{"cylinder", [](double s) { return makeCylinderDistance(0.005 * s, 0.01 * s); }});
}
const auto meshes() {
  return ::testing::Values(
      NamedShape{"box_mesh",
                 [](double s) {
                   return makeMeshDistance(scaled(boxMesh({0.008, 0.005, 0.005}, 2), s));
                 }},
      NamedShape{"sphere_mesh", [](double s) { return makeMeshDistance(scaled(sphereMesh(0.005, 2), s)); }});
}
INSTANTIATE_TEST_SUITE_P(Exact, AnyShape, exactShapes(), nameOf);
INSTANTIATE_TEST_SUITE_P(Mesh, AnyShape, meshes(), nameOf);
INSTANTIATE_TEST_SUITE_P(Exact, ExactShape, exactShapes(), nameOf);

/// Shape poses that press, graze and penetrate the top of the block, its edges and corners included.
std::vector<Pose> pressingPoses(int count, unsigned seed) {
  std::vector<Pose> poses;
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    Pose X = at({random.number(-0.002, 0.102), random.number(-0.002, 0.102), random.number(0.033, 0.038)});
    X.rotate(Eigen::AngleAxisd(random.number(-3.0, 3.0), random.direction()));
    poses.push_back(X);
  }
  return poses;
}

TEST_P(ExactShape, UnitOfLengthDoesNotMatter) {
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  for (const double scale : {1000.0, 1e-3}) {
    const auto shape = GetParam().make(scale);
    Surface other = block;
    other.nodes *= scale;
    for (const Pose& X : pressingPoses(60, 30)) {
      Pose X_scaled = X;
      X_scaled.translation() *= scale;
      const auto contacts = findContacts(*shape_, X, block, 1e-3);
      const auto others = findContacts(*shape, X_scaled, other, 1e-3 * scale);
      ASSERT_EQ(contacts.size(), others.size());
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        EXPECT_EQ(contacts[i].feature, others[i].feature);
        EXPECT_EQ(contacts[i].corner, others[i].corner);
        EXPECT_NEAR(contacts[i].gap, others[i].gap / scale, 1e-9 * shape_->size());
        EXPECT_LT((contacts[i].normal_W - others[i].normal_W).norm(), 1e-5);
      }
    }
  }
}

TEST_P(ExactShape, RigidMotionMovesTheContactsAlong) {
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  Random random(31);
  for (const Pose& X : pressingPoses(60, 32)) {
    const Pose move = random.pose(0.5);
    Surface moved = block;
    moved.nodes = (move.linear() * block.nodes).colwise() + move.translation();
    const auto contacts = findContacts(*shape_, X, block, 1e-3);
    const auto others = findContacts(*shape_, move * X, moved, 1e-3);
    ASSERT_EQ(contacts.size(), others.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts[i].feature, others[i].feature);
      EXPECT_EQ(contacts[i].corner, others[i].corner);
      EXPECT_NEAR(contacts[i].gap, others[i].gap, 1e-8 * shape_->size());
      EXPECT_LT((move.linear() * contacts[i].normal_W - others[i].normal_W).norm(), 1e-5);
    }
  }
}

/// The search over a triangle ends within a hundredth of the grid's spacing, here 0.15 mm; a gap is that over the length
/// of the gradient.
TEST(NarrowPhase, UnitAndMotionLeaveTheDepthOfAMesh) {
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  const auto least = [](const std::vector<ShapeContact>& contacts) {
    double gap = 1e-3;
    for (const ShapeContact& c : contacts) gap = std::min(gap, c.gap);
    return gap;
  };
  constexpr double kScale = 1e-3;
  const TriangleMesh mesh = boxMesh({0.008, 0.005, 0.005}, 2);
  const auto shape = makeMeshDistance(mesh);
  const auto small = makeMeshDistance(scaled(mesh, kScale));
  Surface other = block;
  other.nodes *= kScale;
  Random random(31);
  for (const Pose& X : pressingPoses(60, 32)) {
    const Pose move = random.pose(0.5);
    Surface moved = block;
    moved.nodes = (move.linear() * block.nodes).colwise() + move.translation();
    Pose X_scaled = X;
    X_scaled.translation() *= kScale;
    const double gap = least(findContacts(*shape, X, block, 1e-3));
    if (gap < -5e-4) continue;  // deeper than any step leaves it, where the way out is ambiguous
    EXPECT_NEAR(least(findContacts(*shape, move * X, moved, 1e-3)), gap, 1e-5);
    EXPECT_NEAR(std::min(1e-3, least(findContacts(*small, X_scaled, other, 1e-3 * kScale)) / kScale), gap, 1e-5);
  }
}

TEST_P(ExactShape, OrderOfTrianglesDoesNotMatter) {
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  Surface reversed = block;
  std::reverse(reversed.triangles.begin(), reversed.triangles.end());
  for (Triangle& t : reversed.triangles) t = {t[1], t[2], t[0]};
  for (const Pose& X : pressingPoses(60, 33)) {
    const auto contacts = findContacts(*shape_, X, block, 1e-3);
    const auto others = findContacts(*shape_, X, reversed, 1e-3);
    ASSERT_EQ(contacts.size(), others.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts[i].feature, others[i].feature);
      EXPECT_NEAR(contacts[i].gap, others[i].gap, 1e-8 * shape_->size());
      EXPECT_LT((pointOf(contacts[i], block.nodes) - pointOf(others[i], block.nodes)).norm(), 1e-7);
    }
  }
}

TEST_P(AnyShape, ThinSheetPressedFromAboveIsNeverPulledUp) {
  const Surface sheet = boxSurface({0.1, 0.1, 0.0005}, {20, 20, 1});
  const double top = 0.0005 + 0.005;
  for (const double depth : {0.0, 1e-4, 4e-4, 1e-3, 2e-3}) {
    // In the middle and over the rim.
    for (const double x : {0.0511, 0.0012}) {
      Pose X = at({x, 0.0487, top - depth});
      if (GetParam().name == "cylinder") X.rotate(Eigen::AngleAxisd(kPi / 2.0, Vector3::UnitY()));
      const auto contacts = findContacts(*shape_, X, sheet, 1e-3);
      ASSERT_FALSE(contacts.empty());
      int from_above = 0;
      for (const ShapeContact& c : contacts) {
        EXPECT_LT(c.normal_W.z(), 0.2) << "depth " << depth << " at " << pointOf(c, sheet.nodes).transpose();
        from_above += c.normal_W.z() < -0.9;
        const bool lower_face = pointOf(c, sheet.nodes).z() == 0.0 && c.feature[2] >= 0;
        EXPECT_FALSE(lower_face);
      }
      EXPECT_GT(from_above, 0);
    }
  }
}

TEST_P(AnyShape, ShapeInsideTheTissueTouchesNothing) {
  const Surface block = boxSurface({0.1, 0.1, 0.1}, {10, 10, 10});
  for (const double z : {0.05, 0.08, 0.0935}) {
    EXPECT_TRUE(findContacts(*shape_, at({0.052, 0.047, z}), block, 1e-3).empty()) << z;
  }
}

TEST_P(AnyShape, MiddleBelowTheSurfaceNeverPushesOutward) {
  const Surface block = boxSurface({0.1, 0.1, 0.1}, {10, 10, 10});
  for (const double depth : {1e-4, 1e-3, 3e-3}) {
    for (const ShapeContact& c : findContacts(*shape_, at({0.052, 0.047, 0.1 - depth}), block, 1e-3)) {
      EXPECT_LT(c.normal_W.z(), 0.2);
    }
  }
}

/// Pressed 4 and 8 mm deep, the surface wrapped around the sphere as a solved step leaves it, slightly penetrating.
TEST(NarrowPhase, DeepDentKeepsAllItsContacts) {
  const double radius = 0.005;
  for (const double depth : {0.004, 0.008}) {
    Surface block = boxSurface(kBlock, {50, 50, 3});
    const Vector3 centre(0.0507, 0.0493, 0.03 + radius - depth);
    int wrapped = 0;
    for (Eigen::Index i = 0; i < block.nodes.cols(); ++i) {
      Vector3 p = block.nodes.col(i);
      if (p.z() < 0.03) continue;
      const double r = (p - centre).head<2>().norm();
      // A dent with the sphere's lower half at its bottom and a steep funnel above it.
      const double in_funnel = std::max(0.0, depth - radius) + radius;
      if (r < radius) {
        p.z() = centre.z() - std::sqrt(radius * radius - r * r) + 1e-6;
        ++wrapped;
      } else if (r < 2.0 * radius) {
        p.z() = 0.03 - std::min(in_funnel, depth) * std::pow(2.0 - r / radius, 2);
      }
      block.nodes.col(i) = p;
    }
    ASSERT_GT(wrapped, 15);
    const auto contacts = findContacts(*makeSphereDistance(radius), at(centre), block, 1e-3);
    EXPECT_GE(static_cast<int>(contacts.size()), wrapped);
    for (const ShapeContact& c : contacts) {
      const Vector3 p = pointOf(c, block.nodes);
      const double plain = (p - centre).norm() - radius;
      if (c.feature[1] < 0) {
        EXPECT_NEAR(c.gap, plain, 1e-15);
        EXPECT_LT(c.lean_W.norm(), 0.25) << "the most that nodal_normal.h makes of what a vertex stands for";
      } else {
        EXPECT_GE(c.gap, plain - 1e-15);  // eased: the sphere is smooth compared with 2 mm cells
        EXPECT_TRUE(c.lean_W.isZero(0.0));
      }
      EXPECT_LT((c.normal_W - c.lean_W - (p - centre).normalized()).norm(), 1e-9);
    }
  }
}

TEST(NarrowPhase, SphereAtTheEdgeOfTheBlockPushesTheEdgeAway) {
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  const Vector3 edge(0.1, 0.0537, 0.03);
  const auto contacts =
      findContacts(*makeSphereDistance(0.005), at(edge + 0.0049 * Vector3(1.0, 0.0, 1.0).normalized()), block, 1e-5);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].feature[2], -1);
  EXPECT_GE(contacts[0].feature[1], 0);
  EXPECT_NEAR(contacts[0].gap, -1e-4, 1e-15);
  EXPECT_LT((contacts[0].normal_W - Vector3(-1.0, 0.0, -1.0).normalized()).norm(), 1e-12);
}

TEST_P(AnyShape, DegenerateTrianglesGiveFiniteContactsOrNone) {
  Random random(34);
  for (int trial = 0; trial < 40; ++trial) {
    Surface block = boxSurface(kBlock, {10, 10, 3});
    for (Eigen::Index i = 0; i < block.nodes.cols(); ++i) {
      const int kind = static_cast<int>(random.number(0.0, 6.0));
      if (kind == 0) block.nodes.col(i) = Vector3(0.05, 0.05, 0.03);                      // many in one point
      if (kind == 1) block.nodes.col(i).y() = 0.05;                                       // slivers
      if (kind == 2) block.nodes.col(i) = block.nodes.col((i + 1) % block.nodes.cols());  // collapsed edges
      if (kind == 3) block.nodes.col(i).z() = 0.03 - 1e-12 * random.number(0.0, 1.0);     // folded flat
    }
    for (const Pose& X : pressingPoses(5, 35 + trial)) {
      for (const ShapeContact& c : findContacts(*shape_, X, block, 1e-3)) {
        EXPECT_TRUE(std::isfinite(c.gap));
        EXPECT_NEAR(c.normal_W.norm(), 1.0, 1e-9);
        EXPECT_NEAR(c.weights.sum(), 1.0, 1e-9);
        EXPECT_GE(c.weights.minCoeff(), 0.0);
      }
    }
    const auto middle = findContacts(*shape_, at({0.05, 0.05, 0.0345}), block, 1e-3);
    for (const ShapeContact& c : middle) EXPECT_NEAR(c.normal_W.norm(), 1.0, 1e-9);
  }
}

TEST_P(AnyShape, NonFiniteNodesGiveNoContact) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Surface block = boxSurface(kBlock, {4, 4, 2});
    block.nodes.setConstant(bad);
    EXPECT_TRUE(findContacts(*shape_, at({0.05, 0.05, 0.034}), block, 1e-3).empty());
    block = boxSurface(kBlock, {4, 4, 2});
    for (Eigen::Index i = 0; i < block.nodes.cols(); i += 3) block.nodes.col(i).setConstant(bad);
    for (const ShapeContact& c : findContacts(*shape_, at({0.05, 0.05, 0.034}), block, 1e-3)) {
      EXPECT_TRUE(std::isfinite(c.gap) && c.normal_W.allFinite());
    }
  }
}

TEST_P(AnyShape, FixedFeaturesAreLeftOut) {
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  std::vector<bool> fixed(block.nodes.cols());
  for (Eigen::Index i = 0; i < block.nodes.cols(); ++i) fixed[i] = block.nodes(0, i) < 0.051;
  int left_out = 0;
  for (const Pose& X : pressingPoses(60, 36)) {
    const std::vector<ShapeContact> contacts = findContacts(*shape_, X, block, 1e-3, fixed);
    for (const ShapeContact& c : contacts) {
      bool moves = false;
      for (int i = 0; i < 3; ++i) moves |= c.weights[i] > 0.0 && !fixed[c.nodes[i]];
      EXPECT_TRUE(moves);
    }
    left_out += static_cast<int>(findContacts(*shape_, X, block, 1e-3).size()) > static_cast<int>(contacts.size());
  }
  EXPECT_GT(left_out, 5);
}

/// An L-shaped jaw: the search for its closest point may miss the best point but must give a real one.
TEST(NarrowPhase, NotConvexMeshTouchesWhereItShould) {
  TriangleMesh jaw = boxMesh({0.01, 0.002, 0.002}, 1);
  append(jaw, boxMesh({0.002, 0.002, 0.002}, 1), {0.008, 0.0, -0.004});
  const auto shape = makeMeshDistance(jaw);
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  const auto contacts = findContacts(*shape, at({0.0503, 0.0497, 0.036 - 1e-4}), block, 2e-4);
  ASSERT_FALSE(contacts.empty());
  for (const ShapeContact& c : contacts) {
    EXPECT_NEAR(c.gap, -1e-4, 2e-5);  // the tooth's lower face, not the jaw 4 mm above; a tenth of the grid's spacing
    EXPECT_LT((c.normal_W + Vector3::UnitZ()).norm(), 0.1);
    EXPECT_GT(pointOf(c, block.nodes).x(), 0.0503 + 0.006 - 1e-9);
  }
}

}  // namespace narrow_phase_robustness_test
}  // namespace tissue_contact::contact_test
