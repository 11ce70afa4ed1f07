/// Input checks and the block matrix.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

#include "support/refusal.h"
#include "tissue_contact/core/block_matrix.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/range.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

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
  EXPECT_EQ(K.columns, (std::vector<int>{1, 2, 3, 0, 2, 3, 0, 1, 3, 0, 1, 2}));
  EXPECT_EQ(K.row_start, (std::vector<int>{0, 3, 6, 9, 12, 12}));
  EXPECT_EQ(K.row_middle, (std::vector<int>{0, 4, 8, 12, 12}));
  EXPECT_EQ(K.find(2, 3), 8);
  EXPECT_EQ(K.find(1, 4), -1);
  EXPECT_EQ(K.find(4, 1), -1);
  EXPECT_EQ(K.find(1, 1), -1);
}

TEST(BlockMatrix, RowProductIsTheDenseOne) {
  BlockMatrix K = BlockMatrix::forTetrahedra({{0, 1, 2, 3}}, {false, false, false, false});
  NodalVectors v(3, 4);
  for (Eigen::Index i = 0; i < v.size(); ++i) v.data()[i] = 0.3 * static_cast<double>(i) - 1.0;
  Vector3 expected = Vector3::Zero();
  for (int k = K.row_start[2]; k < K.row_start[3]; ++k) {
    K.values[k] << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, k;
    expected += K.values[k] * v.col(K.columns[k]);
  }
  EXPECT_LE((K.offDiagonalProduct(2, v) - expected).norm(), 1e-14 * expected.norm());
  EXPECT_EQ(K.upperProduct(2, v), K.values[K.row_start[3] - 1] * v.col(3));
  EXPECT_LE((K.lowerProduct(2, v) + K.upperProduct(2, v) - expected).norm(), 1e-14 * expected.norm());
  K.setZero();
  EXPECT_EQ(K.offDiagonalProduct(2, v), Vector3::Zero());
}

}  // namespace
}  // namespace tissue_contact
