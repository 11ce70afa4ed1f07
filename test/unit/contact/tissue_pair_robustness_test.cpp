// Tissue against tissue: seeded sweeps against slow independent references, and invariances.
#include <gtest/gtest.h>

#include "tissue_pair_test_utilities.h"

namespace tissue_contact {
namespace tissue_pair_robustness_test {

using namespace contact_test;

const std::vector<TouchingTissues> kBoth = {{0, 1}};
constexpr double kMargin = 1e-3;

Surface surfaceOf(const TriangleMesh& mesh) { return {mesh.vertices, mesh.triangles}; }

/// Convex bodies about 20 mm across: blocks of several grids, an icosahedron, a rounder ball, a plate.
Surface body(int kind) {
  switch (kind % 5) {
    case 0:
      return surfaceOf(boxMesh({0.012, 0.01, 0.008}, 1));
    case 1:
      return surfaceOf(boxMesh({0.011, 0.009, 0.01}, 4));
    case 2:
      return surfaceOf(sphereMesh(0.01, 0));
    case 3:
      return surfaceOf(sphereMesh(0.01, 2));
    default:
      return movedBy(boxSurface({0.03, 0.02, 0.004}, {6, 4, 1}), {-0.015, -0.01, -0.002});
  }
}

/// Smallest distance of a body from another, by nested golden sections over its triangles.
double referenceDistance(const Surface& a, const ShapeDistance& b) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : a.triangles) {
    const TrianglePoints points(a.nodes.col(t[0]), a.nodes.col(t[1]), a.nodes.col(t[2]));
    const Vector3 middle = points.pointAt(Vector3::Constant(1.0 / 3.0));
    double radius = 0.0;
    for (const Vector3& corner : points.corners) radius = std::max(radius, (corner - middle).norm());
    if (b.at(middle).distance - radius < smallest) smallest = std::min(smallest, bruteForceMinimum(b, points));
  }
  return smallest;
}

/// Two bodies turned at random, moved along a line until the first vertex of one is `apart` (m) from the other.
std::vector<TestTissue> place(int trial, double apart) {
  Random random(900 + static_cast<unsigned>(trial));
  const Surface lower = transformed(body(trial), random.pose(0.0));
  const Surface upper = transformed(body(trial / 5), random.pose(0.0));
  const Vector3 along = random.direction();
  double low = 0.0, high = 0.08;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index n = 0; n < upper.nodes.cols(); ++n) {
      nearest = std::min(nearest, bruteForceDistance(lower, upper.nodes.col(n) + middle * along).distance);
    }
    (nearest < apart ? low : high) = middle;
  }
  return {{movedBy(upper, high * along)}, {lower}};
}

TEST(TissuePairs, SmallestGapIsTheDistanceOfTheBodies) {
  const auto box = makeBoxDistance({0.012, 0.01, 0.008});
  int edge_to_edge = 0, compared = 0;
  for (int trial = 0; trial < 800; ++trial) {
    Random random(500 + static_cast<unsigned>(trial));
    const Surface lower = surfaceOf(boxMesh({0.012, 0.01, 0.008}, trial % 2 == 0 ? 1 : 3));
    const Surface upper =
        transformed(surfaceOf(trial % 3 == 0 ? sphereMesh(0.01, 0) : boxMesh({0.01, 0.006, 0.012}, 1)),
                    at(0.0225 * random.direction()) * random.pose(0.0));
    const double distance = referenceDistance(upper, *box);
    if (!(distance > 1e-6 && distance < 5e-3)) continue;
    const std::vector<TestTissue> tissues = {{upper}, {lower}};
    const auto contacts = pairContacts(tissues, kBoth, 6e-3);
    expectSound(tissues, contacts, 6e-3);
    ASSERT_FALSE(contacts.empty()) << trial;
    const Contact& nearest = *std::min_element(contacts.begin(), contacts.end(),
                                               [](const Contact& a, const Contact& b) { return a.gap_m < b.gap_m; });
    EXPECT_NEAR(nearest.gap_m, distance, 1e-7 * distance + 1e-10) << trial;
    edge_to_edge += isEdgePair(nearest);
    ++compared;
  }
  EXPECT_GT(compared, 100);
  EXPECT_GT(edge_to_edge, 30);
}

/// Every vertex against the signed distance of the other body, by looking at all its triangles.
TEST(TissuePairs, VerticesAgreeWithTheSignedDistanceOfTheOtherBody) {
  int outside = 0, inside = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const auto tissues = place(trial, trial % 2 == 0 ? 2e-4 : -4e-4);
    const auto contacts = pairContacts(tissues, kBoth, kMargin);
    expectSound(tissues, contacts, kMargin);
    for (const int tissue : {0, 1}) {
      const Surface& own = tissues[tissue].surface;
      const Surface& other = tissues[1 - tissue].surface;
      for (Eigen::Index n = 0; n < own.nodes.cols(); ++n) {
        const SignedDistance here = bruteForceDistance(other, own.nodes.col(n));
        // What must be found: the nearest point, faced squarely, with the own surface leading away from it.
        double lowest = 1.0;
        double facing = 1.0;
        for (const Triangle& t : own.triangles) {
          if (std::find(t.begin(), t.end(), static_cast<int>(n)) == t.end()) continue;
          facing = std::min(
              facing, here.normal.dot(triangleNormal(own.nodes.col(t[0]), own.nodes.col(t[1]), own.nodes.col(t[2]))));
          for (const int node : t) {
            if (node != n)
              lowest = std::min(lowest, here.normal.dot((own.nodes.col(node) - own.nodes.col(n)).normalized()));
          }
        }
        const bool expected = here.distance < 0.0 ? facing < -0.2 && here.distance > -1e-3
                                                  : facing < -0.2 && lowest > -0.05 && here.distance < kMargin;
        int found = 0;
        for (const Contact& c : contacts) {
          const bool of_vertex = c.key.tissue == tissue && c.nodes[0] == n && !isEdgePair(c);
          const bool at_vertex = c.key.other_tissue == tissue && c.key.other_feature[1] < 0 && c.other_nodes[0] == n;
          if (!of_vertex && !at_vertex) continue;
          EXPECT_GE(std::abs(c.gap_m), std::abs(here.distance) - 1e-12);
          EXPECT_EQ(c.gap_m < -1e-12, here.distance < -1e-12);
          if (std::abs(c.gap_m - here.distance) > 1e-10) continue;
          ++found;
          EXPECT_LT((normalOf(c) - (of_vertex ? 1.0 : -1.0) * here.normal).norm(), 1e-5);
        }
        if (expected) {
          EXPECT_EQ(found, 1) << trial << ' ' << tissue << ' ' << n << ' ' << here.distance;
          ++(here.distance < 0.0 ? inside : outside);
        }
      }
    }
  }
  EXPECT_GT(outside, 80);
  EXPECT_GT(inside, 100);
}

struct Found {
  std::vector<Contact> contacts;
  explicit Found(const std::vector<TestTissue>& tissues, const std::vector<TouchingTissues>& pairs = kBoth)
      : contacts(pairContacts(tissues, pairs, kMargin)) {}
};

TEST(TissuePairs, SwappingTheTissuesMirrorsTheContacts) {
  std::size_t total = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto tissues = place(trial, trial % 2 == 0 ? 1e-4 : -3e-4);
    const Found one(tissues);
    const Found other(tissues, {{1, 0}});
    ASSERT_EQ(one.contacts.size(), other.contacts.size());
    total += one.contacts.size();
    for (const Contact& c : one.contacts) {
      const bool mirrored = isEdgePair(c) || c.key.other_feature[1] < 0;  // the others have their order by themselves
      int matches = 0;
      for (const Contact& d : other.contacts) {
        const bool same = mirrored ? c.key.feature == d.key.other_feature && c.key.other_feature == d.key.feature &&
                                         c.key.tissue == d.key.other_tissue
                                   : c.key == d.key;
        if (!same) continue;
        ++matches;
        EXPECT_NEAR(c.gap_m, d.gap_m, 1e-13);
        EXPECT_LT((normalOf(c) + (mirrored ? 1.0 : -1.0) * normalOf(d)).norm(), 1e-9);
      }
      EXPECT_EQ(matches, 1);
    }
  }
  EXPECT_GT(total, 300u);
}

void expectSame(const std::vector<Contact>& contacts, const std::vector<Contact>& others, const Matrix3& R,
                double scale) {
  ASSERT_EQ(contacts.size(), others.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    EXPECT_TRUE(contacts[i].key == others[i].key);
    EXPECT_NEAR(contacts[i].gap_m, others[i].gap_m / scale, 1e-12);
    EXPECT_LT((R * normalOf(contacts[i]) - normalOf(others[i])).norm(), 1e-7);
  }
}

TEST(TissuePairs, RigidMotionAndScaleMoveTheContactsAlong) {
  Random random(80);
  std::size_t total = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto tissues = place(trial, trial % 2 == 0 ? 1e-4 : -3e-4);
    const Found one(tissues);
    total += one.contacts.size();
    const Pose move = random.pose(0.3);
    auto moved = tissues;
    for (TestTissue& t : moved) t.surface = transformed(t.surface, move);
    expectSame(one.contacts, Found(moved).contacts, move.linear(), 1.0);
    auto scaled = tissues;
    for (TestTissue& t : scaled) t.surface.nodes *= 1000.0;
    expectSame(one.contacts, pairContacts(scaled, kBoth, 1000.0 * kMargin), Matrix3::Identity(), 1000.0);
  }
  EXPECT_GT(total, 300u);
}

TEST(TissuePairs, OrderOfTrianglesDoesNotMatter) {
  for (int trial = 0; trial < 100; ++trial) {
    const auto tissues = place(trial, trial % 2 == 0 ? 1e-4 : -3e-4);
    auto reversed = tissues;
    for (TestTissue& tissue : reversed) {
      std::reverse(tissue.surface.triangles.begin(), tissue.surface.triangles.end());
      for (Triangle& t : tissue.surface.triangles) t = {t[1], t[2], t[0]};
    }
    expectSame(Found(tissues).contacts, Found(reversed).contacts, Matrix3::Identity(), 1.0);
  }
}

TEST(TissuePairs, RepeatsToTheLastBitWhateverItSawBefore) {
  Random random(81);
  const Surface block = boxSurface({0.04, 0.04, 0.02}, {8, 8, 3});
  const Surface sheet = sheetSurface({0.06, 0.06}, 20, 20);
  std::vector<TestTissue> tissues = {{movedBy(block, {0.0, 0.0, 0.0201})}, {block}, {sheet, 1e-3}};
  const std::vector<TouchingTissues> pairs = {{0, 1}, {0, 2}, {2, 1}, {2, 2}, {1, 1}};
  tissues[2].surface.nodes = hairpin(sheet.nodes, 0.06, 6e-4);
  std::vector<NodalVectors> rest = positionsOf(tissues);
  rest[2] = sheet.nodes;
  TissuePairDetector detector(pairs, shareSurfaces(surfacesOf(tissues), rest));
  std::size_t total = 0;
  for (int i = 0; i < 20; ++i) {
    std::vector<NodalVectors> x = positionsOf(tissues);
    for (NodalVectors& nodes : x) {
      for (Eigen::Index n = 0; n < nodes.cols(); ++n) nodes.col(n) += random.vector(2e-4);
    }
    std::vector<Contact> contacts, again, fresh;
    detector.detect(x, kMargin, contacts);
    detector.detect(x, kMargin, again);
    TissuePairDetector(pairs, shareSurfaces(surfacesOf(tissues), rest)).detect(x, kMargin, fresh);
    EXPECT_TRUE(sameBits(contacts, again));
    EXPECT_TRUE(sameBits(contacts, fresh));
    total += contacts.size();
  }
  EXPECT_GT(total, 2000u);
}

/// Crumpled and collapsed surfaces: finite, sound contacts or none.
TEST(TissuePairs, DegenerateTrianglesGiveSoundContactsOrNone) {
  Random random(82);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<TestTissue> tissues = {{boxSurface({0.04, 0.04, 0.02}, {6, 6, 3})},
                                       {boxSurface({0.04, 0.04, 0.02}, {5, 5, 2})},
                                       {sheetSurface({0.04, 0.04}, 8, 8), 1e-3}};
    std::vector<NodalVectors> rest = positionsOf(tissues);
    for (TestTissue& tissue : tissues) {
      NodalVectors& x = tissue.surface.nodes;
      for (Eigen::Index i = 0; i < x.cols(); ++i) {
        const int kind = static_cast<int>(random.number(0.0, 8.0));
        if (kind == 0) x.col(i) = Vector3(0.02, 0.02, 0.02);
        if (kind == 1) x(1, i) = 0.02;
        if (kind == 2) x.col(i) = x.col((i + 1) % x.cols());
        if (kind == 3) x(2, i) = 0.02 - 1e-12 * random.number(0.0, 1.0);
        if (kind == 4) x.col(i) = random.vector(0.03);
      }
    }
    TissuePairDetector detector({{0, 1}, {1, 2}, {0, 2}, {0, 0}, {2, 2}}, shareSurfaces(surfacesOf(tissues), rest));
    std::vector<Contact> contacts;
    detector.detect(positionsOf(tissues), kMargin, contacts);
    expectSound(tissues, contacts, kMargin);
  }
}

}  // namespace tissue_pair_robustness_test
}  // namespace tissue_contact
