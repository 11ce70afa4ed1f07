/// Input checks and the block matrix.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/refusal.h"
#include "tissue_contact/core/block_matrix.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/range.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace core_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Check, RefusesNanInfinityAndValuesOutOfRange) {
  for (const double bad : {kNan, kInfinity, 0.0, -1.0}) EXPECT_THROW(requirePositive("x", bad), std::invalid_argument);
  for (const double bad : {kNan, kInfinity, -1.0}) EXPECT_THROW(requireNonNegative("x", bad), std::invalid_argument);
  for (const double bad : {kNan, kInfinity, -kInfinity}) EXPECT_THROW(requireFinite("x", bad), std::invalid_argument);
  EXPECT_EQ(requirePositive("x", 2.0), 2.0);
  EXPECT_EQ(requireNonNegative("x", 0.0), 0.0);
}

TEST(Range, HoldsItsBoundsUnlessExcludedAndNeverNan) {
  for (const double inside : {0.0, 0.5, 1.0}) EXPECT_TRUE((Range{0.0, 1.0}.contains(inside)));
  for (const double bad : {kNan, kInfinity, -0.1, 1.1}) EXPECT_FALSE((Range{0.0, 1.0}.contains(bad)));
  for (const double bad : {kNan, 0.0, 1.0}) EXPECT_FALSE((Range{0.0, 1.0, "", "", true, true}.contains(bad)));
  EXPECT_EQ((Range{0.0, 1.0}.require("x", 0.5)), 0.5);
}

TEST(Range, MessageNamesThingValueUnitRangeAndFix) {
  const Range range{-1.0, 0.5, "m", "give metres", true};
  EXPECT_EQ(refusal([&] { range.require("length_m", 0.7); }),
            "length_m is 0.69999999999999996 m; it must be > -1 and <= 0.5 m; give metres");
}

TEST(Printable, KeepsNamesShortAndFreeOfControlCharacters) {
  EXPECT_EQ(printable("wrist\xc3\xa9"), "wrist\xc3\xa9");
  EXPECT_EQ(printable("a\nb\x1b[0m\x7f"), "a?b?[0m?");
  EXPECT_EQ(printable(std::string(60, 'x')), std::string(60, 'x'));
  EXPECT_EQ(printable(std::string(61, 'x')), std::string(60, 'x') + "...");
  EXPECT_EQ(printable("abcd", 2), "ab...");
  EXPECT_EQ(listOf({}), "");
  EXPECT_EQ(listOf({"a", "b\t"}), "a, b?");
  EXPECT_EQ(listOf({"a", "b", "c"}, 2), "a, b, ...");
  EXPECT_EQ(printable("wrist\xc3\xa9", 6), "wrist...") << "a cut character would spoil the whole line";
  EXPECT_EQ(inQuotes("a\n"), "\"a?\"");
  EXPECT_EQ(stampText(1234567890000000001), "1234567890.000000001");
}

TEST(NearestWord, HasABound) {
  EXPECT_EQ(nearestWord("left/description", {"robot_description"}), "robot_description");
  EXPECT_EQ(nearestWord("left/description", {"robot_description"}, 2), "");
  EXPECT_EQ(nearestWord("sceen", {"scene"}, 2), "scene");
}

// Two tetrahedra sharing the face (1, 2, 3); node 4 fixed.
TEST(BlockMatrix, HasABlockForEveryPairOfFreeNeighbours) {
  const BlockMatrix K = BlockMatrix::forTetrahedra({{0, 1, 2, 3}, {1, 2, 3, 4}}, {false, false, false, false, true});
  ASSERT_EQ(K.rows(), 5);
  for (int i = 0; i < 5; ++i) {
    std::vector<int> columns;
    K.pattern->forRow(i, [&](int j, int place) {
      columns.push_back(j);
      EXPECT_EQ(place, K.pattern->find(i, j));
    });
    std::vector<int> expected;
    for (int j = 0; j < 4; ++j) {
      if (i < 4 && j != i) expected.push_back(j);
    }
    EXPECT_EQ(columns, expected) << "row " << i;
    EXPECT_EQ(K.pattern->find(i, i), -1);
    EXPECT_EQ(K.pattern->find(i, 4), -1);
  }
}

TEST(BlockMatrix, StoresMirrorImagesOnce) {
  BlockMatrix K = BlockMatrix::forTetrahedra({{0, 1, 2, 3}}, {false, false, false, false});
  Matrix3 block;
  block << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0;
  K.add(K.pattern->find(1, 2), block);
  EXPECT_EQ(K.block(K.pattern->find(1, 2)), block);
  EXPECT_EQ(K.block(K.pattern->find(2, 1)), block.transpose());
  K.add(K.pattern->find(2, 1), block);
  EXPECT_EQ(K.block(K.pattern->find(1, 2)), block + block.transpose());
  NodalVectors v(3, 4);
  for (Eigen::Index i = 0; i < v.size(); ++i) v.data()[i] = 0.3 * static_cast<double>(i) - 1.0;
  const Vector3 expected = (block + block.transpose()) * v.col(1);
  EXPECT_LE((K.offDiagonalProduct(2, v) - expected).norm(), 1e-14 * expected.norm());
  BlockMatrix other(K.pattern), sum(K.pattern);
  other.add(K.pattern->find(1, 2), Matrix3::Identity());
  other.diagonal[3] = block;
  K.diagonal[3] = Matrix3::Identity();
  sum.setSum(2.0, K, -1.0, other);
  EXPECT_EQ(sum.block(K.pattern->find(1, 2)), 2.0 * K.block(K.pattern->find(1, 2)) - Matrix3::Identity());
  EXPECT_EQ(sum.diagonal[3], 2.0 * Matrix3::Identity() - block);
  K.setZero();
  EXPECT_EQ(K.offDiagonalProduct(2, v), Vector3::Zero());
}

// What lets a sweep go slice by slice: nodes of a slice are no neighbours, and earlier neighbours lie in earlier slices.
TEST(BlockPattern, SlicesKeepTheOrderOfNeighbours) {
  const TetMesh mesh = makeBlockMesh({Vector3(0.05, 0.04, 0.03), {5, 4, 3}, {}});
  std::vector<bool> fixed(static_cast<std::size_t>(mesh.positions.cols()), false);
  fixed[7] = fixed[20] = true;
  const auto pattern = BlockPattern::forElements(mesh.tetrahedra, fixed);
  const auto sliceOf = [&](int node) { return pattern->lane_of[node] / BlockPattern::kRows; };
  for (int i = 0; i < pattern->nodes; ++i) {
    EXPECT_EQ(pattern->rows[pattern->lane_of[i]], i);
    pattern->forRow(i, [&](int j, int /*place*/) { EXPECT_EQ(sliceOf(j) < sliceOf(i), j < i) << i << ", " << j; });
  }
  EXPECT_LE(pattern->slices(), pattern->nodes / 3);  // most are full
}

}  // namespace core_test
}  // namespace tissue_contact
