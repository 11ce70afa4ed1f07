/// Tissue pairs and friction laws of a scene: what good ones become and what is refused.
#include "scene_fixture.h"

namespace tissue_contact {
namespace friction_section_test {

using Law = FrictionLawDescription;

const char* const kContacts = R"(tissues:
  - name: liver
    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}
    material: &soft {youngs_modulus_pa: 3000, poissons_ratio: 0.45, density_kg_per_m3: 1050}
    fibre_direction: [1, 0, 0]
    regions:
      - {name: scar, where: [{sphere: {center_m: [0, 0, 0], radius_m: 0.01}}]}
  - name: bowel
    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}
    material: *soft
    regions:
      - {name: band, where: [{sphere: {center_m: [0, 0, 0], radius_m: 0.01}}], fibre_direction: [0, 1, 0]}
instruments:
  - {name: grasper, tip_link: tip, contact_links: [upper_jaw, {link: lower_jaw}]}
  - {name: hook, tip_link: tip, contact_links: [blade]}
tissue_pairs:
  - {tissue: liver, other: bowel}
  - {tissue: bowel, other: bowel}
friction:
  - {instrument: grasper, tissue: liver, static: 0.5}
  - {instrument: grasper, link: lower_jaw, tissue: liver, law: asymmetric, static: [0.3, 0.9, 0.6],
     kinetic: [0.2, 0.8, 0.5], axis: {link_direction: [0, 3, 4]}}
  - {instrument: grasper, tissue: liver, region: scar, law: orthotropic, static: [0.6, 0.3], kinetic: [0.6, 0.2], axis: fibre}
  - {instrument: hook, tissue: bowel, region: band, law: tensor, static: [[0.5, 0.1], [-0.1, 0.3]], axis: fibre}
  - {instrument: hook, tissue: liver, law: table, angles_rad: [0, 1.5, 3], static: [0.4, 0.6, 0.5],
     kinetic: [0.3, 0.3, 0.3], axis: {link_direction: [1, 0, 0]}, speeds_m_per_s: [0, 0.01, 0.1], speed_factors: [1, 0.8, 0.5],
     pressures_pa: [0, 600, 2.0e+4], pressure_factors: [1.5, 1.2, 0.9]}
  - {other_tissue: bowel, tissue: liver, law: orthotropic, static: [0.2, 0.1], axis: fibre}
  - {other_tissue: bowel, tissue: bowel, static: 0.1, kinetic: 0.1}
)";

TEST_F(SceneTest, FillsTissuePairs) {
  const std::vector<TissuePair> pairs = parse(kContacts).tissue_pairs;
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].tissue, "liver");
  EXPECT_EQ(pairs[0].other, "bowel");
  EXPECT_EQ(pairs[1].tissue, pairs[1].other);
  EXPECT_TRUE(parse(kSmallestScene).tissue_pairs.empty());
}

TEST_F(SceneTest, FillsWhatFrictionIsBetween) {
  const std::vector<FrictionDescription> friction = parse(kContacts).friction;
  ASSERT_EQ(friction.size(), 7U);
  EXPECT_EQ(friction[0].instrument, "grasper");
  EXPECT_EQ(friction[0].tissue, "liver");
  EXPECT_TRUE(friction[0].link.empty());
  EXPECT_TRUE(friction[0].region.empty());
  EXPECT_TRUE(friction[0].other_tissue.empty());
  EXPECT_EQ(friction[1].link, "lower_jaw");
  EXPECT_EQ(friction[2].region, "scar");
  EXPECT_TRUE(friction[5].instrument.empty());
  EXPECT_EQ(friction[5].tissue, "liver");
  EXPECT_EQ(friction[5].other_tissue, "bowel");
  EXPECT_EQ(friction[6].other_tissue, friction[6].tissue);
}

TEST_F(SceneTest, FillsEachFrictionLaw) {
  const std::vector<FrictionDescription> friction = parse(kContacts).friction;
  const Law& isotropic = friction.at(0).law;
  EXPECT_EQ(isotropic.kind, Law::Kind::kIsotropic);
  EXPECT_EQ(isotropic.static_coefficients, std::vector<double>{0.5});
  EXPECT_EQ(isotropic.kinetic_coefficients, std::vector<double>{0.5}) << "kinetic: the static one";
  EXPECT_EQ(isotropic.axis, Law::Axis::kNone);
  EXPECT_TRUE(isotropic.speeds_m_per_s.empty());
  EXPECT_TRUE(isotropic.pressures_pa.empty());

  const Law& asymmetric = friction.at(1).law;
  EXPECT_EQ(asymmetric.kind, Law::Kind::kAsymmetric);
  EXPECT_EQ(asymmetric.static_coefficients, (std::vector<double>{0.3, 0.9, 0.6}));
  EXPECT_EQ(asymmetric.kinetic_coefficients, (std::vector<double>{0.2, 0.8, 0.5}));
  EXPECT_EQ(asymmetric.axis, Law::Axis::kLink);
  EXPECT_LT((asymmetric.link_axis - Vector3(0, 0.6, 0.8)).norm(), 1e-15);

  const Law& orthotropic = friction.at(2).law;
  EXPECT_EQ(orthotropic.kind, Law::Kind::kOrthotropic);
  EXPECT_EQ(orthotropic.kinetic_coefficients, (std::vector<double>{0.6, 0.2}));
  EXPECT_EQ(orthotropic.axis, Law::Axis::kFibre);

  const Law& tensor = friction.at(3).law;
  EXPECT_EQ(tensor.kind, Law::Kind::kTensor);
  EXPECT_EQ(tensor.static_coefficients, (std::vector<double>{0.5, 0.1, -0.1, 0.3})) << "row by row";
  EXPECT_EQ(tensor.kinetic_coefficients, tensor.static_coefficients);

  const Law& table = friction.at(4).law;
  EXPECT_EQ(table.kind, Law::Kind::kTable);
  EXPECT_EQ(table.angles_rad, (std::vector<double>{0, 1.5, 3}));
  EXPECT_EQ(table.static_coefficients, (std::vector<double>{0.4, 0.6, 0.5}));
  EXPECT_EQ(table.kinetic_coefficients, (std::vector<double>{0.3, 0.3, 0.3}));
  EXPECT_EQ(table.speeds_m_per_s, (std::vector<double>{0, 0.01, 0.1}));
  EXPECT_EQ(table.speed_factors, (std::vector<double>{1, 0.8, 0.5}));
  EXPECT_EQ(table.pressures_pa, (std::vector<double>{0, 600, 20000}));
  EXPECT_EQ(table.pressure_factors, (std::vector<double>{1.5, 1.2, 0.9}));
}

TEST_F(SceneTest, LeavesTheTensorsLimitsToTheLaw) {
  // Entry by entry the static tensor is smaller, yet it resists more: off-diagonal entries may have any sign.
  const Scene scene = parse(replaced(kContacts, "static: [[0.5, 0.1], [-0.1, 0.3]]",
                                     "static: [[0.5, -0.1], [0.1, 0.3]], kinetic: [[0.4, 0], [0, 0.2]]"));
  EXPECT_EQ(scene.friction.at(3).law.kinetic_coefficients, (std::vector<double>{0.4, 0, 0, 0.2}));
}

TEST_F(SceneTest, AcceptsWhatIsNotGivenTwice) {
  // Another link, or another region: more entries for pairs already there.
  const Scene scene =
      parse(kContacts + std::string(R"(  - {instrument: grasper, link: upper_jaw, tissue: liver, static: 0.4}
  - {instrument: grasper, link: upper_jaw, tissue: liver, region: scar, static: 0.4}
  - {other_tissue: bowel, tissue: liver, region: scar, static: 0.4}
  - {other_tissue: bowel, tissue: bowel, region: band, static: 0.4}
)"));
  EXPECT_EQ(scene.friction.size(), 11U);
}

const BadScene kBadPairs[] = {
    {"{tissue: liver, other: bowel}", "{tissue: bowl, other: liver}", "17: tissue_pairs[0].tissue",
     "unknown tissue \"bowl\"; did you mean \"bowel\"? the scene has liver, bowel"},
    {"{tissue: liver, other: bowel}", "{tissue: bowel, other: hook}", "17: tissue_pairs[0].other", "unknown tissue"},
    {"{tissue: liver, other: bowel}", "{tissue: bowel}", "17: tissue_pairs[0]", "required key \"other\" is missing"},
    {"{tissue: liver, other: bowel}", "{tissue: bowel, other: [liver]}", "17: tissue_pairs[0].other", "is a list"},
    {"{tissue: liver, other: bowel}", "{tissue: bowel, others: liver}", "17: tissue_pairs[0].others",
     "did you mean \"other\"?"},
    {"{tissue: bowel, other: bowel}", "{tissue: bowel, other: liver}", "18: tissue_pairs[1]",
     "is given twice (the order does not matter)"},
    {"instrument: grasper, tissue: liver, static: 0.5", "tissue: liver, static: 0.5", "20: friction[0]",
     "none of instrument, other_tissue is given"},
    {"{other_tissue: bowel, tissue: bowel", "{instrument: hook, other_tissue: bowel, tissue: bowel",
     "29: friction[6].other_tissue", "cannot be given together with \"instrument\""},
    {"{other_tissue: bowel, tissue: bowel", "{other_tissue: liver, tissue: liver", "29: friction[6].other_tissue",
     "are not among tissue_pairs, so they never touch; add {tissue: liver, other: liver} there"},
    {"{other_tissue: bowel, tissue: bowel", "{other_tissue: bowls, tissue: bowel", "29: friction[6].other_tissue",
     "did you mean \"bowel\"?"},
    {"{other_tissue: bowel, tissue: bowel", "{other_tissue: liver, tissue: bowel", "29: friction[6]", "given twice"},
    {"law: orthotropic, static: [0.2, 0.1]", "law: tensor, static: [[0.2, 0], [0, 0.1]]", "28: friction[5].law",
     "works for an instrument on a tissue only"},
    {"{other_tissue: bowel, tissue: bowel", "{other_tissue: bowel, link: blade, tissue: bowel", "29: friction[6].link",
     "is for pairs with an instrument only"},
    {"link: lower_jaw, tissue", "link: lower_jar, tissue", "21: friction[1].link",
     "unknown link \"lower_jar\"; did you mean \"lower_jaw\"? contact_links of grasper has upper_jaw, lower_jaw"},
    {"link: lower_jaw, tissue", "link: [lower_jaw], tissue", "21: friction[1].link", "is a list; it must be text"},
    {"region: scar", "region: scat", "23: friction[2].region",
     "unknown region \"scat\"; did you mean \"scar\"? tissue liver has scar"},
    {"region: scar", "region: band", "23: friction[2].region", "unknown region"},
    {"region: scar", "link: lower_jaw", "23: friction[2]",
     "the pair \"grasper\" and \"liver\", link \"lower_jaw\" is given twice"},
    {"instrument: hook, tissue: bowel, region: band", "instrument: grasper, tissue: liver, region: scar",
     "24: friction[3]", "region \"scar\" is given twice"},
};

TEST_F(SceneTest, RefusesBadPairsWithTheirPlace) { expectAllRefused(kContacts, kBadPairs); }

const BadScene kBadLaws[] = {
    {"law: asymmetric", "law: assymetric", "21: friction[1].law",
     "did you mean \"asymmetric\"? allowed here: isotropic"},
    {"law: asymmetric", "law: 3", "21: friction[1].law", "allowed here: isotropic, orthotropic, asymmetric, table"},
    {"static: 0.5}", "static: [0.5]}", "20: friction[0].static", "is a list; it must be a number"},
    {"static: 0.5}", "static: nan}", "20: friction[0].static", "is \"nan\""},
    {"static: 0.5}", "kinetic: 0.5}", "20: friction[0]", "required key \"static\" is missing"},
    {"static: 0.5}", "static: 0.5, axis: fibre}", "20: friction[0].axis", "isotropic friction has no axis"},
    {"static: 0.5}", "static: 0.5, angles_rad: [0, 1]}", "20: friction[0].angles_rad", "for the law table only"},
    {"static: [0.3, 0.9, 0.6]", "static: 0.3", "21: friction[1].static",
     "is \"0.3\"; it must be a list of 3 numbers: forward, backward, sideways"},
    {"static: [0.3, 0.9, 0.6]", "static: [0.3, 0.7, 0.6]", "21: friction[1].static[1]", "smaller than the kinetic one"},
    {"kinetic: [0.2, 0.8, 0.5]", "kinetic: [0.2, 0.8]", "22: friction[1].kinetic", "has 2 elements"},
    {"kinetic: [0.2, 0.8, 0.5]", "kinetic: [0.2, 0.8, -0.5]", "22: friction[1].kinetic[2]", ">= 0 and <= 10"},
    {"axis: {link_direction: [0, 3, 4]}", "axis: {link_direction: [0, 0, 0]}", "22: friction[1].axis.link_direction",
     "must point somewhere"},
    {"axis: {link_direction: [0, 3, 4]}", "axis: {link_direction: [0, nan, 4]}",
     "22: friction[1].axis.link_direction[1]", "is \"nan\""},
    {"axis: {link_direction: [0, 3, 4]}", "axis: {linkdirection: [0, 3, 4]}", "22: friction[1].axis.linkdirection",
     "did you mean \"link_direction\"?"},
    {"axis: {link_direction: [0, 3, 4]}", "axis: [0, 3, 4]", "22: friction[1].axis", "is a list; it must be a map"},
    {"axis: {link_direction: [0, 3, 4]}", "axis: fiber", "22: friction[1].axis",
     "is \"fiber\"; it must be fibre or {link_direction: [x, y, z]}"},
    {", axis: {link_direction: [0, 3, 4]}", "", "21: friction[1]", "required key \"axis\" is missing"},
    {"static: [0.6, 0.3]", "static: [0.6, 11]", "23: friction[2].static[1]", ">= 0 and <= 10"},
    {"static: [0.6, 0.3]", "static: [0.6, 0.1]", "23: friction[2].static[1]", "smaller than the kinetic one"},
    {"region: band, ", "", "24: friction[3].axis", "add fibre_direction to the tissue or give {link_direction"},
    {"static: [[0.5, 0.1], [-0.1, 0.3]]", "static: [0.5, 0.3]", "24: friction[3].static[0]", "a list of 2 numbers"},
    {"static: [[0.5, 0.1], [-0.1, 0.3]]", "static: 0.5", "24: friction[3].static", "2 rows [[m11, m12], [m21, m22]]"},
    {"static: [[0.5, 0.1], [-0.1, 0.3]]", "static: [[0.5, 0.1], [-11, 0.3]]", "24: friction[3].static[1][0]",
     ">= -10 and <= 10"},
    {"static: [[0.5, 0.1], [-0.1, 0.3]]", "static: [[0.5, 0.1], [.nan, 0.3]]", "24: friction[3].static[1][0]",
     "is \".nan\""},
    {"angles_rad: [0, 1.5, 3]", "angles_rad: [0, 1.5]", "25: friction[4].static",
     "has 3 elements; it must be a list of 2 numbers, one for each of angles_rad"},
    {"angles_rad: [0, 1.5, 3]", "angles_rad: [0.1, 1.5, 3]", "25: friction[4].angles_rad[0]", "begin the table at 0"},
    {"angles_rad: [0, 1.5, 3]", "angles_rad: [0, 3, 3]", "25: friction[4].angles_rad[2]", "sort the table"},
    {"angles_rad: [0, 1.5, 3]", "angles_rad: [0, 90, 180]", "25: friction[4].angles_rad[1]", "give radians"},
    {"angles_rad: [0, 1.5, 3]", "angles_rad: [0, nan, 3]", "25: friction[4].angles_rad[1]", "is \"nan\""},
    {"angles_rad: [0, 1.5, 3]", "angles_rad: [0]", "25: friction[4].angles_rad", "at least 2"},
    {"angles_rad: [0, 1.5, 3], ", "", "25: friction[4]", "required key \"angles_rad\" is missing"},
    {"static: [0.4, 0.6, 0.5]", "static: [0.4, 0.6, 0.2]", "25: friction[4].static[2]", "smaller than the kinetic one"},
    {"speeds_m_per_s: [0, 0.01, 0.1], ", "", "25: friction[4]", "required key \"speeds_m_per_s\" is missing"},
    {", speed_factors: [1, 0.8, 0.5]", "", "25: friction[4]", "required key \"speed_factors\" is missing"},
    {"speeds_m_per_s: [0, 0.01, 0.1]", "speeds_m_per_s: [0.001, 0.01, 0.1]", "26: friction[4].speeds_m_per_s[0]",
     "it must be 0"},
    {"speeds_m_per_s: [0, 0.01, 0.1]", "speeds_m_per_s: [0, 0.1, 0.01]", "26: friction[4].speeds_m_per_s[2]",
     "not greater than the value before it"},
    {"speeds_m_per_s: [0, 0.01, 0.1]", "speeds_m_per_s: [0, 0.01, .inf]", "26: friction[4].speeds_m_per_s[2]", "m/s"},
    {"speeds_m_per_s: [0, 0.01, 0.1]", "speeds_m_per_s: 0.1", "26: friction[4].speeds_m_per_s", "must be a list"},
    {"speed_factors: [1, 0.8, 0.5]", "speed_factors: [1, 1.2, 0.5]", "26: friction[4].speed_factors[1]",
     "must not exceed the static one"},
    {"speed_factors: [1, 0.8, 0.5]", "speed_factors: [1, 0.8]", "26: friction[4].speed_factors",
     "one for each of speeds_m_per_s"},
    {"speed_factors: [1, 0.8, 0.5]", "speed_factors: [1, nan, 0.5]", "26: friction[4].speed_factors[1]", "is \"nan\""},
    {"pressures_pa: [0, 600, 2.0e+4], ", "", "25: friction[4]", "required key \"pressures_pa\" is missing"},
    {", pressure_factors: [1.5, 1.2, 0.9]", "", "25: friction[4]", "required key \"pressure_factors\" is missing"},
    {"pressures_pa: [0, 600, 2.0e+4]", "pressures_pa: [600, 700, 2.0e+4]", "27: friction[4].pressures_pa[0]",
     "it must be 0"},
    {"pressures_pa: [0, 600, 2.0e+4]", "pressures_pa: [0, 600, 600]", "27: friction[4].pressures_pa[2]",
     "not greater than the value before it"},
    {"pressures_pa: [0, 600, 2.0e+4]", "pressures_pa: [0, 600, 2.0e+10]", "27: friction[4].pressures_pa[2]", "Pa"},
    {"pressure_factors: [1.5, 1.2, 0.9]", "pressure_factors: [1.5, 11, 0.9]", "27: friction[4].pressure_factors[1]",
     ">= 0 and <= 10"},
    {"pressure_factors: [1.5, 1.2, 0.9]", "pressure_factors: [1.5, 1.2]", "27: friction[4].pressure_factors",
     "one for each of pressures_pa"},
    {"pressure_factors: [1.5, 1.2, 0.9]", "pressure_factors: [1.5, nan, 0.9]", "27: friction[4].pressure_factors[1]",
     "is \"nan\""},
    {"static: [0.2, 0.1], axis: fibre", "static: [0.2, 0.1], axis: {link_direction: [1, 0, 0]}", "28: friction[5].axis",
     "tissue against tissue has no link; it must be fibre"},
    {"{other_tissue: bowel, tissue: liver, law", "{other_tissue: liver, tissue: bowel, law", "28: friction[5].axis",
     "fibre direction, which is not given; add fibre_direction to the tissue"},
};

TEST_F(SceneTest, RefusesBadLawsWithTheirPlace) { expectAllRefused(kContacts, kBadLaws); }

TEST_F(SceneTest, BoundsTheLengthOfATable) {
  const auto withTable = [](int count) {
    std::string angles = "0";
    std::string coefficients = "0.5";
    for (int i = 1; i < count; ++i) {
      angles += ", " + std::to_string(i * 6e-3);
      coefficients += ", 0.5";
    }
    return replaced(kContacts, "static: 0.5}",
                    "law: table, angles_rad: [" + angles + "], static: [" + coefficients + "], axis: fibre}");
  };
  EXPECT_EQ(parse(withTable(1000)).friction.at(0).law.angles_rad.size(), 1000U);
  EXPECT_NE(refusal(withTable(1001)).find("has 1001 elements; at most 1000 are allowed"), std::string::npos);
}

TEST_F(SceneTest, SurvivesDamagedFriction) { EXPECT_GT(refusedWhenDamaged(kContacts), 1000); }

}  // namespace friction_section_test
}  // namespace tissue_contact
