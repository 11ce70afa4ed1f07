// Tissue against tissue: sheets on sheets, sheets on volumes, and folds of sheets and volumes.
#include <gtest/gtest.h>

#include "tissue_pair_test_utilities.h"

namespace tissue_contact {
namespace tissue_pair_sheet_test {

using namespace contact_test;

constexpr double kPi = 3.14159265358979323846;
constexpr double kThick = 1e-3;
const std::vector<TouchingTissues> kBoth = {{0, 1}};
const std::vector<TouchingTissues> kFolds = {{0, 0}};

TEST(SheetPairs, TwoSheetsHoldEachOtherOnTheSideTheyLieOn) {
  const Surface large = sheetSurface({0.1, 0.1}, 10, 10);
  const Surface small = sheetSurface({0.05, 0.05}, 7, 7);
  const double thick[] = {1e-3, 6e-4};
  for (const double side : {1.0, -1.0}) {
    for (const double gap : {4e-5, 0.0, -1e-4, -7e-4}) {  // the last: 0.1 mm between the middle surfaces
      const double height = gap + 0.5 * (thick[0] + thick[1]);
      const std::vector<TestTissue> tissues = {{movedBy(small, {0.0211, 0.0233, side * height}), thick[0]},
                                               {large, thick[1]}};
      const auto contacts = pairContacts(tissues, kBoth, 5e-5);
      expectSound(tissues, contacts, 5e-5);
      EXPECT_EQ(contacts.size(), 64u + 25u);
      EXPECT_EQ(edgePairs(contacts), 0);
      for (const Contact& c : contacts) {
        EXPECT_NEAR(c.gap_m, gap, 1e-16);
        EXPECT_LT((normalOf(c) - (c.key.tissue == 0 ? side : -side) * Vector3::UnitZ()).norm(), 1e-12);
      }
    }
  }
}

TEST(SheetPairs, StripsCrossingTouchAtTheirFourCorners) {
  const Surface along_x = sheetSurface({0.2, 0.02}, 1, 1);
  const Surface along_y = sheetSurface({0.02, 0.2}, 1, 1);
  for (const double side : {1.0, -1.0}) {
    const std::vector<TestTissue> tissues = {{movedBy(along_y, {0.09, -0.09, side * 1.01 * kThick}), kThick},
                                             {along_x, kThick}};
    const auto contacts = pairContacts(tissues, kBoth, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    int corners = 0;
    for (const Contact& c : contacts) {
      EXPECT_NEAR(c.gap_m, 0.01 * kThick, 1e-15);
      EXPECT_LT((normalOf(c) - side * Vector3::UnitZ()).norm(), 1e-12);
      const Vector3 p = c.p_WC - Vector3(0.1, 0.01, side * 1.01 * kThick);
      corners += std::abs(std::abs(p.x()) - 0.01) < 1e-12 && std::abs(std::abs(p.y()) - 0.01) < 1e-12;
    }
    EXPECT_EQ(corners, 4);
    EXPECT_EQ(contacts.size(), 4u);
  }
}

TEST(SheetPairs, BoundariesOfSheetsPushEachOtherInTheirPlane) {
  const Surface sheet = sheetSurface({0.04, 0.04}, 4, 4);
  const std::vector<TestTissue> tissues = {{movedBy(sheet, {0.04 + 1.02 * kThick, 0.0, 0.0}), kThick}, {sheet, kThick}};
  const auto contacts = pairContacts(tissues, kBoth, 5e-5);
  expectSound(tissues, contacts, 5e-5);
  ASSERT_EQ(contacts.size(), 5u);  // the nodes of the two rims
  for (const Contact& c : contacts) {
    EXPECT_NEAR(c.gap_m, 0.02 * kThick, 1e-15);
    EXPECT_LT((normalOf(c) - Vector3::UnitX()).norm(), 1e-12);
  }
}

TEST(SheetPairs, SheetOnAVolumeHasOneSideOnly) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {10, 10, 3});
  const Surface sheet = sheetSurface({0.05, 0.05}, 7, 7);
  // Above the volume's surface and sunk in with its middle: up is out.
  for (const double gap : {2e-5, 0.0, -0.4 * kThick, -0.6 * kThick, -1.2 * kThick}) {
    const double height = 0.03 + gap + 0.5 * kThick;
    const std::vector<TestTissue> tissues = {{movedBy(sheet, {0.0211, 0.0233, height}), kThick}, {block}};
    const auto contacts = pairContacts(tissues, kBoth, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    int of_sheet = 0;
    for (const Contact& c : contacts) {
      EXPECT_LT((normalOf(c) - (c.key.tissue == 0 ? 1.0 : -1.0) * Vector3::UnitZ()).norm(), 1e-12) << gap;
      EXPECT_NEAR(c.gap_m, gap, 1e-15);
      of_sheet += c.key.tissue == 0;
    }
    EXPECT_EQ(of_sheet, 64);
    // The block's nodes know their side until the sheet's far side has passed them.
    EXPECT_EQ(static_cast<int>(contacts.size()) - of_sheet, gap > -kThick ? 25 : 0);
  }
}

TEST(SheetPairs, FlatAndBentSheetsDoNotTouchThemselves) {
  const Surface sheet = sheetSurface({0.1, 0.1}, 30, 30);
  for (const double thickness : {1e-4, 1e-3, 8e-3}) {
    for (const double margin : {1e-5, 1e-3, 0.02}) {
      EXPECT_TRUE(pairContacts({{sheet, thickness}}, kFolds, margin).empty());
      for (const double turn : {0.3, 1.5, 3.0}) {
        Surface now = sheet;
        now.nodes = bent(sheet.nodes, 0.0, 0.1, 0.1 / turn);
        EXPECT_TRUE(pairContacts({{now, thickness, sheet.nodes}}, kFolds, std::min(margin, 1e-3)).empty())
            << thickness << ' ' << margin << ' ' << turn;
      }
    }
  }
  // Wavy at random, as under load.
  Random random(70);
  for (int i = 0; i < 20; ++i) {
    Surface now = sheet;
    for (Eigen::Index n = 0; n < now.nodes.cols(); ++n) now.nodes.col(n) += random.vector(5e-4);
    EXPECT_TRUE(pairContacts({{now, kThick, sheet.nodes}}, kFolds, 1e-4).empty());
  }
}

TEST(SheetPairs, HairpinTouchesItselfAcrossTheFold) {
  const double length = 0.1;
  const Surface flat = sheetSurface({length, 0.03}, 80, 12);
  const double gap = 3e-5;
  for (const bool turned_over : {false, true}) {
    const double radius = 0.5 * (kThick + gap);
    Surface folded = flat;
    folded.nodes = hairpin(flat.nodes, length, radius);
    if (turned_over) folded.nodes.row(2) *= -1.0;
    const std::vector<TestTissue> tissues = {{folded, kThick, flat.nodes}};
    const auto contacts = pairContacts(tissues, kFolds, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    std::vector<bool> touched(flat.nodes.cols());
    for (const Contact& c : contacts) {
      EXPECT_NEAR(c.gap_m, gap, 1e-7);
      const bool below = flat.nodes(0, c.nodes[0]) < 0.5 * length;
      EXPECT_LT((normalOf(c) - (below != turned_over ? -1.0 : 1.0) * Vector3::UnitZ()).norm(), 0.01);
      const double apart = (tissuePoint(c, flat.nodes) - otherPoint(c, flat.nodes)).norm();
      EXPECT_GT(apart, 1.5 * kThick);
      for (const auto& feature : {c.key.feature, c.key.other_feature}) {
        for (const int node : feature) {
          if (node >= 0) touched[node] = true;
        }
      }
    }
    for (Eigen::Index n = 0; n < flat.nodes.cols(); ++n) {
      const double from_fold = std::abs(flat.nodes(0, n) - 0.5 * length);
      if (from_fold > 0.005) {
        EXPECT_TRUE(touched[n]) << flat.nodes.col(n).transpose();
      }
    }
  }
}

/// Finer than it is thick and pressed together by a sixth: the turn itself, shorter inside than a fold of this
/// thickness can be, is left to the bending stiffness.
TEST(SheetPairs, TurnOfAThickFoldIsNoContact) {
  const Surface flat = sheetSurface({0.02, 2e-4}, 200, 2);
  Surface folded = flat;
  folded.nodes = hairpin(flat.nodes, 0.02, 0.42 * kThick);
  const std::vector<TestTissue> tissues = {{folded, kThick, flat.nodes}};
  const auto contacts = pairContacts(tissues, kFolds, 1e-5);
  expectSound(tissues, contacts, 1e-5);
  double nearest = 1.0;
  for (const Contact& c : contacts) {
    nearest = std::min(nearest, (tissuePoint(c, flat.nodes) - otherPoint(c, flat.nodes)).norm());
    EXPECT_NEAR(c.gap_m, -0.16 * kThick, 5e-6);
  }
  EXPECT_GT(contacts.size(), 250u);
  EXPECT_GT(nearest, 1.5 * kThick);  // half a turn is pi 0.42 = 1.32 thick
  EXPECT_LT(nearest, 1.8 * kThick);
}

/// A plate 2 mm thick bent through half a turn: its inner faces meet, its two sides do not.
TEST(SheetPairs, FoldOfAVolume) {
  const Surface plate = boxSurface({0.1, 0.03, 0.002}, {80, 12, 1});
  for (const double gap : {3e-5, -2e-5}) {
    // Bent upwards, the inner face is the upper one, 2 mm above the plane that turns about `radius`.
    const double radius = 0.002 + 0.5 * gap + 1e-3;
    Surface folded = plate;
    folded.nodes = hairpin(plate.nodes, 0.1, radius);
    EXPECT_TRUE(pairContacts({{folded, 0.0, plate.nodes}}, kFolds, 5e-5).empty());  // 2 mm apart: an open U
    // Close the U: the upper leg comes down by 2 mm.
    for (Eigen::Index n = 0; n < plate.nodes.cols(); ++n) {
      const double past = std::min(1.0, std::max(0.0, (plate.nodes(0, n) - 0.047) / 0.006));
      folded.nodes(2, n) -= past * 2e-3;
    }
    const std::vector<TestTissue> tissues = {{folded, 0.0, plate.nodes}};
    const auto contacts = pairContacts(tissues, kFolds, 5e-5);
    expectSound(tissues, contacts, 5e-5);
    int clear_of_the_turn = 0;
    for (const Contact& c : contacts) {
      const Vector3 p = tissuePoint(c, plate.nodes);
      const Vector3 q = otherPoint(c, plate.nodes);
      EXPECT_NEAR(p.z(), 0.002, 1e-12);  // the inner face on both sides
      EXPECT_NEAR(q.z(), 0.002, 1e-12);
      if (std::min(std::abs(p.x() - 0.05), std::abs(q.x() - 0.05)) < 0.01) continue;
      ++clear_of_the_turn;
      EXPECT_NEAR(c.gap_m, gap, 1e-15);
      EXPECT_NEAR(normalOf(c).z(), p.x() < 0.05 ? -1.0 : 1.0, 1e-12);
    }
    EXPECT_GT(clear_of_the_turn, 300);
  }
}

TEST(SheetPairs, VolumesDoNotTouchThemselves) {
  Random random(71);
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {10, 10, 3});
  const Surface plate = boxSurface({0.1, 0.1, 0.0005}, {20, 20, 1});
  for (const Surface& rest : {block, plate}) {
    EXPECT_TRUE(pairContacts({{rest}}, kFolds, 1e-4).empty());
    for (int i = 0; i < 20; ++i) {
      Surface now = rest;
      now.nodes.row(2) *= i == 0 ? 0.13 : random.number(0.13, 1.0);  // squeezed
      for (Eigen::Index n = 0; n < now.nodes.cols(); ++n) now.nodes.col(n) += random.vector(2e-5);
      EXPECT_TRUE(pairContacts({{now, 0.0, rest.nodes}}, kFolds, 1e-4).empty());
    }
  }
}

}  // namespace tissue_pair_sheet_test
}  // namespace tissue_contact
