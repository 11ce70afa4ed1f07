/// Which numbers of a scene may change while it runs, under which names, and what is refused: what a scene file would be refused for.
#include "tissue_contact/scene/tuning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "support/refusal.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace tuning_test {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Scene scene() {
  const std::string text = blockScene() +
                           "    pressure_pa: 500\n"
                           "    fibre_direction: [1, 0, 0]\n"
                           "    regions:\n"
                           "      - {name: tumour, where: [{sphere: {center_m: [0, 0, 0.01], radius_m: 0.02}}], "
                           "material: {youngs_modulus_pa: 5000}}\n"
                           "      - {name: hard, where: [{sphere: {center_m: [0, 0, 0.02], radius_m: 0.01}}], damping: "
                           "{stiffness_s: 0.01}}\n" +
                           onlyBall("[0, 0, 0.03]") +
                           "friction:\n"
                           "  - {instrument: probe, tissue: block, static: 0.5, kinetic: 0.3}\n"
                           "  - {instrument: probe, link: tip, tissue: block, region: tumour, law: orthotropic, axis: "
                           "fibre, static: [0.5, 0.2]}\n"
                           "  - {instrument: probe, tissue: block, region: hard, law: table, axis: fibre, angles_rad: "
                           "[0, 1], static: [0.5, 0.2]}\n";
  return parseScene(text, "text scene", nullptr);
}

std::vector<std::string> keysOf(const Scene& scene) {
  std::vector<std::string> keys;
  for (const Tunable& one : tunables(scene)) keys.push_back(one.key);
  return keys;
}

TEST(Tuning, NamesWhatMayChange) {
  EXPECT_EQ(keysOf(scene()),
            (std::vector<std::string>{
                "tissues/block/youngs_modulus_pa", "tissues/block/poissons_ratio", "tissues/block/damping_stiffness_s",
                "tissues/block/damping_mass_per_s", "tissues/block/regions/tumour/youngs_modulus_pa",
                "tissues/block/regions/hard/damping_stiffness_s", "friction/probe/block/static",
                "friction/probe/block/kinetic", "friction/probe.tip/block.tumour/static/0",
                "friction/probe.tip/block.tumour/static/1", "friction/probe.tip/block.tumour/kinetic/0",
                "friction/probe.tip/block.tumour/kinetic/1", "solver/iterations", "solver/contact_passes",
                "solver/tolerance"}));
}

// A material by name is the region's own, as if its numbers stood there.
TEST(Tuning, ARegionOfANamedMaterialKeepsItsNumbers) {
  const std::string where = "where: [{sphere: {center_m: [0, 0, 0.01], radius_m: 0.02}}], material: ";
  const Scene named =
      parseScene(blockScene() + "    regions:\n      - {name: cyst, " + where + "gelatine}\n      - {name: stone, " +
                     where + "{preset: gelatine, density_kg_per_m3: 1100}}\n" + onlyBall("[0, 0, 0.03]"),
                 "text scene", nullptr);
  const std::vector<std::string> keys = keysOf(named);
  EXPECT_EQ(std::count(keys.begin(), keys.end(), "tissues/block/regions/cyst/youngs_modulus_pa"), 1);
  const Scene changed = tuned(named, {{"tissues/block/youngs_modulus_pa", 7000.0}});
  EXPECT_EQ(changed.tissues[0].material.youngs_modulus_pa, 7000.0);
  for (const TissueRegion& region : changed.tissues[0].regions) EXPECT_EQ(region.material.youngs_modulus_pa, 12500.0);
}

TEST(Tuning, EachNumberHasARangeThatHoldsItAndOtherScenesHaveItBack) {
  const Scene before = scene();
  for (const Tunable& one : tunables(before)) {
    EXPECT_TRUE(one.range.contains(one.value)) << one.key;
    EXPECT_FALSE(one.text.empty());
    const double other = one.is_whole ? one.value + 1 : 0.9 * one.value + (one.value == 0.0 ? 0.1 : 0.0);
    const bool is_static = one.key.find("/static") != std::string::npos;  // kinetic friction must not exceed it
    const double value = is_static ? 1.5 * one.value : other;
    const Scene now = tuned(before, {{one.key, value}});
    const std::vector<TunedNumber> changes = differences(before, now);
    ASSERT_EQ(changes.size(), 1U) << one.key;
    EXPECT_EQ(changes[0].key, one.key);
    EXPECT_EQ(changes[0].value, value);
    EXPECT_TRUE(differences(now, tuned(before, changes)).empty()) << one.key;
  }
}

// The tumour has a modulus of its own, although it is the tissue's; all else follows.
TEST(Tuning, RegionsFollowTheirTissueInWhatTheyAreNotGiven) {
  const Scene now = tuned(scene(), {{"tissues/block/youngs_modulus_pa", 8000.0},
                                    {"tissues/block/poissons_ratio", 0.3},
                                    {"tissues/block/damping_stiffness_s", 0.005}});
  const std::vector<TissueRegion>& regions = now.tissues[0].regions;
  EXPECT_EQ(regions[0].material.youngs_modulus_pa, 5000.0);
  EXPECT_EQ(regions[1].material.youngs_modulus_pa, 8000.0);
  EXPECT_EQ(regions[0].material.poissons_ratio, 0.3);
  EXPECT_EQ(regions[0].damping_stiffness_s, 0.005);
  EXPECT_EQ(regions[1].damping_stiffness_s, 0.01);
}

TEST(Tuning, RefusesWhatASceneFileWouldBeRefusedFor) {
  const auto refused = [](const std::vector<TunedNumber>& numbers, const std::vector<std::string>& words) {
    expectRefusal([&] { tuned(scene(), numbers); }, words);
  };
  refused({{"tissues/block/youngs_modulus_pa", 0.5}},
          {"tissues/block/youngs_modulus_pa", "0.5", ">= 1 and <= 1e+12 Pa", "give pascals"});
  refused({{"tissues/block/poissons_ratio", 0.5}}, {"0.5", "cannot be simulated"});
  for (const Tunable& one : tunables(scene())) {
    refused({{one.key, kNaN}}, {one.key, "nan"});
    refused({{one.key, std::numeric_limits<double>::infinity()}}, {one.key, "inf"});
    refused({{one.key, one.range.low - 1.0}}, {one.key});
  }
  refused({{"solver/iterations", 2.5}}, {"solver/iterations", "2.5", "whole number"});
  refused({{"tissues/block/youngs_modulus", 6000.0}},
          {"'tissues/block/youngs_modulus'", "did you mean 'tissues/block/youngs_modulus_pa'?", "solver/tolerance"});
  refused({{"solver/iterations", 5.0}, {"solver/iterations", 6.0}}, {"solver/iterations", "twice"});
}

TEST(Tuning, RefusesNumbersThatDoNotGoTogetherUnlessAllComeAtOnce) {
  expectRefusal([] { tuned(scene(), {{"friction/probe/block/static", 0.2}}); }, {"friction[0].static", "kinetic[0]"});
  const Scene now = tuned(scene(), {{"friction/probe/block/static", 0.2}, {"friction/probe/block/kinetic", 0.1}});
  EXPECT_EQ(now.friction[0].law.static_coefficients, std::vector<double>{0.2});
  // A pressure under which so soft a body would collapse.
  expectRefusal(
      [] {
        tuned(scene(), {{"tissues/block/youngs_modulus_pa", 500.0}});
      },
      {"tissues[0].pressure_pa", "may collapse"});
}

}  // namespace tuning_test
}  // namespace tissue_contact
