/// @file
/// Joints that are no longer named while others are: not those that pause with their topic, come rarely, or move to another topic.
#include "ros/joint_silence.h"

#include <gtest/gtest.h>

#include <vector>

namespace tissue_contact {
namespace joint_silence_test {

constexpr double kLongest_s = 2.0;

std::vector<std::size_t> joints(const std::vector<JointSilence::Silent>& silent) {
  std::vector<std::size_t> numbers;
  for (const JointSilence::Silent& one : silent) numbers.push_back(one.joint);
  return numbers;
}

using Numbers = std::vector<std::size_t>;

TEST(JointSilence, OneThatEndsIsSilentOncePerSilence) {
  JointSilence silence(kLongest_s);
  for (int i = 0; i <= 40; ++i) {
    silence.note(0, 0.1 * i, {0, 2});
    if (i <= 10) silence.note(0, 0.1 * i, {1});
    EXPECT_EQ(joints(silence.now()), i > 30 ? Numbers{1} : Numbers()) << i;
    EXPECT_EQ(joints(silence.takeNew()), i == 31 ? Numbers{1} : Numbers()) << i;
  }
  EXPECT_NEAR(silence.now()[0].silent_s, 3.0, 1e-9);
  silence.note(0, 4.0, {1});
  EXPECT_EQ(joints(silence.now()), Numbers());
  EXPECT_EQ(joints(silence.longest()), Numbers{1});
  for (int i = 41; i <= 65; ++i) silence.note(0, 0.1 * i, {0});
  EXPECT_EQ(joints(silence.takeNew()), (Numbers{1, 2}));
  EXPECT_NEAR(silence.longest()[0].silent_s, 3.0, 1e-9) << "the longer of the two";
}

TEST(JointSilence, APauseOfTheTopicOrAClockThatIsSetMakesNoneSilent) {
  for (const double later_s : {60.0, 3600.0, -60.0}) {
    JointSilence silence(kLongest_s);
    double now_s = 100.0;
    for (int i = 0; i < 100; ++i) silence.note(0, now_s += 0.01, {static_cast<std::size_t>(i % 2)});
    now_s += later_s;
    for (int i = 0; i < 50; ++i) silence.note(0, now_s += 0.01, {0});
    EXPECT_EQ(joints(silence.now()), Numbers()) << later_s;
  }
}

TEST(JointSilence, TwoClocksOnOneTopicMakeNoneSilent) {
  JointSilence silence(kLongest_s);
  for (int i = 0; i < 10000; ++i) {
    silence.note(0, 0.01 * i, {0});
    silence.note(0, 0.01 * i - 1.5, {1});
    EXPECT_EQ(joints(silence.now()), Numbers()) << i;
  }
}

/// Every 2.9 s: told once at the most, until it is known.
TEST(JointSilence, OneThatComesRarelyIsNotSilent) {
  JointSilence silence(kLongest_s);
  std::size_t told = 0;
  for (int i = 0; i < 600; ++i) {
    silence.note(0, 0.1 * i, {0});
    if (i % 29 == 0) silence.note(0, 0.1 * i, {1});
    told += silence.takeNew().size();
  }
  EXPECT_EQ(told, 1U);
  EXPECT_EQ(joints(silence.longest()), Numbers());
}

/// It stays where it was put, all the same.
TEST(JointSilence, OneThatIsNamedOnceIsSilent) {
  JointSilence silence(kLongest_s);
  silence.note(0, 0.0, {0, 1});
  for (int i = 0; i < 30; ++i) silence.note(0, 0.1 * i, {0});
  EXPECT_EQ(joints(silence.longest()), Numbers{1});
}

TEST(JointSilence, OneThatAnotherTopicNamesIsNotSilent) {
  JointSilence silence(kLongest_s);
  for (int i = 0; i < 100; ++i) {
    silence.note(0, 0.1 * i, i < 10 ? Numbers{0, 1} : Numbers{0});
    silence.note(1, 0.1 * i, {1});
  }
  EXPECT_EQ(joints(silence.longest()), Numbers());
}

}  // namespace joint_silence_test
}  // namespace tissue_contact
