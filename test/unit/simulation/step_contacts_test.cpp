/// What contacts do to a tissue in all: the measure of how hard its sleepers may be held.
#include "simulation/step_contacts.h"

#include <gtest/gtest.h>

namespace tissue_contact {
namespace step_contacts_test {

/// Normal along z: the impulse is on `tissue`.
SolvedContact between(int tissue, int other_tissue, int instrument = -1) {
  SolvedContact contact;
  contact.contact.key.tissue = tissue;
  contact.contact.key.other_tissue = other_tissue;
  contact.contact.key.instrument = instrument;
  contact.contact.R_WC << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  return contact;
}

// Two tissues press each other: a vertex of each in a face of the other.
TEST(SumImpulsesOn, CountsEachContactOnTheSideItActsOn) {
  const std::vector<SolvedContact> contacts = {between(0, 1), between(1, 0)};
  const std::vector<Vector3> impulses = {Vector3(2.0, 0.5, 0.0), Vector3(-3.0, 0.0, 0.25)};
  std::vector<NetImpulse> net;
  sumImpulsesOn(0, contacts, impulses, net);
  ASSERT_EQ(net.size(), 1u);
  EXPECT_EQ(net[0].other_tissue, 1);
  EXPECT_EQ(net[0].impulse_W, Vector3(0.5, -0.25, 5.0));
  sumImpulsesOn(1, contacts, impulses, net);
  ASSERT_EQ(net.size(), 1u);
  EXPECT_EQ(net[0].other_tissue, 0);
  EXPECT_EQ(net[0].impulse_W, Vector3(-0.5, 0.25, -5.0));
}

TEST(SumImpulsesOn, KeepsPartnersApartAndLeavesOutFoldsAndWhatDoesNothing) {
  const std::vector<SolvedContact> contacts = {between(0, -1, 0), between(0, -1, 1), between(0, 2),
                                               between(0, 0),     between(2, 1),     between(0, -1, 0)};
  const Vector3 push(1.0, 0.0, 0.0);
  std::vector<NetImpulse> net;
  sumImpulsesOn(0, contacts, {push, Vector3::Zero(), -push, push, push, push}, net);
  ASSERT_EQ(net.size(), 2u);
  EXPECT_EQ(net[0].instrument, 0);
  EXPECT_EQ(net[0].impulse_W.z(), 2.0);
  EXPECT_EQ(net[1].instrument, -1);
  EXPECT_EQ(net[1].other_tissue, 2);
  EXPECT_EQ(net[1].impulse_W.z(), -1.0);
}

}  // namespace step_contacts_test
}  // namespace tissue_contact
