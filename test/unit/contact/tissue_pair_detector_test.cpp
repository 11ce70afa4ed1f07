// Tissue against tissue: pairs of volumes and sheets with known answers, and bad input.
#include "tissue_contact/contact/tissue_pair_detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "tissue_pair_test_utilities.h"

namespace tissue_contact {
namespace tissue_pair_detector_test {

using namespace contact_test;

constexpr double kPi = 3.14159265358979323846;
const std::vector<TouchingTissues> kBoth = {{0, 1}};

Pose turned(double angle, const Vector3& axis) { return Pose(Eigen::AngleAxisd(angle, axis)); }

/// A tetrahedron with its tip at the origin, opening upwards.
Surface tip() {
  Surface surface;
  surface.nodes.resize(3, 4);
  surface.nodes << 0.0, 0.01, -0.005, -0.005, 0.0, 0.0, 0.008, -0.008, 0.0, 0.02, 0.02, 0.02;
  surface.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}};
  return surface;
}

TEST(TissuePairDetector, VertexOverAndInAFace) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {10, 10, 3});
  for (const double gap : {4e-5, 1e-9, 0.0, -1e-9, -1e-5, -1e-3, -4e-3}) {
    const std::vector<TestTissue> tissues = {{movedBy(tip(), {0.0533, 0.0482, 0.03 + gap})}, {block}};
    const auto contacts = pairContacts(tissues, kBoth, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    ASSERT_EQ(contacts.size(), 1u) << gap;
    const Contact& c = contacts[0];
    EXPECT_EQ(c.key.tissue, 0);
    EXPECT_EQ(c.key.other_tissue, 1);
    EXPECT_EQ(c.key.feature, (std::array<int, 3>{0, -1, -1}));
    EXPECT_GE(c.key.other_feature[2], 0);
    EXPECT_EQ(c.nodes, (std::array<int, 3>{0, 0, 0}));
    EXPECT_EQ(c.weights, Vector3::UnitX());
    EXPECT_LT((otherPoint(c, block.nodes) - Vector3(0.0533, 0.0482, 0.03)).norm(), 1e-15);
    EXPECT_NEAR(c.gap_m, gap, 1e-17);
    EXPECT_LT((normalOf(c) - Vector3::UnitZ()).norm(), 1e-14);
  }
  for (const double far : {6e-5, -7e-3}) {  // beyond the margin; deeper than half an edge of the coarser grid
    EXPECT_TRUE(pairContacts({{movedBy(tip(), {0.0533, 0.0482, 0.03 + far})}, {block}}, kBoth, 5e-5).empty());
  }
}

TEST(TissuePairDetector, VertexOfTheSecondTissueOnAFaceOfTheFirst) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {10, 10, 3});
  const std::vector<TestTissue> tissues = {{block}, {movedBy(tip(), {0.0533, 0.0482, 0.03 - 1e-4})}};
  const auto contacts = pairContacts(tissues, kBoth, 5e-5);
  expectSound(tissues, contacts, 5e-5);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0].key.tissue, 1);
  EXPECT_EQ(contacts[0].key.other_tissue, 0);
  EXPECT_LT((normalOf(contacts[0]) - Vector3::UnitZ()).norm(), 1e-14);
  EXPECT_NEAR(contacts[0].gap_m, -1e-4, 1e-16);
}

/// Wherever it is, and however far the margin reaches: no contact with the edges beside it, which it could catch on.
TEST(TissuePairDetector, VertexOverAFlatPartOfManyFaces) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {10, 10, 3});
  Random random(60);
  for (int i = 0; i < 500; ++i) {
    // On nodes, edges and diagonals, and anywhere; the margin reaches over several cells.
    Vector3 p(random.number(0.03, 0.07), random.number(0.03, 0.07), 0.03 + 1e-4);
    if (i % 2 == 0) p.x() = 0.05;
    if (i % 3 == 0) p.y() = p.x();
    const auto contacts = pairContacts({{movedBy(tip(), p)}, {block}}, kBoth, 0.015);
    int straight = 0;
    for (const Contact& c : contacts) {
      const double tilt = (normalOf(c) - (c.key.tissue == 0 ? 1.0 : -1.0) * Vector3::UnitZ()).norm();
      if (tilt < 1e-9) {
        ++straight;
        EXPECT_NEAR(c.gap_m, 1e-4, 1e-16);
      } else {
        EXPECT_LT(tilt, 0.1) << p.transpose();  // a node almost under the tip
      }
    }
    EXPECT_EQ(straight, 1) << p.transpose();
  }
}

TEST(TissuePairDetector, RidgesCrossing) {
  // Two bars on their edges, one along x below, one along y above.
  const Surface bar = boxSurface({0.1, 0.02, 0.02}, {1, 1, 1});
  const Surface below = transformed(movedBy(bar, {-0.047, -0.01, -0.01}), turned(kPi / 4.0, Vector3::UnitX()));
  const Surface above = transformed(below, turned(kPi / 2.0, Vector3::UnitZ()));
  const double height = 0.02 * std::sqrt(2.0);
  for (const double gap : {4e-5, 0.0, -1e-5, -2e-3}) {
    const std::vector<TestTissue> tissues = {{movedBy(above, {0.001, 0.0, height + gap})}, {below}};
    const auto contacts = pairContacts(tissues, kBoth, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    ASSERT_EQ(contacts.size(), 1u) << gap;
    EXPECT_TRUE(isEdgePair(contacts[0]));
    EXPECT_EQ(contacts[0].nodes[1], contacts[0].nodes[2]);
    EXPECT_NEAR(contacts[0].gap_m, gap, 1e-15);
    EXPECT_LT((normalOf(contacts[0]) - Vector3::UnitZ()).norm(), 1e-12);
    EXPECT_LT((contacts[0].p_WC - Vector3(0.001, 0.0, 0.5 * height + gap)).norm(), 1e-12);
  }
}

/// A fine layer on a ridge that reaches beyond it: every edge of its lower face that crosses the ridge is held, so that
/// it cannot sag between the ridge's far ends; its upper face, though within the margin, is not.
TEST(TissuePairDetector, LayerOnARidge) {
  const Surface bar = boxSurface({0.2, 0.02, 0.02}, {1, 1, 1});
  const Surface ridge = transformed(movedBy(bar, {-0.1, -0.01, -0.01}), turned(kPi / 4.0, Vector3::UnitX()));
  const double top = 0.01 * std::sqrt(2.0);
  const Surface layer = boxSurface({0.1, 0.1, 3e-4}, {10, 10, 1});
  for (const double gap : {1e-5, 0.0, -1e-5}) {
    const std::vector<TestTissue> tissues = {{movedBy(layer, {-0.0503, -0.0477, top + gap})}, {ridge}};
    const auto contacts = pairContacts(tissues, kBoth, 1e-3);
    expectSound(tissues, contacts, 1e-3);
    int on_top = 0;
    for (const Contact& c : contacts) {
      if (std::abs(c.p_WC.y()) > 1e-9) continue;  // beside the ridge, within the margin
      ++on_top;
      EXPECT_TRUE(isEdgePair(c));
      EXPECT_NEAR(c.gap_m, gap, 1e-15);
      EXPECT_LT((normalOf(c) - Vector3::UnitZ()).norm(), 1e-9);
    }
    EXPECT_EQ(on_top, 11 + 10);  // lines of the grid, and one diagonal per cell
  }
}

/// Two sheets folded to roofs of this slope, top against top, whose ridges cross in the middle with this gap.
std::vector<TestTissue> crossingRoofs(double slope, double gap) {
  constexpr double kThickness = 2e-5;
  Surface lower = movedBy(sheetSurface({0.02, 0.01}, 2, 1), {-0.01, -0.005, 0.0});
  Surface upper = movedBy(sheetSurface({0.01, 0.02}, 1, 2), {-0.005, -0.01, gap + kThickness});
  lower.nodes.row(2) -= slope * lower.nodes.row(0).cwiseAbs();
  upper.nodes.row(2) += slope * upper.nodes.row(1).cwiseAbs();
  return {{upper, kThickness}, {lower, kThickness}};
}

/// Where a force flattens the edges it comes from, these would let go and press in turn.
TEST(TissuePairDetector, CrossingOfFlatEdgesCountsOnlyWhereItHas) {
  const auto steep = pairContacts(crossingRoofs(0.05, 1e-5), kBoth, 5e-5);
  ASSERT_EQ(edgePairs(steep), 1);
  const ContactKey key = std::find_if(steep.begin(), steep.end(), isEdgePair)->key;
  const auto crossings = [&](const std::vector<ContactKey>& known, double gap) {
    const std::vector<TestTissue> flat = crossingRoofs(0.01, gap);
    TissuePairDetector detector(kBoth, shareSurfaces(surfacesOf(flat), positionsOf(flat)));
    std::vector<Contact> contacts;
    detector.detect(positionsOf(flat), {5e-5}, {}, known, contacts);
    for (const Contact& contact : contacts) {
      if (!isEdgePair(contact)) continue;
      EXPECT_EQ(contact.key, key);
      EXPECT_NEAR(contact.gap_m, gap, 1e-15);
    }
    return edgePairs(contacts);
  };
  EXPECT_EQ(crossings({}, 1e-5), 0);
  EXPECT_EQ(crossings({key}, 1e-5), 1);
  EXPECT_EQ(crossings({key}, 1e-4), 0) << "beyond the margin it has come off";
  ContactKey other = key;
  other.other_tissue = 7;
  ContactKey gone = key;  // as of a mesh that has changed
  gone.feature = {1000, 1001, -1};
  EXPECT_EQ(crossings({other, gone}, 1e-5), 0);
}

TEST(TissuePairDetector, FlatBarsCrossingTouchAtTheirFourCorners) {
  const Surface x_bar = boxSurface({0.2, 0.02, 0.02}, {1, 1, 1});
  const Surface y_bar = boxSurface({0.02, 0.2, 0.02}, {1, 1, 1});
  for (const double gap : {4e-5, -1e-4}) {
    const std::vector<TestTissue> tissues = {{movedBy(y_bar, {0.09, -0.09, 0.02 + gap})}, {x_bar}};
    const auto contacts = pairContacts(tissues, kBoth, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    ASSERT_EQ(contacts.size(), 4u);
    for (const Contact& c : contacts) {
      EXPECT_TRUE(isEdgePair(c));
      EXPECT_NEAR(c.gap_m, gap, 1e-15);
      EXPECT_LT((normalOf(c) - Vector3::UnitZ()).norm(), 1e-12);
    }
  }
}

TEST(TissuePairDetector, StackedOnTheSameGridPairsNodes) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {20, 20, 6});
  for (const double gap : {1e-5, 1e-8, 0.0, -1e-9, -1e-5, -1e-3}) {
    const std::vector<TestTissue> tissues = {{movedBy(block, {0.0, 0.0, 0.03 + gap})}, {block}};
    const auto contacts = pairContacts(tissues, kBoth, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    ASSERT_EQ(contacts.size(), 441u) << gap;
    for (const Contact& c : contacts) {
      EXPECT_EQ(c.key.tissue, 0);
      EXPECT_EQ(c.key.other_feature[1], -1);
      EXPECT_NEAR(c.gap_m, gap, 1e-16);
      EXPECT_LT((normalOf(c) - Vector3::UnitZ()).norm(), 1e-7) << gap;
    }
  }
}

/// Sideways by less than a cell and back, as friction lets them shift: no contact tilts at the rims.
TEST(TissuePairDetector, StackedAndShiftedALittleKeepsTheirNormals) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {10, 10, 3});
  for (const double shift : {1e-13, 1e-11, 1e-9, 1e-7, 1e-6}) {
    for (const double gap : {1e-8, 0.0, -1e-8}) {
      const std::vector<TestTissue> tissues = {{movedBy(block, {shift, 0.5 * shift, 0.03 + gap})}, {block}};
      const auto contacts = pairContacts(tissues, kBoth, 5e-5);
      expectSound(tissues, contacts, 5e-5);
      std::set<int> upper, lower;
      for (const Contact& c : contacts) {
        const double side = c.key.tissue == 0 ? 1.0 : -1.0;
        EXPECT_LT((normalOf(c) - side * Vector3::UnitZ()).norm(), 1e-6) << shift << ' ' << gap;
        EXPECT_NEAR(c.gap_m, gap, 1e-12);
        (c.key.tissue == 0 ? upper : lower).insert(c.key.feature[0]);
        if (c.key.other_feature[1] < 0) (c.key.tissue == 0 ? lower : upper).insert(c.key.other_feature[0]);
      }
      // Every node pair is held from one side at least.
      EXPECT_GE(upper.size() + lower.size(), 2u * 121u - 2u * 21u) << shift << ' ' << gap;
      EXPECT_GE(std::max(upper.size(), lower.size()), 100u);
    }
  }
}

TEST(TissuePairDetector, StackedOnDifferentGrids) {
  const Surface lower = boxSurface({0.1, 0.1, 0.03}, {20, 20, 6});
  const Surface upper = boxSurface({0.08, 0.08, 0.03}, {13, 13, 4});
  for (const double gap : {1e-5, 0.0, -1e-5}) {
    const std::vector<TestTissue> tissues = {{movedBy(upper, {0.0103, 0.0089, 0.03 + gap})}, {lower}};
    const auto contacts = pairContacts(tissues, kBoth, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    std::size_t under = 0;  // nodes of the lower block under the upper
    for (Eigen::Index i = 0; i < lower.nodes.cols(); ++i) {
      const Vector3 p = lower.nodes.col(i) - Vector3(0.0103, 0.0089, 0.03);
      under += p.z() > -1e-9 && p.x() > 0.0 && p.x() < 0.08 && p.y() > 0.0 && p.y() < 0.08;
    }
    EXPECT_EQ(contacts.size(), 14u * 14u + under);
    EXPECT_EQ(edgePairs(contacts), 0);
    for (const Contact& c : contacts) {
      EXPECT_NEAR(c.gap_m, gap, 1e-16);
      EXPECT_LT((normalOf(c) - (c.key.tissue == 0 ? 1.0 : -1.0) * Vector3::UnitZ()).norm(), 1e-12);
    }
  }
}

/// One block reaches 1 mm over the rim of the other and has sunk in by a micrometre: up is the way out, not sideways.
TEST(TissuePairDetector, OverlapAtTheRimIsLeftTheShortWay) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {20, 20, 6});
  for (const double y : {0.05, 0.0513}) {
    const std::vector<TestTissue> tissues = {{movedBy(block, {0.099, y, 0.03 - 1e-6})}, {block}};
    const auto contacts = pairContacts(tissues, kBoth, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    EXPECT_GE(contacts.size(), 20u);
    for (const Contact& c : contacts) {
      EXPECT_GT(std::abs(normalOf(c).z()), 1.0 - 1e-12);
      EXPECT_NEAR(c.gap_m, -1e-6, 1e-15);
    }
  }
}

/// A slab 1 mm thick and coarse, pressed upon from above, is not pushed out through its lower face.
TEST(TissuePairDetector, FarSideOfAThinLayerDoesNotCount) {
  const Surface layer = boxSurface({0.1, 0.1, 0.001}, {10, 10, 1});
  for (const double gap : {1e-5, -1e-5, -4e-4}) {
    for (const bool on_top : {true, false}) {
      Surface probe = tip();
      if (!on_top) probe = transformed(probe, turned(kPi, Vector3::UnitX()));
      const double z = on_top ? 0.001 + gap : -gap;
      const std::vector<TestTissue> tissues = {{movedBy(probe, {0.0533, 0.0482, z})}, {layer}};
      const auto contacts = pairContacts(tissues, kBoth, 2e-3);
      int of_tip = 0;
      for (const Contact& c : contacts) {
        if (c.key.tissue != 0) continue;
        ++of_tip;
        EXPECT_NEAR(c.gap_m, gap, 1e-15);
        EXPECT_LT((normalOf(c) - (on_top ? 1.0 : -1.0) * Vector3::UnitZ()).norm(), 1e-12);
      }
      EXPECT_EQ(of_tip, 1);
    }
  }
}

TEST(TissuePairDetector, FixedOnBothSidesIsLeftOut) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {10, 10, 3});
  const Surface upper = movedBy(block, {0.0, 0.0, 0.03});
  std::vector<bool> left(block.nodes.cols());
  for (Eigen::Index i = 0; i < block.nodes.cols(); ++i) left[i] = block.nodes(0, i) < 0.051;
  EXPECT_EQ(pairContacts({{upper, 0.0, {}, left}, {block}}, kBoth, 5e-5).size(), 121u);
  const auto contacts = pairContacts({{upper, 0.0, {}, left}, {block, 0.0, {}, left}}, kBoth, 5e-5);
  EXPECT_EQ(contacts.size(), 55u);
  for (const Contact& c : contacts) EXPECT_GT(c.p_WC.x(), 0.051);
}

TEST(TissuePairDetector, AppendsAndSortsItsOwnPart) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {4, 4, 1});
  const std::vector<TestTissue> tissues = {{movedBy(block, {0.0, 0.0, 0.03})}, {block}};
  TissuePairDetector detector(kBoth, shareSurfaces(surfacesOf(tissues), positionsOf(tissues)));
  std::vector<Contact> contacts(2);
  contacts[0].key.tissue = 7;
  detector.detect(positionsOf(tissues), 5e-5, contacts);
  ASSERT_EQ(contacts.size(), 27u);
  EXPECT_EQ(contacts[0].key.tissue, 7);
  EXPECT_EQ(contacts[1].key.tissue, -1);
}

TEST(TissuePairDetector, NoPairFarApartOrNotFiniteGivesNothing) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {4, 4, 1});
  std::vector<TestTissue> tissues = {{movedBy(block, {0.0, 0.0, 0.03})}, {block}};
  EXPECT_TRUE(pairContacts(tissues, {}, 1e-3).empty());
  EXPECT_TRUE(pairContacts({}, {}, 1e-3).empty());
  EXPECT_TRUE(pairContacts({{movedBy(block, {0.0, 0.0, 0.05})}, {block}}, kBoth, 1e-3).empty());
  EXPECT_TRUE(pairContacts({{Surface{NodalVectors(3, 0), {}}}, {block}}, {{0, 1}, {0, 0}}, 1e-3).empty());
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TissuePairDetector detector({{0, 1}, {0, 0}}, shareSurfaces(surfacesOf(tissues), positionsOf(tissues)));
    std::vector<NodalVectors> x = positionsOf(tissues);
    std::vector<Contact> contacts;
    for (Eigen::Index i = 0; i < x[0].cols(); i += 3) x[0].col(i).setConstant(bad);
    detector.detect(x, 1e-3, contacts);
    for (const Contact& c : contacts) EXPECT_TRUE(std::isfinite(c.gap_m) && c.R_WC.allFinite());
    x[0].setConstant(bad);
    contacts.clear();
    detector.detect(x, 1e-3, contacts);
    EXPECT_TRUE(contacts.empty());
    detector.detect(positionsOf(tissues), 1e-3, contacts);
    EXPECT_EQ(contacts.size(), pairContacts(tissues, {{0, 1}, {0, 0}}, 1e-3).size()) << "good positions again";
  }
}

TEST(TissuePairDetector, RefusesWhatDoesNotFit) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {2, 2, 1});
  const std::vector<TestTissue> good = {{block}, {block}};
  const auto build = [](const std::vector<TouchingTissues>& pairs, const std::vector<TestTissue>& tissues) {
    return TissuePairDetector(pairs, shareSurfaces(surfacesOf(tissues), positionsOf(tissues)));
  };
  EXPECT_THROW(build({{0, 2}}, good), std::invalid_argument);
  EXPECT_THROW(build({{-1, 0}}, good), std::invalid_argument);
  EXPECT_THROW(build({{0, 1}, {1, 0}}, good), std::invalid_argument);
  EXPECT_THROW(shareSurfaces(surfacesOf(good), {block.nodes}), std::invalid_argument);
  auto bad = good;
  bad[1].surface.triangles[0] = {0, 1, 1};
  EXPECT_THROW(build(kBoth, bad), std::invalid_argument);
  bad[1].surface.triangles[0] = {0, 1, 10000};
  EXPECT_THROW(build(kBoth, bad), std::invalid_argument);
  bad = good;
  bad[0].fixed = {true};
  EXPECT_THROW(build(kBoth, bad), std::invalid_argument);
  TissuePairDetector detector = build(kBoth, good);
  std::vector<Contact> contacts;
  for (const std::vector<double>& margins :
       {std::vector<double>(kBoth.size() + 1, 1e-3), std::vector<double>{}, std::vector<double>(kBoth.size(), -1e-3)}) {
    EXPECT_THROW(detector.detect(positionsOf(good), margins, {}, {}, contacts), std::invalid_argument);
  }
  for (const double thickness : {-1e-3, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    bad = good;
    bad[0].thickness = thickness;
    EXPECT_THROW(build(kBoth, bad), std::invalid_argument);
  }
  for (const double margin : {-1e-3, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    EXPECT_THROW(detector.detect(positionsOf(good), margin, contacts), std::invalid_argument);
  }
  EXPECT_THROW(detector.detect({block.nodes}, 1e-3, contacts), std::invalid_argument);
  EXPECT_THROW(detector.detect({block.nodes, NodalVectors::Zero(3, 2)}, 1e-3, contacts), std::invalid_argument);
}

}  // namespace tissue_pair_detector_test
}  // namespace tissue_contact
