/// What contacts inherit from the step before, and which points are kept.
#include "simulation/contact_memory.h"

#include <gtest/gtest.h>

#include "support/text_scene.h"
#include "tissue_contact/instrument/parse_urdf.h"

namespace tissue_contact {
namespace contact_memory_test {

Contact makeContact(int shape, std::array<int, 3> feature, const Vector3& p_W) {
  Contact contact;
  contact.key.tissue = 0;
  contact.key.instrument = 0;
  contact.key.link = 0;
  contact.key.shape = shape;
  contact.key.feature = feature;
  contact.nodes = {0, 1, 2};
  contact.weights = Vector3(0.2, 0.3, 0.5);
  contact.p_WC = p_W;
  return contact;
}

SolvedContact carrying(double newton, const Contact& contact) {
  return {contact, ContactState::kKinetic, Vector3(0.0, 0.0, newton)};
}

std::vector<SolvedContact> carrying(double newton, const std::vector<Contact>& contacts) {
  std::vector<SolvedContact> solved;
  for (const Contact& contact : contacts) solved.push_back(carrying(newton, contact));
  return solved;
}

void recallWithin(double reach_m, ContactMemory& memory, const std::vector<Contact>& contacts,
                  std::vector<SolvedContact>& inherited) {
  memory.recall(contacts, std::vector<double>(contacts.size(), reach_m), inherited);
}

TEST(ContactMemory, SameKeyInheritsForceAndState) {
  ContactMemory memory;
  const std::vector<Contact> contacts = {makeContact(0, {0, 1, 2}, Vector3::Zero()),
                                         makeContact(0, {1, 2, 3}, Vector3::UnitX())};
  memory.remember({carrying(1.0, contacts[0]), carrying(2.0, contacts[1])});
  std::vector<SolvedContact> inherited;
  recallWithin(0.0, memory, contacts, inherited);
  ASSERT_EQ(inherited.size(), 2u);
  EXPECT_EQ(inherited[0].force_on_tissue_n.z(), 1.0);
  EXPECT_EQ(inherited[1].force_on_tissue_n.z(), 2.0);
  EXPECT_EQ(inherited[1].state, ContactState::kKinetic);
}

TEST(ContactMemory, SlidingOntoTheNextTriangleKeepsTheHistory) {
  ContactMemory memory;
  memory.remember({carrying(1.0, makeContact(0, {0, 1, 2}, Vector3::Zero()))});
  std::vector<SolvedContact> inherited;
  recallWithin(1.0, memory, {makeContact(0, {1, 2, 3}, Vector3(0.5, 0.0, 0.0))}, inherited);
  EXPECT_EQ(inherited[0].force_on_tissue_n.z(), 1.0);
  // Too far, and of another shape: nothing to continue.
  recallWithin(0.4, memory, {makeContact(0, {1, 2, 3}, Vector3(0.5, 0.0, 0.0))}, inherited);
  EXPECT_EQ(inherited[0].state, ContactState::kOpen);
  recallWithin(1.0, memory, {makeContact(1, {1, 2, 3}, Vector3(0.5, 0.0, 0.0))}, inherited);
  EXPECT_EQ(inherited[0].state, ContactState::kOpen);
}

TEST(ContactMemory, AnOldContactIsContinuedOnlyOnce) {
  ContactMemory memory;
  memory.remember({carrying(1.0, makeContact(0, {0, 1, 2}, Vector3::Zero()))});
  std::vector<SolvedContact> inherited;
  recallWithin(1.0, memory,
               {makeContact(0, {1, 2, 3}, Vector3(0.1, 0.0, 0.0)), makeContact(0, {2, 3, 4}, Vector3(0.2, 0.0, 0.0))},
               inherited);
  EXPECT_EQ(inherited[0].force_on_tissue_n.z() + inherited[1].force_on_tissue_n.z(), 1.0);
}

// Two patches have each slid onto another triangle: the nearest pair first, whichever key comes first.
TEST(ContactMemory, NearestContactsAreMatchedWhateverTheirOrder) {
  ContactMemory memory;
  const Vector3 near = 0.1 * Vector3::UnitX();
  const Vector3 far = 0.45 * Vector3::UnitX();
  for (const bool near_first : {true, false}) {
    memory.remember({carrying(1.0, makeContact(0, {0, 1, 2}, Vector3::Zero())),
                     carrying(2.0, makeContact(0, {1, 2, 3}, Vector3::UnitX()))});
    std::vector<SolvedContact> inherited;
    recallWithin(
        2.0, memory,
        {makeContact(0, {2, 3, 4}, near_first ? near : far), makeContact(0, {3, 4, 5}, near_first ? far : near)},
        inherited);
    EXPECT_EQ(inherited[near_first ? 0 : 1].force_on_tissue_n.z(), 1.0) << near_first;
    EXPECT_EQ(inherited[near_first ? 1 : 0].force_on_tissue_n.z(), 2.0) << near_first;
  }
}

TEST(ContactMemory, EachContactHasAReachOfItsOwn) {
  ContactMemory memory;
  memory.remember({carrying(1.0, makeContact(0, {0, 1, 2}, Vector3::Zero()))});
  std::vector<SolvedContact> inherited;
  memory.recall({makeContact(0, {1, 2, 3}, Vector3(0.2, 0.0, 0.0)), makeContact(0, {2, 3, 4}, Vector3(0.3, 0.0, 0.0))},
                {0.1, 0.4}, inherited);
  EXPECT_EQ(inherited[0].state, ContactState::kOpen);
  EXPECT_EQ(inherited[1].force_on_tissue_n.z(), 1.0);
}

TEST(ContactMemory, OpenContactsAndClearedOnesAreForgotten) {
  ContactMemory memory;
  const std::vector<Contact> contacts = {makeContact(0, {0, 1, 2}, Vector3::Zero())};
  std::vector<SolvedContact> inherited;
  memory.remember({{contacts[0], ContactState::kOpen, Vector3::UnitZ()}});
  recallWithin(1.0, memory, contacts, inherited);
  EXPECT_EQ(inherited[0].force_on_tissue_n, Vector3::Zero());
  memory.remember(carrying(1.0, contacts));
  memory.clear();
  recallWithin(1.0, memory, contacts, inherited);
  EXPECT_EQ(inherited[0].force_on_tissue_n, Vector3::Zero());
}

/// A sphere of 1 m over a face of three nodes; its centre can be moved.
class KeptPoints : public ::testing::Test {
 protected:
  KeptPoints() {
    positions[0] << -1.0, 1.0, 0.0, -1.0, -1.0, 1.0, 0.0, 0.0, 0.0;
    InstrumentDescription description;
    description.name = "probe";
    description.tip_link = "tip";
    description.joint_state_topics = {{"/joint_states"}};
    description.contact_links = {{"tip", {}}};
    instruments.emplace_back(description, parseUrdf(probeUrdf(1.0), "test", "", nullptr), Pose::Identity());
    TissueSurface surface;
    surface.triangles = {{0, 1, 2}};
    surface.fixed = {false, false, false};
    detector = std::make_unique<ContactDetector>(instruments, shareSurfaces({surface}, positions));
  }

  std::vector<Contact> detectAt(double x) {
    instruments[0].linkPoses(Vector3(x, -0.3, 1.0), X_WL[0]);
    std::vector<Contact> contacts;
    detector->detect(positions, X_WL, 0.1, contacts);
    memory.addKeptPoints(*detector, positions, X_WL, {0.1}, contacts);
    return contacts;
  }

  std::vector<NodalVectors> positions{NodalVectors(3, 3)};
  std::vector<Instrument> instruments;
  std::unique_ptr<ContactDetector> detector;
  std::vector<std::vector<Pose>> X_WL{1};
  ContactMemory memory;
};

TEST_F(KeptPoints, APointThatCarriedForceStaysBesideTheNewClosestPoint) {
  const std::vector<Contact> first = detectAt(0.0);
  ASSERT_EQ(first.size(), 1u);
  memory.remember(carrying(1.0, first));
  const std::vector<Contact> second = detectAt(0.2);
  ASSERT_EQ(second.size(), 2u);
  EXPECT_EQ(second[0].key.slot, 0);
  EXPECT_EQ(second[1].key.slot, 1);
  EXPECT_EQ(second[1].weights, first[0].weights);
  EXPECT_NEAR(second[1].gap_m, std::sqrt(1.04) - 1.0, 1e-14);  // the sphere has moved 0.2 m along a flat face
  std::vector<SolvedContact> inherited;
  recallWithin(0.0, memory, second, inherited);
  EXPECT_EQ(inherited[0].state, ContactState::kOpen);
  EXPECT_EQ(inherited[1].force_on_tissue_n.z(), 1.0);  // the force stays with its point
}

TEST_F(KeptPoints, AFreshPointAtTheSamePlaceContinuesTheOldOne) {
  memory.remember(carrying(1.0, detectAt(0.0)));
  const std::vector<Contact> second = detectAt(0.01);
  ASSERT_EQ(second.size(), 1u);
  std::vector<SolvedContact> inherited;
  recallWithin(0.0, memory, second, inherited);
  EXPECT_EQ(inherited[0].force_on_tissue_n.z(), 1.0);
}

// On a line of contact the closest point is anywhere on it: it would leave a new point to keep in every step.
TEST_F(KeptPoints, AFreshPointAsDeepAsAKeptOneIsLeftOut) {
  const Contact kept = detectAt(0.0).at(0);
  const auto besideAFresh = [&](double deeper_m) {
    memory.remember({carrying(1.0, kept)});
    Contact fresh = kept;
    fresh.weights = Vector3(0.1, 0.4, 0.5);
    fresh.p_WC += 0.3 * Vector3::UnitX();
    fresh.gap_m -= deeper_m;
    std::vector<Contact> contacts = {fresh};
    memory.addKeptPoints(*detector, positions, X_WL, {0.1}, contacts);
    return contacts;
  };
  const double level_m = 0.3 * ContactMemory::kFlushSlope;
  for (const double share : {1.1, -1.1}) EXPECT_EQ(besideAFresh(share * level_m).size(), 2u);
  for (const double share : {0.9, 0.0, -0.9}) {
    const std::vector<Contact> contacts = besideAFresh(share * level_m);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_EQ(contacts[0].weights, kept.weights);
    EXPECT_EQ(contacts[0].key.slot, 1);
    std::vector<SolvedContact> inherited;
    recallWithin(0.0, memory, contacts, inherited);
    EXPECT_EQ(inherited[0].force_on_tissue_n.z(), 1.0);
  }
}

TEST_F(KeptPoints, PointsAreDroppedOnceFarOrWithoutForceAndNeverMoreThanTheBound) {
  memory.remember(carrying(1.0, detectAt(0.0)));
  EXPECT_EQ(detectAt(0.5).size(), 1u);  // old point 0.118 m away: beyond the margin
  memory.remember({SolvedContact{detectAt(0.0).at(0)}});
  EXPECT_EQ(detectAt(0.2).size(), 1u);
  for (int k = 0; k < 10; ++k) {
    const std::vector<Contact> contacts = detectAt(k % 2 == 0 ? -0.02 * k : 0.02 * k);
    EXPECT_LE(contacts.size(), 1u + ContactMemory::kKeptPoints);
    memory.remember(carrying(1.0, contacts));
  }
}

// Two old points near the fresh one: the nearer goes on in it, and nobody inherits from the other.
TEST_F(KeptPoints, OfTwoPointsAtTheFreshOneOnlyTheNearerGoesOn) {
  for (const bool first_is_nearer : {true, false}) {
    std::vector<SolvedContact> before = {carrying(1.0, detectAt(first_is_nearer ? 0.01 : 0.03).at(0)),
                                         carrying(2.0, detectAt(first_is_nearer ? -0.03 : -0.01).at(0))};
    before[1].contact.key.slot = 1;
    memory.remember(before);
    std::vector<Contact> contacts = detectAt(0.0);
    ASSERT_EQ(contacts.size(), 1u);
    contacts.push_back(makeContact(0, {1, 2, 3}, contacts[0].p_WC));  // could have been reached by either
    std::vector<SolvedContact> inherited;
    recallWithin(1.0, memory, contacts, inherited);
    EXPECT_EQ(inherited[0].force_on_tissue_n.z(), first_is_nearer ? 1.0 : 2.0);
    EXPECT_EQ(inherited[1].state, ContactState::kOpen);
    memory.clear();
  }
}

// The closest point has moved on to where a kept one is, while all slots are in use: the point it has left is kept.
TEST_F(KeptPoints, AFullFeatureHandsEachHistoryToItsOwnPoint) {
  std::vector<SolvedContact> before;
  for (const double x : {0.0, 0.3, -0.1, 0.1}) {
    before.push_back(carrying(1.0 + 10.0 * x, detectAt(x).at(0)));
    before.back().contact.key.slot = static_cast<int>(before.size()) - 1;
  }
  memory.remember(before);
  const std::vector<Contact> contacts = detectAt(0.1);
  ASSERT_EQ(contacts.size(), 4u);
  std::vector<SolvedContact> inherited;
  recallWithin(0.0, memory, contacts, inherited);
  for (const SolvedContact& contact : inherited) {
    EXPECT_NEAR(contact.force_on_tissue_n.z(), 1.0 + 10.0 * contact.contact.p_WC.x(), 1e-12);
  }
}

// A point on the ridge between two faces is a contact as long as one of them faces the tool, whichever comes first.
TEST(KeptRidgePoint, DoesNotDependOnTriangleOrder) {
  InstrumentDescription description;
  description.name = "probe";
  description.tip_link = "tip";
  description.joint_state_topics = {{"/joint_states"}};
  description.contact_links = {{"tip", {}}};
  std::vector<Instrument> instruments;
  instruments.emplace_back(description, parseUrdf(probeUrdf(1.0), "test", "", nullptr), Pose::Identity());
  // Face (0, 1, 2) looks up; face (1, 0, 3) hangs down and looks along -y. They share the edge 0-1.
  std::vector<NodalVectors> positions(1, NodalVectors(3, 4));
  positions[0] << -1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  std::vector<std::vector<Pose>> X_WL(1);
  instruments[0].linkPoses(Vector3(0.0, 0.0, 1.0), X_WL[0]);
  for (const bool up_first : {true, false}) {
    TissueSurface surface;
    surface.triangles = {{0, 1, 2}, {1, 0, 3}};
    if (!up_first) std::swap(surface.triangles[0], surface.triangles[1]);
    surface.fixed.assign(4, false);
    ContactDetector detector(instruments, shareSurfaces({surface}, positions));
    Contact contact = makeContact(0, {0, 1, -1}, Vector3::Zero());
    contact.nodes = surface.triangles[0];
    contact.weights = Vector3(0.5, 0.5, 0.0);
    EXPECT_TRUE(detector.measure(positions, X_WL, 0.1, contact)) << up_first;
    EXPECT_NEAR(contact.gap_m, 0.0, 1e-14);
  }
}

}  // namespace contact_memory_test
}  // namespace tissue_contact
