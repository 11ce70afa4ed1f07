/// How a tissue is held by springs and pressed: what good attachments and pressures become and what is refused.
#include "scene_fixture.h"

namespace tissue_contact {
namespace held_section_test {

const char* const kHeld = R"(tissues:
  - name: organ
    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}
    material: {youngs_modulus_pa: 3000, poissons_ratio: 0.45, density_kg_per_m3: 1050}
    attachments:
      - where:
          - plane: {point_m: [0, 0, 0], normal: [0, 0, 2]}
          - sphere: {center_m: [0.01, 0.02, 0.03], radius_m: 0.005}
        stiffness_pa_per_m: 2e5
      - where: [box: {min_m: [-1, -2, -3], max_m: [1, 2, 3]}]
        stiffness_n_per_m: 30
    pressure_pa: 1600
    pressure_where: [{sphere: {center_m: [0, 0, 0.04], radius_m: 0.02}}]
)";

TEST_F(SceneTest, FillsAttachments) {
  const std::vector<Attachment> attachments = parse(kHeld).tissues.at(0).attachments;
  ASSERT_EQ(attachments.size(), 2U);
  ASSERT_EQ(attachments[0].where.size(), 2U);
  EXPECT_EQ(std::get<SphereRegion>(attachments[0].where[1]).radius_m, 0.005);
  EXPECT_EQ(attachments[0].stiffness_pa_per_m, 2e5);
  EXPECT_EQ(attachments[0].stiffness_n_per_m, 0.0);
  EXPECT_EQ(std::get<BoxRegion>(attachments[1].where.at(0)).max_m, Vector3(1, 2, 3));
  EXPECT_EQ(attachments[1].stiffness_pa_per_m, 0.0);
  EXPECT_EQ(attachments[1].stiffness_n_per_m, 30.0);
}

TEST_F(SceneTest, FillsPressure) {
  const TissueDescription organ = parse(kHeld).tissues.at(0);
  EXPECT_EQ(organ.pressure_pa, 1600.0);
  ASSERT_EQ(organ.pressure_where.size(), 1U);
  EXPECT_EQ(std::get<SphereRegion>(organ.pressure_where[0]).radius_m, 0.02);
  EXPECT_EQ(parse(replaced(kHeld, "pressure_pa: 1600", "pressure_pa: -200")).tissues.at(0).pressure_pa, -200.0);
  const TissueDescription plain = parse(kSmallestScene).tissues.at(0);
  EXPECT_TRUE(plain.attachments.empty());
  EXPECT_EQ(plain.pressure_pa, 0.0);
}

const BadScene kBadHolds[] = {
    {"stiffness_pa_per_m: 2e5", "stiffness_pa_per_m: 0.5", "9: tissues[0].attachments[0].stiffness_pa_per_m",
     "1 N/mm on 1 cm^2 is 1e7"},
    {"stiffness_pa_per_m: 2e5", "stiffness_pa_per_m: .nan", "9: tissues[0].attachments[0].stiffness_pa_per_m",
     "is \".nan\""},
    {"stiffness_n_per_m: 30", "stiffness_n_per_m: 0", "11: tissues[0].attachments[1].stiffness_n_per_m",
     ">= 1e-06 and <= 1e+09 N/m"},
    {"stiffness_n_per_m: 30", "stiffness_n_per_m: 30\n        stiffness_pa_per_m: 30",
     "11: tissues[0].attachments[1].stiffness_n_per_m", "cannot be given together"},
    {"        stiffness_n_per_m: 30\n", "", "10: tissues[0].attachments[1]",
     "none of stiffness_pa_per_m, stiffness_n_per_m is given"},
    {"stiffness_n_per_m: 30", "stiffness_per_m: 30", "11: tissues[0].attachments[1].stiffness_per_m",
     "did you mean \"stiffness_n_per_m\"?"},
    {"      - where: [box: {min_m: [-1, -2, -3], max_m: [1, 2, 3]}]\n        stiffness", "      - stiffness",
     "10: tissues[0].attachments[1]", "required key \"where\" is missing"},
    {"[box: {min_m: [-1, -2, -3], max_m: [1, 2, 3]}]", "[]", "10: tissues[0].attachments[1].where", "at least 1"},
    {"[box: {min_m", "[cube: {min_m", "10: tissues[0].attachments[1].where[0].cube", "unknown key"},
    {"pressure_pa: 1600", "pressure_pa: 2e7", "12: tissues[0].pressure_pa", "12 mmHg is 1600"},
    {"pressure_pa: 1600", "pressure_pa: inf", "12: tissues[0].pressure_pa", "is \"inf\""},
    {"    pressure_pa: 1600\n", "", "12: tissues[0].pressure_where", "give pressure_pa, or remove pressure_where"},
    {"[{sphere: {center_m: [0, 0, 0.04], radius_m: 0.02}}]", "[]", "13: tissues[0].pressure_where", "at least 1"},
    {"pressure_pa: 1600", "pressure: 1600", "12: tissues[0].pressure", "did you mean \"pressure_pa\"?"},
};

TEST_F(SceneTest, RefusesBadHoldsWithTheirPlace) { expectAllRefused(kHeld, kBadHolds); }

}  // namespace held_section_test
}  // namespace tissue_contact
