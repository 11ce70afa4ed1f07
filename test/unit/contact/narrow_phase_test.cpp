// Contacts of one shape with one surface: merging, normals, flush faces, invariances.
#include <gtest/gtest.h>

#include <string>

#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace narrow_phase_test {

const Vector3 kBlock(0.1, 0.1, 0.03);
constexpr double kPi = 3.14159265358979323846;

bool isFace(const ShapeContact& c) { return c.feature[2] >= 0; }
bool isVertex(const ShapeContact& c) { return c.feature[1] < 0; }

const ShapeContact& nearest(const std::vector<ShapeContact>& contacts) {
  return *std::min_element(contacts.begin(), contacts.end(), [](auto& a, auto& b) { return a.gap < b.gap; });
}

std::vector<Vector3> sampleDirections() {
  std::vector<Vector3> directions;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) directions.push_back(Vector3(x, y, z).normalized());
      }
    }
  }
  Random random(20);
  for (int i = 0; i < 20; ++i) directions.push_back(random.direction());
  return directions;
}

TEST(NarrowPhase, SphereOnAFaceAnEdgeAndAVertex) {
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  const auto sphere = makeSphereDistance(0.005);
  const double height = 0.03 + 0.005 - 1e-4;

  const auto face = findContacts(*sphere, at({0.0533, 0.0482, height}), block, 1e-5);
  ASSERT_EQ(face.size(), 1u);
  EXPECT_TRUE(isFace(face[0]));
  EXPECT_NEAR(face[0].gap, -1e-4, 1e-16);
  EXPECT_LT((pointOf(face[0], block.nodes) - Vector3(0.0533, 0.0482, 0.03)).norm(), 1e-15);

  // Over the middle of a cell's side and of its diagonal, which two triangles share; over a node, which six or so
  // share.
  for (const Vector3& over : {Vector3(0.05, 0.045, 0.03), Vector3(0.055, 0.055, 0.03), Vector3(0.05, 0.05, 0.03)}) {
    const auto contacts = findContacts(*sphere, at({over.x(), over.y(), height}), block, 1e-5);
    ASSERT_EQ(contacts.size(), 1u) << over.transpose();
    EXPECT_EQ(isVertex(contacts[0]), over.y() == 0.05);
    EXPECT_NEAR(contacts[0].gap, -1e-4, 1e-16);
    EXPECT_LT((contacts[0].normal_W + Vector3::UnitZ()).norm(), 1e-12);
    EXPECT_LT((pointOf(contacts[0], block.nodes) - over).norm(), 1e-15);
    EXPECT_NEAR(contacts[0].weights.sum(), 1.0, 1e-15);
    // `nodes` is the first triangle that holds the feature.
    for (const Triangle& t : block.triangles) {
      std::ptrdiff_t held = 0;
      for (const int node : t) held += std::count(contacts[0].feature.begin(), contacts[0].feature.end(), node);
      if (held != (isVertex(contacts[0]) ? 1 : 2)) continue;
      EXPECT_EQ(contacts[0].nodes, t);
      break;
    }
  }
}

TEST(NarrowPhase, FeaturesAreSortedAndUnique) {
  const Surface block = boxSurface(kBlock, {20, 20, 6});
  const std::unique_ptr<ShapeDistance> shapes[] = {makeSphereDistance(0.02), makeBoxDistance({0.02, 0.01, 0.01}),
                                                   makeCylinderDistance(0.01, 0.03),
                                                   makeMeshDistance(sphereMesh(0.02, 2))};
  Random random(21);
  for (const auto& shape : shapes) {
    for (int i = 0; i < 20; ++i) {
      Pose X = at({0.05, 0.05, 0.03 + 0.9 * shape->size()});
      X.rotate(Eigen::AngleAxisd(random.number(-3.0, 3.0), random.direction()));
      const auto contacts = findContacts(*shape, X, block, 2e-3);
      ASSERT_GT(contacts.size(), 1u);
      for (std::size_t k = 0; k < contacts.size(); ++k) {
        const ShapeContact& c = contacts[k];
        EXPECT_NEAR(c.normal_W.norm(), 1.0, 1e-14);
        EXPECT_LE(c.gap, 2e-3);
        if (k == 0) continue;
        const ShapeContact& previous = contacts[k - 1];
        EXPECT_LT(std::tie(previous.feature, previous.corner), std::tie(c.feature, c.corner));
      }
    }
  }
}

/// A surface whose flat top looks along `normal`, and a shape touching it with a flat or round side: normals must be
/// perfect and gaps exact however small.
TEST(NarrowPhase, NormalsArePerfectInEveryDirectionDownToZeroGap) {
  struct Case {
    std::unique_ptr<ShapeDistance> shape;
    double height;
  };
  Case cases[] = {{makeSphereDistance(0.005), 0.005},
                  {makeBoxDistance({0.012, 0.009, 0.004}), 0.004},
                  {makeCylinderDistance(0.012, 0.004), 0.004}};
  for (const Vector3& direction : sampleDirections()) {
    const Matrix3 R = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), direction).toRotationMatrix();
    Surface block = boxSurface(kBlock, {10, 10, 3});
    block.nodes = R * block.nodes;
    for (const Case& c : cases) {
      for (const double gap : {1e-4, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-4}) {
        Pose X = Pose::Identity();
        X.linear() = R;
        X.translation() = R * Vector3(0.0533, 0.0482, 0.03 + c.height + gap);
        const auto contacts = findContacts(*c.shape, X, block, 2e-4);
        ASSERT_FALSE(contacts.empty()) << direction.transpose() << " gap " << gap;
        EXPECT_NEAR(nearest(contacts).gap, gap, 5e-17);
        for (const ShapeContact& contact : contacts) {
          if (contact.gap > gap + 1e-16) continue;  // a round shape beside its lowest point
          EXPECT_LT((contact.normal_W + direction).norm(), 1e-12) << "gap " << gap;
        }
      }
    }
  }
}

TEST(NarrowPhase, FlushBoxHasVertexAndCornerContactsOnlyAlwaysTheSame) {
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  const auto box = makeBoxDistance({0.0123, 0.0117, 0.004});
  std::vector<std::pair<SurfaceFeature, int>> expected;
  Random random(22);
  for (int i = 0; i < 30; ++i) {
    Pose X = at({0.0533, 0.0482, 0.034 + random.number(-1e-7, 1e-7)});
    X.rotate(Eigen::AngleAxisd(1e-7, random.direction()));
    const auto contacts = findContacts(*box, X, block, 1e-4);
    std::vector<std::pair<SurfaceFeature, int>> keys;
    int corners = 0;
    for (const ShapeContact& c : contacts) {
      EXPECT_TRUE(isVertex(c) || c.corner >= 0);
      EXPECT_NEAR(c.gap, 0.0, 2e-7);
      corners += c.corner >= 0;
      keys.emplace_back(c.feature, c.corner);
    }
    EXPECT_EQ(corners, 4);
    EXPECT_EQ(contacts.size() - corners, 4u);  // nodes at 50 and 60 mm in x, 40 and 50 mm in y
    if (i == 0) expected = keys;
    EXPECT_EQ(keys, expected);
  }
}

TEST(NarrowPhase, BlockOnATableTouchesItWithItsLowerNodesOnly) {
  Surface block = boxSurface(kBlock, {5, 5, 2});
  Random random(23);
  const auto table = makeBoxDistance({0.5, 0.5, 0.05});
  for (int i = 0; i < 10; ++i) {
    for (Eigen::Index n = 0; n < block.nodes.cols(); ++n) block.nodes.col(n) += random.vector(1e-9);
    const auto contacts = findContacts(*table, at({0.03, 0.04, -0.05}), block, 1e-3);
    EXPECT_EQ(contacts.size(), 36u);
    for (const ShapeContact& c : contacts) {
      EXPECT_TRUE(isVertex(c));
      EXPECT_EQ(c.normal_W, Vector3::UnitZ());
    }
  }
}

TEST(NarrowPhase, EdgeOfATiltedBoxAndRimOfATiltedCylinderPassZeroGapSmoothly) {
  // One wide face, so that the contact lies inside it.
  const Surface block = boxSurface({1.0, 1.0, 0.1}, {1, 1, 1});
  struct Case {
    std::unique_ptr<ShapeDistance> shape;
    double reach;  // along z after tilting by 30 degrees about y
  };
  const double s = std::sin(kPi / 6.0);
  const double c = std::cos(kPi / 6.0);
  Case cases[] = {{makeBoxDistance({0.01, 0.02, 0.005}), 0.01 * s + 0.005 * c},
                  {makeCylinderDistance(0.01, 0.005), 0.01 * s + 0.005 * c}};
  for (const Case& k : cases) {
    for (const double gap : {1e-3, 1e-5, 1e-8, 1e-12, 0.0, -1e-12, -1e-8, -1e-5, -1e-3, -3e-3}) {
      Pose X = at({0.6, 0.3, 0.1 + k.reach + gap});
      X.rotate(Eigen::AngleAxisd(kPi / 6.0, Vector3::UnitY()));
      const auto contacts = findContacts(*k.shape, X, block, 2e-3);
      ASSERT_FALSE(contacts.empty()) << gap;
      const ShapeContact& lowest = nearest(contacts);
      EXPECT_TRUE(isFace(lowest));
      EXPECT_NEAR(lowest.gap, gap, 5e-8);  // five times the tie tolerance
      EXPECT_LT((lowest.normal_W + Vector3::UnitZ()).norm(), 1e-9) << gap;
    }
  }
}

TEST(NarrowPhase, CylinderLyingOnATriangleTouchesInTheMiddleOfItsLine) {
  Surface one;
  one.nodes.resize(3, 3);
  one.nodes << 0.0, 0.03, 0.0, 0.0, 0.0, 0.03, 0.0, 0.0, 0.0;
  one.triangles = {{0, 1, 2}};
  const auto cylinder = makeCylinderDistance(0.003, 0.1);
  for (const double gap : {-1e-4, 0.0, 1e-4}) {
    Pose X = at({0.002, 0.01, 0.003 + gap});
    X.rotate(Eigen::AngleAxisd(kPi / 2.0, Vector3::UnitY()));
    const auto contacts = findContacts(*cylinder, X, one, 2e-4);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_LT((pointOf(contacts[0], one.nodes) - Vector3(0.01, 0.01, 0.0)).norm(), 1e-9);
    EXPECT_NEAR(contacts[0].gap, gap, 1e-9);
    EXPECT_LT((contacts[0].normal_W + Vector3::UnitZ()).norm(), 1e-12);
  }
}

/// The shape is smooth compared with the triangle: its gap leaves out part of the sagitta (conforming_gap_test.cpp).
bool isEased(const ShapeDistance& shape, const NodalVectors& nodes, const ShapeContact& contact) {
  const Vector3 p = pointOf(contact, nodes);
  double sagitta = -shape.at(p).distance;
  double squared = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vector3 corner = nodes.col(contact.nodes[i]);
    sagitta += contact.weights[i] * shape.at(corner).distance;
    squared += contact.weights[i] * (corner - p).squaredNorm();
  }
  return 2.0 * sagitta < 0.5 * std::sqrt(squared);
}

/// Moving the triangle by -gap along the normal must leave it just touching: normal and gap belong together, on ridges
/// of the distance (an instrument edge or corner in a face, crossed edges) as well as elsewhere.
TEST(NarrowPhase, GapAlongTheNormalIsWhatSeparates) {
  struct Case {
    std::string name;
    std::unique_ptr<ShapeDistance> shape;
  };
  Case cases[] = {{"sphere", makeSphereDistance(0.005)},
                  {"box", makeBoxDistance({0.01, 0.006, 0.004})},
                  {"cylinder", makeCylinderDistance(0.004, 0.01)},
                  {"disc", makeCylinderDistance(0.008, 0.002)}};
  constexpr double kTouching = 3e-5;
  Random random(24);
  for (const Case& k : cases) {
    int faces = 0;
    int edges = 0;
    for (int i = 0; i < 1500; ++i) {
      const Vector3 centre = random.vector(0.01);
      Surface one;
      one.nodes.resize(3, 3);
      for (int n = 0; n < 3; ++n) one.nodes.col(n) = centre + random.vector(0.02);
      one.triangles = {{0, 1, 2}};
      const TrianglePoints t(one.nodes.col(0), one.nodes.col(1), one.nodes.col(2));
      if (t.normal.dot(centre) > 0.0) std::swap(one.triangles[0][1], one.triangles[0][2]);  // face the shape
      for (const ShapeContact& c : findContacts(*k.shape, Pose::Identity(), one, 2e-3)) {
        if (isVertex(c) || c.corner >= 0 || isEased(*k.shape, one.nodes, c)) continue;
        const Vector3 way = -c.gap * c.normal_W;
        const TrianglePoints moved(t.corners[0] + way, t.corners[1] + way, t.corners[2] + way);
        const double left = bruteForceMinimum(*k.shape, moved);
        EXPECT_GE(left, -kTouching * k.shape->size()) << k.name << " " << i;
        // Less would have done where the deepest point slides off the feature on the way.
        ClosestPoint closest;
        ASSERT_TRUE(k.shape->closest(moved, 1.0, closest));
        if ((closest.weights.array() > 1e-3).count() != (c.weights.array() > 0.0).count()) continue;
        // A tissue edge against a curved side: right to first order in the depth.
        const double curvature = isFace(c) ? 0.0 : c.gap * c.gap / k.shape->size();
        EXPECT_LE(left, kTouching * k.shape->size() + curvature) << k.name << " " << i;
        ++(isFace(c) ? faces : edges);
      }
    }
    EXPECT_GT(faces, 20) << k.name;
    EXPECT_GT(edges, 100) << k.name;
  }
}

TEST(NarrowPhase, CornerContactsKeepTheNormalOfTheFaceWhenTheyDigIn) {
  const Surface block = boxSurface({1.0, 1.0, 0.1}, {1, 1, 1});
  const auto box = makeBoxDistance({0.01, 0.01, 0.005});
  for (const double gap : {1e-4, 0.0, -1e-4, -1e-3}) {
    Pose X = at({0.6, 0.3, 0.105 + gap});
    X.rotate(Eigen::AngleAxisd(1e-3, Vector3(1.0, 0.5, 0.0).normalized()));
    const auto contacts = findContacts(*box, X, block, 1e-3);
    EXPECT_EQ(contacts.size(), 4u);
    for (const ShapeContact& c : contacts) {
      EXPECT_GE(c.corner, 0);
      EXPECT_LT((c.normal_W + Vector3::UnitZ()).norm(), 1e-12);
      EXPECT_NEAR(c.gap, gap, 2e-5);  // 14 mm to a corner times the tilt
    }
  }
}

/// A mesh of a box against the exact box: edges and corners, which the grid rounds, are what touches first.
TEST(NarrowPhase, MeshBoxMakesTheContactsOfTheBox) {
  const Vector3 half(0.01, 0.006, 0.004);
  const auto box = makeBoxDistance(half);
  const auto mesh = makeMeshDistance(boxMesh(half, 1));
  constexpr double kRounding = 1.9e-4;  // m: its grid's spacing, which a corner of three faces loses at most
  const Surface block = boxSurface(kBlock, {10, 10, 3});
  Random random(25);
  int both = 0;
  for (int i = 0; i < 100; ++i) {
    Pose X = at({0.05 + random.number(-0.005, 0.005), 0.05, 0.037});
    X.rotate(Eigen::AngleAxisd(random.number(-0.5, 0.5), random.direction()));
    const auto exact = findContacts(*box, X, block, 1e-3);
    const auto contacts = findContacts(*mesh, X, block, 1e-3);
    if (exact.empty() || contacts.empty()) continue;
    ++both;
    EXPECT_NEAR(nearest(contacts).gap, nearest(exact).gap, kRounding);
    // A corner above the plane: where it is rounded is the same but for the rounding over the distance to a node.
    EXPECT_LT((nearest(contacts).normal_W - nearest(exact).normal_W).norm(), 0.1);
  }
  EXPECT_GT(both, 30);
}

}  // namespace narrow_phase_test
}  // namespace tissue_contact::contact_test
