/// How a tissue's mesh follows what touches it: what good sections become and what is refused.
#include "scene_fixture.h"

namespace tissue_contact {
namespace refinement_section_test {

const char* const kRefined = R"(tissues:
  - name: organ
    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}
    material: {youngs_modulus_pa: 3000, poissons_ratio: 0.45, density_kg_per_m3: 1050}
    refinement: {cell_m: 0.002, reach_m: 0.007, growth: 0.3, nodes_at_most: 1500}
)";

TEST_F(SceneTest, FillsRefinement) {
  const RefinementDescription given = parse(kRefined).tissues.at(0).refinement;
  EXPECT_EQ(given.mode, RefinementDescription::Mode::kGiven);
  EXPECT_EQ(given.cell_m, 0.002);
  EXPECT_EQ(given.reach_m, 0.007);
  EXPECT_EQ(given.growth, 0.3);
  EXPECT_EQ(given.nodes_at_most, 1500);
  const auto as = [&](const char* value) {
    return parse(replaced(kRefined, "{cell_m: 0.002, reach_m: 0.007, growth: 0.3, nodes_at_most: 1500}", value))
        .tissues.at(0)
        .refinement;
  };
  EXPECT_EQ(as("auto").mode, RefinementDescription::Mode::kAuto);
  EXPECT_EQ(as("fine").mode, RefinementDescription::Mode::kFine);
  EXPECT_EQ(as("never").mode, RefinementDescription::Mode::kNever);
  EXPECT_EQ(as("{cell_m: 0.001}").reach_m, 0.0) << "chosen";
  EXPECT_EQ(parse(kSmallestScene).tissues.at(0).refinement.mode, RefinementDescription::Mode::kNever);
}

const BadScene kBadRefinements[] = {
    {"cell_m: 0.002, ", "", "5: tissues[0].refinement", "cell_m"},
    {"cell_m: 0.002", "cell_m: 0", "5: tissues[0].refinement.cell_m", "give metres, not millimetres"},
    {"cell_m: 0.002", "cell_m: .nan", "5: tissues[0].refinement.cell_m", "is \".nan\""},
    {"reach_m: 0.007", "reach_m: -1", "5: tissues[0].refinement.reach_m", "give metres"},
    {"growth: 0.3", "growth: 0", "5: tissues[0].refinement.growth", "0.05"},
    {"nodes_at_most: 1500", "nodes_at_most: 0", "5: tissues[0].refinement.nodes_at_most", "1"},
    {"nodes_at_most: 1500", "nodes_at_most: 1e9", "5: tissues[0].refinement.nodes_at_most", "300000"},
    {"nodes_at_most: 1500", "nodes: 1500", "5: tissues[0].refinement.nodes", "did you mean"},
    {"{cell_m: 0.002, reach_m: 0.007, growth: 0.3, nodes_at_most: 1500}", "always", "5: tissues[0].refinement",
     "never, auto, fine"},
    {"{cell_m: 0.002, reach_m: 0.007, growth: 0.3, nodes_at_most: 1500}", "[1]", "5: tissues[0].refinement", "map"},
    {"youngs_modulus_pa: 3000", "model: mass_spring, youngs_modulus_pa: 3000", "5: tissues[0].refinement",
     "mass-spring"},
    {"youngs_modulus_pa: 3000", "prony_series: [{modulus_ratio: 0.5, time_s: 1}], youngs_modulus_pa: 3000",
     "5: tissues[0].refinement", "relaxes"},
    {"block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}",
     "sheet: {size_m: [0.1, 0.1], cells: [2, 2], thickness_m: 0.001}", "5: tissues[0].refinement", "sheet or shell"},
};

TEST_F(SceneTest, RefusesBadRefinementsWithTheirPlace) { expectAllRefused(kRefined, kBadRefinements); }

}  // namespace refinement_section_test
}  // namespace tissue_contact
