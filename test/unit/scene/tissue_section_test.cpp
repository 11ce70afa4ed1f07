/// Membranes, elastic models, fibres and regions of tissues: what good ones become and what is refused.
#include "scene_fixture.h"

namespace tissue_contact {
namespace tissue_section_test {

const char* const kTissues = R"(tissues:
  - name: flap
    sheet:
      size_m: [0.04, 0.02]
      cells: [8, 4]
      thickness_m: 0.002
    material:
      youngs_modulus_pa: 2e4
      poissons_ratio: 0.3
      density_kg_per_m3: 1100
      bending_stiffness_n_m: 1e-6
    damping: {mass_per_s: 0.5, stiffness_s: 0.001}
    regions:
      - name: rim
        where:
          - box: {min_m: [-1, -1, -1], max_m: [-0.01, 1, 1]}
          - sphere: {center_m: [0.01, 0.02, 0.03], radius_m: 0.005}
        material: {youngs_modulus_pa: 5e4, poissons_ratio: 0.1, density_kg_per_m3: 1200}
        damping: {stiffness_s: 0.004}
        fibre_direction: [3, 0, 4]
      - name: middle
        where: [{plane: {point_m: [0, 0, 0], normal: [1, 0, 0]}}]
        material: {density_kg_per_m3: 900}
    fibre_direction: [0, 2, 0]
  - name: skin
    shell: {file: skin.obj, scale_m_per_unit: 0.002, thickness_m: 0.0015}
    material: {model: membrane, youngs_modulus_pa: 1e4, poissons_ratio: 0, density_kg_per_m3: 1000}
  - name: organ
    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}
    material: {model: neo_hookean, youngs_modulus_pa: 3000, poissons_ratio: 0.45, density_kg_per_m3: 1050}
)";

TEST_F(SceneTest, FillsASheet) {
  const TissueDescription flap = parse(kTissues).tissues.at(0);
  const auto& sheet = std::get<SheetDescription>(flap.geometry);
  EXPECT_EQ(sheet.size_m, Vector2(0.04, 0.02));
  EXPECT_EQ(sheet.cells, (std::array<int, 2>{8, 4}));
  EXPECT_EQ(sheet.thickness_m, 0.002);
  EXPECT_EQ(flap.material.model, ElasticModel::kMembrane) << "the default of a surface";
  EXPECT_EQ(flap.material.bending_stiffness_n_m, 1e-6);
  EXPECT_EQ(flap.fibre_direction, Vector3(0, 1, 0)) << "stored with unit length";
}

TEST_F(SceneTest, FillsAShell) {
  const TissueDescription skin = parse(kTissues).tissues.at(1);
  const auto& shell = std::get<ShellDescription>(skin.geometry);
  EXPECT_EQ(shell.file, path("skin.obj"));
  EXPECT_EQ(shell.scale_m_per_unit, 0.002);
  EXPECT_EQ(shell.thickness_m, 0.0015);
  EXPECT_EQ(skin.material.model, ElasticModel::kMembrane);
  EXPECT_LT(skin.material.bending_stiffness_n_m, 0.0) << "the default: that of a plate";
  EXPECT_EQ(skin.fibre_direction, Vector3::Zero());
  EXPECT_TRUE(skin.regions.empty());
  const auto in_metres = parse(replaced(kTissues, "scale_m_per_unit: 0.002, ", "")).tissues.at(1).geometry;
  EXPECT_EQ(std::get<ShellDescription>(in_metres).scale_m_per_unit, 1.0);
}

TEST_F(SceneTest, KnowsEachModelOfAVolume) {
  const std::pair<const char*, ElasticModel> models[] = {{"linear", ElasticModel::kLinear},
                                                         {"corotational", ElasticModel::kCorotational},
                                                         {"neo_hookean", ElasticModel::kNeoHookean},
                                                         {"mass_spring", ElasticModel::kMassSpring}};
  for (const auto& [name, model] : models) {
    const Scene scene = parse(replaced(kTissues, "model: neo_hookean", std::string("model: ") + name));
    EXPECT_EQ(scene.tissues.at(2).material.model, model) << name;
  }
  EXPECT_EQ(parse(replaced(kTissues, "model: neo_hookean, ", "")).tissues.at(2).material.model,
            ElasticModel::kCorotational);
}

TEST_F(SceneTest, FillsRegions) {
  const std::vector<TissueRegion> regions = parse(kTissues).tissues.at(0).regions;
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].name, "rim");
  ASSERT_EQ(regions[0].where.size(), 2U);
  EXPECT_EQ(std::get<BoxRegion>(regions[0].where[0]).max_m, Vector3(-0.01, 1, 1));
  EXPECT_EQ(std::get<SphereRegion>(regions[0].where[1]).radius_m, 0.005);
  EXPECT_EQ(regions[0].material.model, ElasticModel::kMembrane);
  EXPECT_EQ(regions[0].material.youngs_modulus_pa, 5e4);
  EXPECT_EQ(regions[0].material.poissons_ratio, 0.1);
  EXPECT_EQ(regions[0].material.density_kg_per_m3, 1200.0);
  EXPECT_EQ(regions[0].material.bending_stiffness_n_m, 1e-6);
  EXPECT_EQ(regions[0].damping_stiffness_s, 0.004);
  EXPECT_LT((regions[0].fibre_direction - Vector3(0.6, 0, 0.8)).norm(), 1e-15);
}

TEST_F(SceneTest, RegionsInheritWhatTheyDoNotGive) {
  const TissueRegion middle = parse(kTissues).tissues.at(0).regions.at(1);
  EXPECT_EQ(middle.material.model, ElasticModel::kMembrane);
  EXPECT_EQ(middle.material.youngs_modulus_pa, 2e4);
  EXPECT_EQ(middle.material.poissons_ratio, 0.3);
  EXPECT_EQ(middle.material.density_kg_per_m3, 900.0);
  EXPECT_EQ(middle.damping_stiffness_s, 0.001);
  EXPECT_EQ(middle.fibre_direction, Vector3(0, 1, 0)) << "also when the tissue's stands below its regions";
}

const BadScene kBadTissues[] = {
    {"size_m: [0.04, 0.02]", "size_m: [0.04, 0.02, 0]", "4: tissues[0].sheet.size_m", "a list of 2 numbers"},
    {"size_m: [0.04, 0.02]", "size_m: [40, 20]", "4: tissues[0].sheet.size_m[0]", "give metres"},
    {"size_m: [0.04, 0.02]", "size_m: [0.04, nan]", "4: tissues[0].sheet.size_m[1]", "is \"nan\""},
    {"cells: [8, 4]", "cells: [8, 0]", "5: tissues[0].sheet.cells[1]", ">= 1 and <= 1000"},
    {"cells: [8, 4]", "cells: [1001, 4]", "5: tissues[0].sheet.cells[0]", ">= 1 and <= 1000"},
    {"cells: [8, 4]", "cells: [8.5, 4]", "5: tissues[0].sheet.cells[0]", "whole number"},
    {"thickness_m: 0.002", "thickness_m: 0", "6: tissues[0].sheet.thickness_m", ">= 1e-06 and <= 1 m"},
    {"thickness_m: 0.002", "thickness_m: 2", "6: tissues[0].sheet.thickness_m", "give metres"},
    {"thickness_m: 0.002", "thickness_m: .nan", "6: tissues[0].sheet.thickness_m", "is \".nan\""},
    {"thickness_m: 0.002", "thickness: 0.002", "6: tissues[0].sheet.thickness", "did you mean \"thickness_m\"?"},
    {"      thickness_m: 0.002\n", "", "3: tissues[0].sheet", "required key \"thickness_m\" is missing"},
    {"    sheet:", "    sheat:", "3: tissues[0].sheat", "did you mean \"sheet\"?"},
    {"    shell: {file", "    block: {}\n    shell: {file", "27: tissues[1].shell", "together with \"block\""},
    {"    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}\n", "", "28: tissues[2]",
     "none of block, mesh, sheet, shell is given"},
    {"file: skin.obj", "file: hide.obj", "26: tissues[1].shell.file", "hide.obj' does not exist"},
    {"file: skin.obj", "file: organ.vtk", "26: tissues[1].shell.file", "allowed endings: .stl, .obj, .dae"},
    {"scale_m_per_unit: 0.002", "scale_m_per_unit: -1", "26: tissues[1].shell.scale_m_per_unit", "m per file unit"},
    {"thickness_m: 0.0015", "thickness_m: thin", "26: tissues[1].shell.thickness_m", "is \"thin\""},
    {"model: membrane", "model: linear", "27: tissues[1].material.model", "a sheet or shell must be a membrane"},
    {"model: membrane", "model: membrain", "27: tissues[1].material.model", "did you mean \"membrane\"?"},
    {"model: neo_hookean", "model: membrane", "30: tissues[2].material.model", "give linear, corotational"},
    {"model: neo_hookean", "model: mass_spring, dilatation: patch", "30: tissues[2].material.dilatation",
     "only the models linear, corotational and neo_hookean"},
    {"model: neo_hookean", "model: [linear]", "30: tissues[2].material.model", "is a list; it must be text"},
    {"bending_stiffness_n_m: 1e-6", "bending_stiffness_n_m: -1", "11: tissues[0].material.bending_stiffness_n_m",
     ">= 0 and <= 1e+06 N m"},
    {"bending_stiffness_n_m: 1e-6", "bending_stiffness_n_m: nan", "11: tissues[0].material.bending_stiffness_n_m",
     "is \"nan\""},
    {"density_kg_per_m3: 1050", "density_kg_per_m3: 1050, bending_stiffness_n_m: 0",
     "30: tissues[2].material.bending_stiffness_n_m", "only a sheet or shell"},
    {"fibre_direction: [0, 2, 0]", "fibre_direction: [0, 0, 0]", "24: tissues[0].fibre_direction",
     "must point somewhere"},
    {"fibre_direction: [0, 2, 0]", "fibre_direction: [0, nan, 0]", "24: tissues[0].fibre_direction[1]", "is \"nan\""},
    {"fibre_direction: [0, 2, 0]", "fibre_direction: y", "24: tissues[0].fibre_direction", "a list of 3 numbers"},
    {"fibre_direction: [0, 2, 0]", "fiber_direction: [0, 2, 0]", "24: tissues[0].fiber_direction",
     "did you mean \"fibre_direction\"?"},
    {"    regions:", "    regions: {}\n    fixed:", "13: tissues[0].regions", "is a map; it must be a list"},
    {"name: middle", "name: rim", "21: tissues[0].regions[1]", "the name \"rim\" is already used"},
    {"name: middle", "name: the middle", "21: tissues[0].regions[1].name", "must begin with a letter"},
    {"      - name: middle\n        where", "      - where", "21: tissues[0].regions[1]", "\"name\" is missing"},
    {"where: [{plane: {point_m: [0, 0, 0], normal: [1, 0, 0]}}]", "where: []", "22: tissues[0].regions[1].where",
     "at least 1"},
    {"        where: [{plane: {point_m: [0, 0, 0], normal: [1, 0, 0]}}]\n", "", "21: tissues[0].regions[1]",
     "required key \"where\" is missing"},
    {"where: [{plane: {point_m: [0, 0, 0], normal: [1, 0, 0]}}]", "where: [{}]", "22: tissues[0].regions[1].where[0]",
     "none of box, plane, sphere, group, cell_data is given"},
    {"normal: [1, 0, 0]", "normal: [0, 0, 0]", "22: tissues[0].regions[1].where[0].plane.normal", "point somewhere"},
    {"material: {density_kg_per_m3: 900}", "material: {density_kg_per_m3: 0}",
     "23: tissues[0].regions[1].material.density_kg_per_m3", "kilograms per cubic metre"},
    {"material: {density_kg_per_m3: 900}", "material: {model: membrane}", "23: tissues[0].regions[1].material.model",
     "unknown key; allowed here: preset, youngs_modulus_pa, poissons_ratio, density_kg_per_m3"},
    {"youngs_modulus_pa: 5e4", "youngs_modulus_pa: .inf", "18: tissues[0].regions[0].material.youngs_modulus_pa",
     "give pascals"},
    {"poissons_ratio: 0.1", "poissons_ratio: 0.5", "18: tissues[0].regions[0].material.poissons_ratio", "< 0.5"},
    {"damping: {stiffness_s: 0.004}", "damping: {stiffness_s: nan}", "19: tissues[0].regions[0].damping.stiffness_s",
     "give seconds"},
    {"damping: {stiffness_s: 0.004}", "damping: {mass_per_s: 1}", "19: tissues[0].regions[0].damping.mass_per_s",
     "unknown key"},
    {"fibre_direction: [3, 0, 4]", "fibre_direction: [3, 0]", "20: tissues[0].regions[0].fibre_direction",
     "has 2 elements"},
};

TEST_F(SceneTest, RefusesBadTissuesWithTheirPlace) { expectAllRefused(kTissues, kBadTissues); }

TEST_F(SceneTest, BoundsTheNumberOfRegions) {
  const auto withRegions = [](int count) {
    std::string regions = "    regions:\n";
    for (int i = 0; i < count; ++i) {
      regions += "      - {name: r" + std::to_string(i) + ", where: [{sphere: {center_m: [0, 0, 0], radius_m: 1}}]}\n";
    }
    return kTissues + regions;
  };
  EXPECT_EQ(parse(withRegions(1000)).tissues.at(2).regions.size(), 1000U);
  EXPECT_NE(refusal(withRegions(1001)).find("has 1001 elements; at most 1000 are allowed"), std::string::npos);
}

TEST_F(SceneTest, SurvivesDamagedTissues) { EXPECT_GT(refusedWhenDamaged(kTissues), 1000); }

}  // namespace tissue_section_test
}  // namespace tissue_contact
