/// The one parser of all tools' command lines.
#include "tissue_contact/core/command_line.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "support/refusal.h"

namespace tissue_contact {
namespace command_line_test {

using Words = std::vector<std::string>;

const CommandLine::Keys kKeys{{"--csv", "--size", "--steps"}, {"--quick"}, {"--case"}};

std::string refusal(const Words& arguments) {
  return tissue_contact::refusal([&] {
    const CommandLine line(arguments, kKeys);
    line.number("--size", 0.0, {0.0, 2.0, "m", "", true});
    line.integer("--steps", 0, 1, 9);
    line.required("--csv");
  });
}

TEST(CommandLine, BothFormsAreTheSame) {
  for (const Words& arguments : {Words{"--csv", "a=b", "--size", "1.5", "--case", "x", "--case=y", "--quick"},
                                 Words{"--quick", "--case", "x", "--case", "y", "--size=1.5", "--csv=a=b"}}) {
    const CommandLine line(arguments, kKeys);
    EXPECT_EQ(line.value("--csv"), "a=b");
    EXPECT_EQ(line.number("--size", 0.0, {0.0, 2.0}), 1.5);
    EXPECT_EQ(line.all("--case"), (Words{"x", "y"}));
    EXPECT_TRUE(line.has("--quick"));
    EXPECT_FALSE(line.help());
  }
}

TEST(CommandLine, WhatIsNotGivenHasItsDefault) {
  const CommandLine line({}, kKeys);
  EXPECT_EQ(line.value("--csv"), "");
  EXPECT_EQ(line.number("--size", 3.0, {0.0, 2.0}), 3.0);
  EXPECT_EQ(line.integer("--steps", 7, 1, 2), 7);
  EXPECT_TRUE(line.all("--case").empty());
  EXPECT_FALSE(line.has("--quick"));
}

TEST(CommandLine, ValuesMayBeNegativeOrHoldDashesInTheSecondForm) {
  EXPECT_EQ(CommandLine({"--size", "-1"}, kKeys).number("--size", 0.0, {-2.0, 2.0}), -1.0);
  EXPECT_EQ(CommandLine({"--csv=--odd"}, kKeys).value("--csv"), "--odd");
  EXPECT_EQ(CommandLine({"--csv", "-"}, kKeys).value("--csv"), "-");
}

TEST(CommandLine, HelpNeedsNothingElse) {
  for (const Words& arguments : {Words{"--help"}, Words{"--csv", "x", "-h"}, Words{"--help", "--odd"}}) {
    EXPECT_TRUE(CommandLine(arguments, kKeys).help());
  }
}

TEST(CommandLine, WordsAreTakenWhereTheyAreAllowed) {
  CommandLine::Keys keys = kKeys;
  keys.words = true;
  EXPECT_EQ(CommandLine({"a", "--quick", "b", "-"}, keys).words(), (Words{"a", "b", "-"}));
  EXPECT_THROW(CommandLine({"-x"}, keys), std::invalid_argument);
  EXPECT_THROW(CommandLine({"a"}, kKeys), std::invalid_argument);
}

TEST(CommandLine, RefusalsNameTheArgumentAndTheNearestKnownOne) {
  const std::string known = "known are --csv, --size, --steps, --case, --quick, --help";
  EXPECT_EQ(refusal({"--cvs", "x"}), "unknown argument '--cvs'; did you mean \"--csv\"? " + known);
  EXPECT_EQ(refusal({"--qick"}), "unknown argument '--qick'; did you mean \"--quick\"? " + known);
  EXPECT_EQ(refusal({"--qick=1"}), "unknown argument '--qick=1'; did you mean \"--quick\"? " + known);
  EXPECT_EQ(refusal({"--case-sensitivity"}), "unknown argument '--case-sensitivity'; " + known);
  EXPECT_EQ(refusal({"x.csv"}), "unknown argument 'x.csv'; " + known);
  EXPECT_EQ(refusal({""}), "unknown argument ''; " + known);
  EXPECT_EQ(refusal({"--quick=1"}), "argument --quick takes no value");
  EXPECT_EQ(refusal({"--quick", "--quick"}), "argument --quick is given twice");
  EXPECT_EQ(refusal({"--csv", "a", "--csv=b"}), "argument --csv is given twice");
  for (const Words& arguments : {Words{"--csv"}, Words{"--csv="}, Words{"--csv", ""}, Words{"--csv", "--quick"}}) {
    EXPECT_EQ(refusal(arguments), "argument --csv needs a value");
  }
  EXPECT_EQ(refusal({"--quick"}), "argument --csv is missing; see --help");
}

TEST(CommandLine, NumbersAreRefusedWithTheirRange) {
  for (const char* bad : {"0", "2.1", "nan", "inf", "-1", "1,5", "1s", "0x1", " 1"}) {
    EXPECT_EQ(refusal({"--size", bad}), "--size is '" + std::string(bad) + "'; it must be a number > 0 and <= 2 m");
  }
  for (const char* bad : {"0", "10", "1.0", "1e0", "99999999999999999999"}) {
    EXPECT_EQ(refusal({"--steps", bad}),
              "--steps is '" + std::string(bad) + "'; it must be a whole number from 1 to 9");
  }
}

}  // namespace command_line_test
}  // namespace tissue_contact
