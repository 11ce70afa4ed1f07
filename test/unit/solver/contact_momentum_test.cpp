/// How much momentum contacts bring to nodes: what contacts of one node bear together, and what opposed ones do not take from each other.
#include "solver/contact_momentum.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace tissue_contact {
namespace contact_momentum_test {

/// A contact along `normal`, with equal weights of that sum on some nodes.
ContactRow contactOn(const std::vector<int>& nodes, const Vector3& normal, double sum = 1.0) {
  ContactRow row;
  for (const int node : nodes) row.nodes[row.node_count++] = {0, node, sum / static_cast<double>(nodes.size())};
  const Vector3 t = normal.unitOrthogonal();
  row.R_WC << normal, t, normal.cross(t);
  return row;
}

struct Measured {
  std::vector<bool> fixed = {false, false, false, true};
  ContactProblem problem;
  ContactMomentum momentum;

  explicit Measured(const std::vector<ContactRow>& rows) {
    problem.bodies.resize(3);
    for (BodySystem& body : problem.bodies) body.fixed = &fixed;
    problem.bodies[2].asleep = true;
    problem.contacts = rows;
    momentum.prepare(problem);
  }
  double change(const std::vector<Vector3>& before, const std::vector<Vector3>& after) {
    return momentum.change(problem, before, after);
  }
  double fromNone(const std::vector<Vector3>& after) {
    return change(std::vector<Vector3>(after.size(), Vector3::Zero()), after);
  }
};

const Vector3 kUp = Vector3::UnitZ();
const Vector3 kOne(1.0, 0.0, 0.0);  // normal, contact frame
const Vector3 kNone = Vector3::Zero();

TEST(ContactMomentum, IsTheImpulsesWhereEachHasANodeOfItsOwn) {
  Measured two({contactOn({0}, kUp), contactOn({1}, kUp)});
  EXPECT_DOUBLE_EQ(two.fromNone({Vector3(3.0, 0.0, 0.0), Vector3(0.0, 4.0, 0.0)}), 5.0);
}

TEST(ContactMomentum, OfAFaceIsSharedByItsCorners) {
  Measured face({contactOn({0, 1, 2}, kUp)});
  EXPECT_NEAR(face.fromNone({kOne}), 1.0 / std::sqrt(3.0), 1e-15);
}

// The face takes over what its corners have borne: nothing changes for the nodes.
TEST(ContactMomentum, DoesNotChangeWithWhoBearsIt) {
  Measured all({contactOn({0, 1, 2}, kUp), contactOn({0}, kUp), contactOn({1}, kUp), contactOn({2}, kUp)});
  const std::vector<Vector3> corners = {kNone, kOne, kOne, kOne};
  const std::vector<Vector3> face = {3.0 * kOne, kNone, kNone, kNone};
  EXPECT_NEAR(all.change(corners, face), 0.0, 1e-15);
  EXPECT_NEAR(all.fromNone(corners), std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(all.fromNone(face), std::sqrt(3.0), 1e-15);
}

TEST(ContactMomentum, OfJawsThatPressANodeFromOpposedSidesIsThatOfBoth) {
  Measured jaws({contactOn({0}, kUp), contactOn({0}, -kUp)});
  EXPECT_DOUBLE_EQ(jaws.change({kOne, kOne}, {4.0 * kOne, 5.0 * kOne}), 5.0);
}

TEST(ContactMomentum, OfTwoInstrumentsOnANodeIsThatOfBoth) {
  ContactRow other = contactOn({0}, kUp);
  other.pair = 1;
  Measured tools({contactOn({0}, kUp), other});
  EXPECT_DOUBLE_EQ(tools.change({3.0 * kOne, kNone}, {kNone, 3.0 * kOne}), std::sqrt(18.0));
}

// Normals a little apart: the changes (1, 0, 0) along each are no change together but for what these angles leave.
TEST(ContactMomentum, IsThatOfWorldAxes) {
  Measured tilted(
      {contactOn({0}, Vector3(0.3, 0.0, 1.0).normalized()), contactOn({0}, Vector3(-0.3, 0.0, 1.0).normalized())});
  EXPECT_NEAR(tilted.change({kOne, kNone}, {kNone, kOne}), 0.6 / std::sqrt(1.09), 1e-15);
}

// A tissue presses down on a node (its row's normal points into the other tissue, the node's weight is negative), and so does a second such
// contact; one from below is the other side.
TEST(ContactMomentum, KnowsTheSideOfANegativeWeight) {
  Measured all({contactOn({0}, kUp, -1.0), contactOn({0}, -kUp)});
  EXPECT_NEAR(all.change({kOne, kNone}, {kNone, kOne}), 0.0, 1e-15);
}

TEST(ContactMomentum, IsNoneOfNodesThatCannotMove) {
  ContactRow pair = contactOn({0, 3}, kUp, 2.0);
  pair.nodes[pair.node_count++] = {2, 0, -1.0};
  Measured one({pair});
  EXPECT_DOUBLE_EQ(one.fromNone({kOne}), 1.0);
}

TEST(ContactMomentum, TellsBodiesApart) {
  ContactRow other = contactOn({0}, kUp);
  other.nodes[0].body = 1;
  Measured bodies({contactOn({0}, kUp), other});
  EXPECT_DOUBLE_EQ(bodies.change({kOne, kNone}, {kNone, kOne}), std::sqrt(2.0));
}

TEST(ContactMomentum, OfThreeThatLockANodeIsNotNothing) {
  const double c = std::cos(M_PI / 3.0);
  const double d = std::sin(M_PI / 3.0);
  Measured three({contactOn({0}, Vector3(1.0, 0.0, 0.0)), contactOn({0}, Vector3(-c, d, 0.0)),
                  contactOn({0}, Vector3(-c, -d, 0.0))});
  EXPECT_NEAR(three.change({kOne, kOne, kOne}, {2.0 * kOne, 2.0 * kOne, 2.0 * kOne}), std::sqrt(2.0), 1e-15);
}

// Of two tissues the lower one sees a normal that points away from it with a negative weight.
TEST(ContactMomentum, OfTwoBodiesIsThatOfBoth) {
  ContactRow pair = contactOn({0}, kUp);
  pair.nodes[pair.node_count++] = {1, 0, -1.0};
  Measured both({pair, pair});
  EXPECT_NEAR(both.change({kOne, kNone}, {kNone, kOne}), 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(both.fromNone({kOne, kNone}), std::sqrt(2.0));
}

TEST(ContactMomentum, KnowsThisStepAlone) {
  Measured first({contactOn({0, 1, 2}, kUp), contactOn({0}, kUp)});
  first.problem.contacts = {contactOn({2}, kUp)};
  first.momentum.prepare(first.problem);
  EXPECT_DOUBLE_EQ(first.fromNone({2.0 * kOne}), 2.0);
  first.problem.contacts.clear();
  first.momentum.prepare(first.problem);
  EXPECT_EQ(first.fromNone({}), 0.0);
}

}  // namespace contact_momentum_test
}  // namespace tissue_contact
