/// Lists and counts of a scene file that no scene needs are refused while it is parsed, with line and key path.
#include <string>

#include "scene_fixture.h"

namespace tissue_contact {
namespace list_limits_test {

/// `entry` so many times, # replaced by a number, commas in between.
std::string listOf(const std::string& entry, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) {
    std::string one = entry;
    for (std::size_t at = one.find('#'); at != std::string::npos; at = one.find('#')) {
      one.replace(at, 1, std::to_string(i));
    }
    all += (i == 0 ? "" : ", ") + one;
  }
  return "[" + all + "]";
}

/// The smallest scene with `lines` below its tissue and its instrument.
std::string scene(const std::string& of_tissue, const std::string& of_instrument, const std::string& top = "") {
  return "tissues:\n  - name: pad\n    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}\n"
         "    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.45, density_kg_per_m3: 1000}\n" +
         of_tissue + "instruments:\n  - name: arm\n    tip_link: tip\n" + of_instrument + top;
}

const std::string kLinks = "    contact_links: [tip]\n";
const std::string kSphere = "{sphere: {center_m: [0, 0, 0], radius_m: 1}}";

using ListLimitsTest = SceneTest;

TEST_F(ListLimitsTest, OfTopics) {
  const auto topics = [](int count) { return "    joint_state_topics: " + listOf("/t#", count) + "\n" + kLinks; };
  EXPECT_NO_THROW(parse(scene("", topics(100))));
  expectRefusedAt(scene("", topics(101)), "8: instruments[0].joint_state_topics",
                  "has 101 elements; at most 100 are allowed");
  expectRefusedAt(scene("", topics(100000)), "1: scene", "more than 100000 values");
}

TEST_F(ListLimitsTest, OfTissuesAndInstruments) {
  const std::string material = "material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}";
  const std::string one = "{name: t#, block: {size_m: [1, 1, 1], cells: [1, 1, 1]}, " + material + "}";
  EXPECT_NO_THROW(parse("tissues: " + listOf(one, 100) + "\n"));
  expectRefusedAt("tissues: " + listOf(one, 101) + "\n", "1: tissues", "at most 100 are allowed");
  const std::string arms = "tissues: " + listOf(one, 1) +
                           "\ninstruments: " + listOf("{name: i#, tip_link: tip, contact_links: [tip]}", 10000);
  expectRefusedAt(arms, "2: instruments", "has 10000 elements; at most 100 are allowed");
}

TEST_F(ListLimitsTest, OfLinksAndShapes) {
  expectRefusedAt(scene("", "    contact_links: " + listOf("l#", 1001) + "\n"), "8: instruments[0].contact_links",
                  "at most 1000 are allowed");
  expectRefusedAt(
      scene("", "    contact_links: [{link: tip, shapes: " + listOf("{sphere: {radius_m: 1}}", 1001) + "}]\n"),
      "8: instruments[0].contact_links[0].shapes", "at most 1000 are allowed");
}

TEST_F(ListLimitsTest, OfPlaces) {
  expectRefusedAt(scene("    fixed: " + listOf(kSphere, 1001) + "\n", kLinks), "5: tissues[0].fixed",
                  "at most 1000 are allowed");
  const std::string regions = "    regions:\n      - {name: a, where: " + listOf(kSphere, 600) +
                              "}\n      - {name: b, where: " + listOf(kSphere, 600) + "}\n";
  expectRefusedAt(scene(regions, kLinks), "7: tissues[0].regions[1]", "have 1200 places");
  const std::string attachments = "    attachments:\n      - {stiffness_n_per_m: 1, where: " + listOf(kSphere, 600) +
                                  "}\n      - {stiffness_n_per_m: 1, where: " + listOf(kSphere, 600) + "}\n";
  expectRefusedAt(scene(attachments, kLinks), "7: tissues[0].attachments[1]", "have 1200 places");
  expectRefusedAt(scene("    pressure_pa: 1\n    pressure_where: " + listOf(kSphere, 1001) + "\n", kLinks),
                  "6: tissues[0].pressure_where", "at most 1000 are allowed");
}

TEST_F(ListLimitsTest, OfPairs) {
  expectRefusedAt(scene("", kLinks, "friction: " + listOf("{}", 10001) + "\n"), "9: friction",
                  "at most 10000 are allowed");
  expectRefusedAt(scene("", kLinks, "tissue_pairs: " + listOf("{}", 10001) + "\n"), "9: tissue_pairs",
                  "at most 10000 are allowed");
}

TEST_F(ListLimitsTest, OfCountsAndTexts) {
  for (const char* cells : {"2147483648", "-1", "1e400", "99999999999999999999"}) {
    const std::string yaml =
        replaced(scene("", kLinks), "cells: [2, 2, 1]", "cells: [2, " + std::string(cells) + ", 1]");
    expectRefusedAt(yaml, "3: tissues[0].block.cells[1]", "it must be a number >= 1 and <= 200");
  }
  const std::string megabyte(1000000, 'x');
  for (const auto& [from, where] :
       {std::pair("name: pad", "2: tissues[0].name"), std::pair("tip_link: tip", "7: instruments[0].tip_link")}) {
    const std::string key = std::string(from).substr(0, std::string(from).find(' ') + 1);
    const std::string message = refusal(replaced(scene("", kLinks), from, key + megabyte));
    EXPECT_EQ(message.find("scene.yaml:" + std::string(where) + ": "), 0U) << message.substr(0, 200);
    EXPECT_LT(message.size(), 1000U);
  }
}

/// 100 000 steps of a microsecond are a tenth of a second, though not in binary.
TEST_F(ListLimitsTest, OfStepsInAGapLeaveRoomForRoundOff) {
  const auto steps = [](const std::string& step, const std::string& gap) {
    return scene("", kLinks, "step: {max_step_s: " + step + ", max_gap_s: " + gap + "}\n");
  };
  for (const auto& [step, gap] : {std::pair("1e-6", ".1"), std::pair("3e-6", "0.3"), std::pair("7e-6", "0.7"),
                                  std::pair("0.00023", "23"), std::pair("0.0006", "60")}) {
    EXPECT_NO_THROW(parse(steps(step, gap))) << step << " " << gap;
  }
  expectRefusedAt(steps("1e-6", "0.10001"), "9: step.max_gap_s", "more than 100000 times max_step_s");
}

}  // namespace list_limits_test
}  // namespace tissue_contact
