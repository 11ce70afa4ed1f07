// Numbers from text, in the C locale and in one with a decimal comma.
#include "tissue_contact/core/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/comma_locale.h"

namespace tissue_contact {
namespace text_test {

void expectNumbers() {
  EXPECT_EQ(toDouble("0.5"), 0.5);
  EXPECT_EQ(toDouble("+1.25e-3"), 1.25e-3);
  EXPECT_EQ(toDouble("-7"), -7.0);
  EXPECT_EQ(toDouble("0.1"), 0.1);
  EXPECT_EQ(toDouble("1.7976931348623157e308"), std::numeric_limits<double>::max());
  EXPECT_EQ(toDouble("1e-310"), 1e-310);
  EXPECT_EQ(toDouble("-inf"), -HUGE_VAL);
  EXPECT_TRUE(std::isnan(toDouble("nan").value()));
  for (const char* const bad :
       {"", "+", "-", ".", " 1", "1 ", "1,5", "0x10", "--1", "+-1", "1e", "1e400", "1e-999", "0X1p3", "one", "1.5m"}) {
    EXPECT_FALSE(toDouble(bad)) << bad;
  }
  EXPECT_FALSE(toDouble(std::string_view("1\0", 2)));
  EXPECT_EQ(toInteger("+42"), 42);
  EXPECT_EQ(toInteger("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
  for (const char* const bad : {"", "+", "+-1", " 1", "1.0", "1e3", "9223372036854775808", "0x1"}) {
    EXPECT_FALSE(toInteger(bad)) << bad;
  }
}

TEST(NumbersInText, TakesWholeDecimalNumbersOnly) { expectNumbers(); }

TEST(NumbersInText, IsTheSameInALocaleWithADecimalComma) {
  const CommaLocale locale;
  if (!locale.isOn()) GTEST_SKIP() << "no locale with a decimal comma, and none can be made";
  expectNumbers();
}

TEST(TwoDigits, HaveNoExponentWherePeopleRead) {
  for (const auto& [value, text] : std::vector<std::pair<double, std::string>>{{0.0, "0"},
                                                                               {1.0, "1"},
                                                                               {164.0, "160"},
                                                                               {-164.0, "-160"},
                                                                               {99.6, "100"},
                                                                               {0.0234, "0.023"},
                                                                               {230.0, "230"},
                                                                               {7700.0, "7700"},
                                                                               {123456.0, "120000"}}) {
    EXPECT_EQ(twoDigits(value), text);
  }
  EXPECT_EQ(twoDigits(std::numeric_limits<double>::infinity()), "inf");
}

}  // namespace text_test
}  // namespace tissue_contact
