/// @file
/// MessageTimeRate: mean rate, jitter, reset, off.
#include "ros/publish/message_time_rate.h"

#include <gtest/gtest.h>

namespace tissue_contact {
namespace message_time_rate_test {

constexpr std::int64_t kSecond = 1000000000;

int countDue(double rate_hz, double message_rate_hz, std::int64_t start_ns, int messages) {
  MessageTimeRate rate(rate_hz);
  int due = 0;
  for (int i = 0; i < messages; ++i) {
    due += static_cast<int>(rate.due(start_ns + static_cast<std::int64_t>(i * 1e9 / message_rate_hz)));
  }
  return due;
}

TEST(MessageTimeRate, KeepsTheMeanRateWhateverTheMessageRate) {
  for (const double message_rate : {99.3, 100.0, 500.0, 1000.0}) {
    const int due = countDue(30.0, message_rate, 1644257420443579979, static_cast<int>(10.0 * message_rate));
    EXPECT_NEAR(due, 300, 1) << message_rate;
  }
}

TEST(MessageTimeRate, PublishesEveryMessageWhenAskedForMoreThanThereAre) {
  EXPECT_EQ(countDue(1000.0, 99.0, kSecond, 500), 500);
  EXPECT_EQ(countDue(1e300, 99.0, kSecond, 500), 500);
}

TEST(MessageTimeRate, ZeroIsOff) { EXPECT_EQ(countDue(0.0, 100.0, kSecond, 1000), 0); }

TEST(MessageTimeRate, VerySlowRateGivesTheFirstOnly) { EXPECT_EQ(countDue(1e-300, 100.0, kSecond, 1000), 1); }

TEST(MessageTimeRate, ALongPauseIsNotMadeUpFor) {
  MessageTimeRate rate(10.0);
  EXPECT_TRUE(rate.due(kSecond));
  EXPECT_TRUE(rate.due(100 * kSecond));
  EXPECT_FALSE(rate.due(100 * kSecond + 1));
}

TEST(MessageTimeRate, ResetMakesAnyStampDue) {
  MessageTimeRate rate(10.0);
  EXPECT_TRUE(rate.due(100 * kSecond));
  EXPECT_FALSE(rate.due(kSecond));
  rate.reset();
  EXPECT_TRUE(rate.due(kSecond));
  EXPECT_FALSE(rate.due(kSecond + kSecond / 20));
}

}  // namespace message_time_rate_test
}  // namespace tissue_contact
