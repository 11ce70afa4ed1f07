/// Materials by name, surfaces to be filled, groups and cell data in scenes; the table of doc/organ.md against the code.
#include "tissue_contact/tissue/material_preset.h"

#include <sstream>

#include "scene_fixture.h"
#include "tissue_contact/core/read_file.h"

namespace tissue_contact {
namespace material_preset_test {

const char* const kOrgan = R"(tissues:
  - name: organ
    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}
    material: liver
)";

TEST_F(SceneTest, AMaterialByNameHasTheConstantsOfItsTable) {
  const TissueDescription organ = parse(kOrgan).tissues.at(0);
  const MaterialPreset& liver = materialPreset("liver");
  EXPECT_EQ(organ.material.youngs_modulus_pa, liver.youngs_modulus_pa);
  EXPECT_EQ(organ.material.poissons_ratio, liver.poissons_ratio);
  EXPECT_EQ(organ.material.density_kg_per_m3, liver.density_kg_per_m3);
  EXPECT_EQ(organ.damping.stiffness_s, liver.damping_stiffness_s);
  EXPECT_EQ(organ.material.model, ElasticModel::kCorotational);
}

TEST_F(SceneTest, WhatIsGivenBesideAPresetCounts) {
  const std::string text = replaced(kOrgan, "material: liver",
                                    "material: {preset: liver, model: neo_hookean, youngs_modulus_pa: 6000}\n"
                                    "    damping: {mass_per_s: 1}");
  const TissueDescription organ = parse(text).tissues.at(0);
  EXPECT_EQ(organ.material.youngs_modulus_pa, 6000.0);
  EXPECT_EQ(organ.material.density_kg_per_m3, materialPreset("liver").density_kg_per_m3);
  EXPECT_EQ(organ.material.model, ElasticModel::kNeoHookean);
  EXPECT_EQ(organ.damping.stiffness_s, 0.0) << "a section damping stands for itself";
}

TEST_F(SceneTest, ARegionMayNameAMaterial) {
  const std::string text =
      std::string(kOrgan) +
      "    regions:\n      - name: stone\n        where: [sphere: {center_m: [0, 0, 0], radius_m: 1}]\n"
      "        material: liver_tumour\n";
  const TissueDescription organ = parse(text).tissues.at(0);
  EXPECT_EQ(organ.regions.at(0).material.youngs_modulus_pa, materialPreset("liver_tumour").youngs_modulus_pa);
  EXPECT_EQ(organ.material.youngs_modulus_pa, materialPreset("liver").youngs_modulus_pa);
}

TEST_F(SceneTest, UnknownMaterialsAreToldWhichThereAre) {
  expectContains(
      refusal(replaced(kOrgan, "liver", "livre")),
      {"tissues[0].material", "\"livre\"", "did you mean \"liver\"", "kidney", "plastisol", "youngs_modulus_pa"});
  expectContains(refusal(replaced(kOrgan, "liver", "{preset: stone}")), {"tissues[0].material.preset"});
  expectContains(refusal(replaced(kOrgan, "liver", "{youngs_modulus_pa: 5000, poissons_ratio: 0.4}")),
                 {"density_kg_per_m3"});
}

TEST(MaterialPresets, AreSoundAndHaveSources) {
  for (const MaterialPreset& preset : materialPresets()) {
    SCOPED_TRACE(preset.name);
    EXPECT_LE(preset.lowest_pa, preset.youngs_modulus_pa);
    EXPECT_GE(preset.highest_pa, preset.youngs_modulus_pa);
    EXPECT_TRUE(MaterialDescription::kPoissonsRatio.contains(preset.poissons_ratio));
    EXPECT_NE(std::string(preset.source), "");
    EXPECT_EQ(&materialPreset(preset.name), &preset) << "names differ";
  }
}

/// "| `name` | kPa | range | nu | density | damping | basis | source |".
std::string documentRow(const MaterialPreset& preset) {
  std::ostringstream row;
  row << "| `" << preset.name << "` | " << preset.youngs_modulus_pa / 1e3 << " | ";
  if (preset.lowest_pa < preset.highest_pa) row << preset.lowest_pa / 1e3 << " … " << preset.highest_pa / 1e3;
  row << " | " << preset.poissons_ratio << " | " << preset.density_kg_per_m3 << " | " << preset.damping_stiffness_s
      << " | " << preset.basis << " | " << preset.source << " |";
  return row.str();
}

TEST(MaterialPresets, TheDocumentHasExactlyTheTable) {
  const std::string text = readFile(TISSUE_CONTACT_SOURCE_DIR "/doc/organ.md", "document", std::uintmax_t{1} << 20U);
  std::size_t rows = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) rows += line.rfind("| `", 0) == 0 ? 1 : 0;
  EXPECT_EQ(rows, materialPresets().size());
  for (const MaterialPreset& preset : materialPresets()) {
    EXPECT_NE(text.find(documentRow(preset) + "\n"), std::string::npos) << "doc/organ.md needs the line\n"
                                                                        << documentRow(preset);
  }
}

TEST_F(SceneTest, ASurfaceNeedsCellsAndAMeshHasItsOwn) {
  write("a.stl", "x");
  write("a.msh", "x");
  const auto scene = [](const std::string& mesh) {
    return replaced(kOrgan, "block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}", "mesh: {" + mesh + "}");
  };
  const auto filled = std::get<MeshDescription>(
      parse(scene("file: a.stl, cell_size_m: 0.006, cell_size_inside_m: 0.012")).tissues.at(0).geometry);
  EXPECT_EQ(filled.cell_size_m, 0.006);
  EXPECT_EQ(filled.cell_size_inside_m, 0.012);
  const auto refused = [&](const std::string& mesh) { return refusal(scene(mesh)); };
  expectContains(refused("file: a.stl"), {"tissues[0].mesh.file", "is a surface", "cell_size_m"});
  expectContains(refused("file: a.msh, cell_size_m: 0.006"), {"tissues[0].mesh.cell_size_m", "remove the key"});
  expectContains(refused("file: a.stl, cell_size_m: 6"), {"cell_size_m", "metres"});
  expectContains(refused("file: a.stl, cell_size_m: 0.006, cell_size_inside_m: 0.005"), {"cell_size_inside_m"});
  for (const char* key : {"remove_unreferenced_nodes: true", "coincident_nodes: merge"}) {
    expectContains(refused("file: a.stl, cell_size_m: 0.006, " + std::string(key)), {"is for tetrahedral meshes"});
  }
}

TEST_F(SceneTest, PlacesMayBeGroupsAndCellData) {
  const TissueDescription organ =
      parse(std::string(kOrgan) + "    fixed: [group: base, group: 3, cell_data: {name: region, value: 2}]\n")
          .tissues.at(0);
  EXPECT_EQ(std::get<GroupRegion>(organ.fixed.at(0)).name, "base");
  EXPECT_EQ(std::get<GroupRegion>(organ.fixed.at(1)).name, "3");
  EXPECT_EQ(std::get<CellDataRegion>(organ.fixed.at(2)).name, "region");
  EXPECT_EQ(std::get<CellDataRegion>(organ.fixed.at(2)).value, 2.0);
}

}  // namespace material_preset_test
}  // namespace tissue_contact
