/// What is said of a bag of which nothing was played.
#include <gtest/gtest.h>

#include "ros/bag/joint_state_bag.h"

namespace tissue_contact {
namespace nothing_played_test {

// Of a bag that has the jaw alone nothing was refused: the message ended in "the first was refused: ".
TEST(NothingPlayed, TellsWhy) {
  EXPECT_NE(nothingPlayed("a.bag", "too old: x").find("'a.bag' was accepted; the first was refused: too old: x"),
            std::string::npos);
  EXPECT_NE(nothingPlayed("a.bag", "").find("'a.bag' was played: those that are played only update joints"),
            std::string::npos);
}

}  // namespace nothing_played_test
}  // namespace tissue_contact
