/// What the advisor says about a scene, and that its exact choices change nothing: folds of convex bodies, paths of
/// friction.
#include "simulation/advisor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "support/temporary_directory.h"
#include "support/text_scene.h"
#include "support/tissue_files.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/tissue/material_preset.h"

namespace tissue_contact {
namespace advisor_test {

/// A soft slab, its folds looked for, under a ball of 5 mm; the left end is held.
std::string slabYaml(const std::string& advisor, const std::string& friction = "static: 0.5, kinetic: 0.4") {
  return "tissues:\n  - name: slab\n    block: {size_m: [0.08, 0.03, 0.01], cells: [12, 4, 2]}\n"
         "    material: {youngs_modulus_pa: 3000, poissons_ratio: 0.2, density_kg_per_m3: 1000}\n"
         "    damping: {stiffness_s: 0.01}\n"
         "    fixed: [{box: {min_m: [-0.05, -1, -1], max_m: [-0.0001, 1, 1]}}]\n"
         "tissue_pairs: [{tissue: slab, other: slab}]\n" +
         onlyBall("[0.03, 0.001, -0.0051]") + "friction:\n  - {instrument: probe, tissue: slab, " + friction +
         "}\nadvisor: {" + advisor + "}\n";
}

Simulator makeSlab(const std::string& advisor, const std::string& friction = "static: 0.5, kinetic: 0.4") {
  return makeSimulator(slabYaml(advisor, friction), {{"probe", probeUrdf(0.005)}});
}

/// Up, and then back over the held part: folds the free end over.
Vector3 foldAt(int step) {
  const double way = 1e-4 * step;
  return {-std::min(std::max(way - 0.03, 0.0), 0.04), 0.0, std::min(way, 0.03)};
}

int folds(const Simulator& simulator) {
  int count = 0;
  for (const SolvedContact& contact : simulator.contacts()) {
    count += static_cast<int>(contact.contact.key.instrument < 0 && contact.force_on_tissue_n.norm() > 0.0);
  }
  return count;
}

TEST(Advisor, FoldsOfConvexBodiesAreFoundAllTheSame) {
  Simulator skipping = makeSlab("sleep: never");
  Simulator looking = makeSlab("sleep: never, self_contact: always");
  int most = 0;
  for (int k = 1; k <= 900; ++k) {
    for (Simulator* simulator : {&skipping, &looking}) simulator->advance(0.001, {foldAt(k)});
    ASSERT_EQ(skipping.positions(0), looking.positions(0)) << k;  // what cannot touch has no force
    most = std::max(most, folds(looking));
  }
  EXPECT_GT(most, 0) << "the slab did not fold";
}

TEST(Advisor, GeneralPathOfFrictionGivesTheSameAnswer) {
  for (const char* friction : {"static: 0", "static: 0.5, kinetic: 0.4"}) {
    // Solved nearly to the end: when the iteration stops may differ by one.
    const std::string solver = "solver: {iterations: 1000, tolerance: 1.0e-11}\n";
    const std::map<std::string, std::string> urdfs = {{"probe", probeUrdf(0.005)}};
    Simulator plain = makeSimulator(slabYaml("sleep: never", friction) + solver, urdfs);
    Simulator general = makeSimulator(slabYaml("sleep: never, friction_path: general", friction) + solver, urdfs);
    double largest = 0.0;
    double difference = 0.0;
    for (int k = 1; k <= 100; ++k) {
      for (Simulator* simulator : {&plain, &general}) simulator->advance(0.001, {foldAt(k)});
      largest = std::max(largest, plain.wrench(0).force.norm());
      difference = std::max(difference, (plain.wrench(0).force - general.wrench(0).force).norm());
    }
    EXPECT_GT(largest, 0.001);
    EXPECT_LE(difference, 1e-8 * largest) << friction;  // tolerance of a step times the steps, rounded up
  }
}

TEST(Advisor, SaysWhatItHasChosen) {
  const auto has = [](const Simulator& simulator, const std::string& part) {
    for (const Advice& line : simulator.advice()) {
      if (line.text.find(part) != std::string::npos) return true;
    }
    return false;
  };
  const Simulator plain = makeSlab("sleep: auto");
  EXPECT_EQ(plain.advice().size(), 7U);
  EXPECT_TRUE(has(plain, "2 cells over its thickness of 10 mm"));
  // The shorter triangles are those of two sides, (6.67 + 5 + 8.33) / 3 mm: 0.5 (6.67 / 5)^1.8.
  EXPECT_TRUE(has(plain,
                  "mesh of tissue 'slab': as it is, cells of 6.7 mm (its shorter surface edges), under shapes of 5 mm "
                  "half extent (a ball's radius): expect forces to be off by some 84 % when pressed in by most "
                  "of a half extent; smaller cells help"));
  EXPECT_TRUE(
      has(plain, "sleep: nodes at rest away from contacts are left out while holding them takes at most 0.1 %"));
  EXPECT_TRUE(has(plain, "'slab': corotational always"));
  EXPECT_TRUE(has(plain, "folds of tissue 'slab': convex at rest"));
  EXPECT_TRUE(has(plain, "'probe' on 'slab': isotropic friction"));
  EXPECT_TRUE(has(plain, "all other pairs: no friction"));
  const Simulator other =
      makeSlab("sleep: never, rotations: auto, self_contact: always, friction_path: general", "static: 0");
  EXPECT_TRUE(has(other, "sleep: never, as advisor.sleep asks"));
  EXPECT_TRUE(has(other, "linear while no element turns by 0.02 rad"));
  EXPECT_TRUE(has(other, "looked for in every step, as advisor.self_contact asks"));
  EXPECT_TRUE(has(other, "solved as if it depended on direction"));
  EXPECT_TRUE(has(makeSlab("sleep: auto", "static: 0"), "nothing tangential is computed"));
}

/// Doubts about the size of a tissue from a file that is one unit wide.
std::vector<std::string> sizeDoubts(const std::string& geometry, const std::string& scale) {
  const TemporaryDirectory directory;
  const std::string vtk = directory.write("organ.vtk",
                                          "# vtk DataFile Version 2.0\norgan\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                                          "POINTS 4 double\n0 0 0\n1 0 0\n0 0.5 0\n0 0 0.25\n"
                                          "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n");
  const std::string obj = directory.write("organ.obj", "v 0 0 0\nv 1 0 0\nv 0 0.5 0.25\nf 1 2 3\n");
  const std::string file = geometry == "mesh" ? "file: " + vtk : "thickness_m: 0.001, file: " + obj;
  const std::string scene = "tissues:\n  - name: organ\n    " + geometry + ": {" + file +
                            ", scale_m_per_unit: " + scale +
                            "}\n    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}\n"
                            "    fixed: [{sphere: {center_m: [0, 0, 0], radius_m: 100}}]\n" +
                            onlyBall("[0, 0, 20]");
  std::vector<std::string> doubts;
  for (const Advice& advice : makeSimulator(scene, {{"probe", probeUrdf(0.005)}}).advice()) {
    if (advice.text.find("is the unit of its file that of the scene?") == std::string::npos) continue;
    EXPECT_TRUE(advice.is_warning);
    doubts.push_back(advice.text);
  }
  return doubts;
}

TEST(Advisor, DoubtsTheUnitOfAMeshThatIsSmallerThanTheToolOrLongerThanTwoMetres) {
  for (const char* const geometry : {"mesh", "shell"}) {
    EXPECT_EQ(sizeDoubts(geometry, "0.1"), std::vector<std::string>()) << geometry;
    EXPECT_EQ(sizeDoubts(geometry, "0.006"), std::vector<std::string>()) << geometry;
    EXPECT_EQ(sizeDoubts(geometry, "0.0001"),
              std::vector<std::string>({"tissue 'organ' is 0.1 x 0.05 x 0.025 mm, smaller than every instrument's "
                                        "shape (5 mm half extent and more): is the unit of its file that of the scene? "
                                        "It has scale_m_per_unit 0.0001 (1 for metres, 0.001 for millimetres)"}));
    ASSERT_EQ(sizeDoubts(geometry, "3").size(), 1U);
    EXPECT_EQ(sizeDoubts(geometry, "3")[0].find("tissue 'organ' is 3000 x 1500 x 750 mm: is the unit"), 0U)
        << sizeDoubts(geometry, "3")[0];
  }
}

std::vector<std::string> warningsOf(const std::string& scene) {
  const Simulator simulator = makeSimulator(scene + onlyBall("[0, 0, 0.0251]"), {{"probe", probeUrdf(0.005)}});
  std::vector<std::string> warnings;
  for (const Advice& advice : simulator.advice()) {
    if (advice.is_warning) warnings.push_back(advice.text);
  }
  return warnings;
}

TEST(Advisor, DoubtsTheUnitOfARobotWhoseToolIsLargerThanTheTissue) {
  const auto doubt = [](double radius_m) {
    const Simulator simulator = makeSimulator(blockScene() + onlyBall("[0, 0, 20]"), {{"probe", probeUrdf(radius_m)}});
    for (const Advice& advice : simulator.advice()) {
      if (advice.text.find("are lengths of the URDF in millimetres?") != std::string::npos) return advice.text;
    }
    return std::string();
  };
  EXPECT_EQ(doubt(0.005), "");
  EXPECT_EQ(doubt(0.3), "") << "a table";
  EXPECT_EQ(doubt(5.0),
            "tissue 'block' is 60 x 60 x 20 mm, smaller than every instrument's shape (5000 mm half extent and more): "
            "are lengths of the "
            "URDF in millimetres? They are metres");
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

// Each ran without a word, to forces a thousand times too small, of a body that flies off, or to none.
TEST(Advisor, DoubtsUnitsAndWhatHoldsATissue) {
  const std::string scene = blockScene("[0.02, 0.02, 0.02]", "[8, 8, 8]");
  EXPECT_EQ(warningsOf(scene), std::vector<std::string>());
  const auto only = [&](const std::string& what, const std::string& by) {
    const std::vector<std::string> warnings = warningsOf(replaced(scene, what, by));
    EXPECT_EQ(warnings.size(), 1U) << by;
    return warnings.empty() ? std::string() : warnings.front();
  };
  EXPECT_EQ(
      only("pa: 5000", "pa: 5"),
      "tissue 'block': material.youngs_modulus_pa is 5, which no tissue has: is it in kPa? Give 1000 times as much");
  EXPECT_EQ(only("m3: 1000", "m3: 1.06").find("tissue 'block': material.density_kg_per_m3 is 1.1, "), 0U);
  EXPECT_EQ(only("stiffness_s: 0.003", "stiffness_s: 3").find("tissue 'block': damping.stiffness_s is 3, "), 0U);
  EXPECT_EQ(only("normal: [0, 0, 1]", "normal: [0, 0, -1]").find("tissue 'block': `fixed` holds all of its nodes"), 0U);
  const std::string fixed = "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n";
  EXPECT_EQ(only(fixed, "").find("tissue 'block': nothing holds it"), 0U);
  EXPECT_EQ(warningsOf(replaced(scene, fixed,
                                "    attachments: [{where: [plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}], "
                                "stiffness_pa_per_m: 1e6}]\n")),
            std::vector<std::string>());
}

/// Two blocks of 20 mm, 10 mm apart, of one file: its plane holds the foot of one, or of both.
TEST(Advisor, TellsWhatLongStepsDampBesideTheTissuesOwnDamping) {
  const auto tells = [](const std::string& step_s, const std::string& stiffness_s) {
    std::string tissue = blockScene();
    tissue.replace(tissue.find("0.003"), 5, stiffness_s);
    const Simulator simulator = makeSimulator(
        tissue + onlyBall("[0, 0, 0.03]") + "step: {max_step_s: " + step_s + "}\n", {{"probe", probeUrdf(0.005)}});
    const std::vector<Advice> advice = simulator.advice();
    return std::any_of(advice.begin(), advice.end(), [&](const Advice& line) {
      return line.text.find("steps of 20 ms damp") != std::string::npos &&
             line.text.find("beside its own 3 ms") != std::string::npos && !line.is_warning;
    });
  };
  EXPECT_TRUE(tells("0.02", "0.003"));
  EXPECT_FALSE(tells("0.02", "0.03"));
  EXPECT_FALSE(tells("0.002", "0.003"));
}

TEST(Advisor, DoubtsPartsThatNothingHolds) {
  TetMesh mesh = makeBlockMesh({Vector3(0.02, 0.02, 0.02), {2, 2, 2}, {}}, BlockSplit::kSix);
  const auto nodes = static_cast<int>(mesh.positions.cols());
  const std::size_t elements = mesh.tetrahedra.size();
  mesh.positions.conservativeResize(3, 2 * nodes);
  mesh.positions.rightCols(nodes) = mesh.positions.leftCols(nodes).colwise() + Vector3(0.0, 0.0, 0.03);
  for (std::size_t e = 0; e < elements; ++e) {
    Tetrahedron shifted = mesh.tetrahedra[e];
    for (int& node : shifted) node += nodes;
    mesh.tetrahedra.push_back(shifted);
  }
  const TemporaryDirectory directory;
  const std::string file = directory.write("two.vtk", vtkOf(mesh));
  const auto looseOf = [&](const std::string& fixed) {
    std::vector<std::string> texts;
    for (const Advice& advice :
         makeSimulator(
             "tissues:\n  - name: two\n    mesh: {file: " + file +
             "}\n    material: {youngs_modulus_pa: 5000, density_kg_per_m3: 1000, poissons_ratio: 0.4}\n    fixed: [" +
             fixed + "]\n")
             .advice()) {
      if (advice.text.find("holds no node of some of its parts") != std::string::npos) texts.push_back(advice.text);
    }
    return texts;
  };
  const std::string foot = "{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}";
  const std::vector<std::string> of_one = looseOf(foot);
  ASSERT_EQ(of_one.size(), 1U);
  EXPECT_EQ(
      of_one.front().find(
          "tissue 'two': `fixed` holds no node of some of its parts, 27 of its 54 nodes, of which one is at (-0.01, "
          "-0.01, 0.03) m"),
      0U)
      << of_one.front();
  EXPECT_EQ(looseOf(foot + ", {sphere: {center_m: [0, 0, 0.05], radius_m: 0.001}}").size(), 0U);
}

TEST(Advisor, DoubtsBlocksOfFewCellsOverTheirThickness) {
  const auto doubts = [](const std::string& size_m, const std::string& cells, const std::string& normal) {
    std::vector<std::string> texts;
    for (const Advice& advice :
         makeSimulator("tissues:\n  - name: flap\n    block: {size_m: " + size_m + ", cells: " + cells +
                       "}\n    material: {youngs_modulus_pa: 5000, density_kg_per_m3: 1000, poissons_ratio: 0.4}\n"
                       "    fixed: [{plane: {point_m: [-0.0199, 0, 0.0001], normal: " +
                       normal + "}}]\n")
             .advice()) {
      if (advice.text.find("over its thickness") != std::string::npos) texts.push_back(advice.text);
    }
    return texts;
  };
  const std::vector<std::string> thin = doubts("[0.04, 0.01, 0.002]", "[20, 5, 1]", "[1, 0, 0]");
  ASSERT_EQ(thin.size(), 1U);
  EXPECT_EQ(thin.front().find("tissue 'flap' has 1 cell over its thickness of 2 mm: where it bends it is too stiff"),
            0U);
  EXPECT_EQ(doubts("[0.04, 0.01, 0.002]", "[20, 5, 4]", "[1, 0, 0]").size(), 0U);  // enough
  EXPECT_EQ(doubts("[0.04, 0.01, 0.002]", "[20, 5, 1]", "[0, 0, 1]").size(), 0U);  // lies on its large face
  EXPECT_EQ(doubts("[0.04, 0.005, 0.005]", "[20, 2, 2]", "[0, 0, 1]").size(),
            0U);  // a bar that lies on one of its sides
  EXPECT_EQ(doubts("[0.04, 0.01, 0.011]", "[20, 5, 1]", "[1, 0, 0]").size(), 0U);  // no flap
}

/// Lines about materials by name of a block of such a material, one part of it another's.
std::vector<std::string> presetLines(const std::string& material, const std::string& of_part = "liver_tumour") {
  std::string scene = blockScene("[0.04, 0.04, 0.02]", "[4, 4, 2]", "poissons_ratio: 0.4");
  const std::size_t begin = scene.find("material: {");
  scene.replace(begin, scene.find('}', begin) + 1 - begin,
                material +
                    "\n    regions:\n      - {name: stone, where: [sphere: {center_m: [0, 0, 0.01], radius_m: 0.01}], "
                    "material: " +
                    of_part + "}");
  const Simulator simulator = makeSimulator(scene + onlyBall("[0, 0, 0.0251]"), {{"probe", probeUrdf(0.005)}});
  std::vector<std::string> lines;
  for (const Advice& advice : simulator.advice()) {
    if (advice.text.rfind("material of ", 0) == 0) lines.push_back(advice.text);
  }
  return lines;
}

TEST(Advisor, TellsMaterialsByNameWithTheirSources) {
  EXPECT_EQ(presetLines("material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}").size(), 1U)
      << "the region's alone";
  const std::string source = "; source: Phys. Med. Biol. 64 (2019) 225001, table 1; doi:10.1088/1361-6560/ab5010";
  const std::vector<std::string> named = presetLines("material: liver");
  ASSERT_EQ(named.size(), 2U);
  EXPECT_EQ(
      named[0],
      "material of tissue 'block': liver, E 5400 Pa (range of the source: 4200 to 6600), nu 0.45, density 1060 kg/m^3, "
      "damping.stiffness_s 0.003 s; G = 1.8 +- 0.4 kPa, quasistatic; E = 3 G" +
          source);
  EXPECT_EQ(
      named[1],
      "material of region 'stone' of tissue 'block': liver_tumour, E 70200 Pa (range of the source: 59400 to 70200), "
      "nu 0.45, density 1060 kg/m^3; G = 23.4 kPa (hepatocellular carcinoma), 19.8 kPa (diseased liver); E = 3 G" +
          source);
  const std::vector<std::string> changed = presetLines("material: {preset: liver, youngs_modulus_pa: 6000}");
  ASSERT_EQ(changed.size(), 2U);
  EXPECT_NE(changed[0].find(
                "liver, E 6000 Pa (as the scene says; by name 5400) (range of the source: 4200 to 6600), nu 0.45"),
            std::string::npos)
      << changed[0];
  EXPECT_EQ(presetLines("material: liver", "liver").size(), 1U) << "nothing else";
  for (const MaterialPreset& preset :
       materialPresets()) {  // rosconsole writes other characters as ? where the locale is C
    const std::string line = presetLines("material: " + std::string(preset.name)).at(0);
    EXPECT_TRUE(std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; })) << line;
  }
  const std::vector<std::string> stiff = presetLines("material: liver", "{preset: liver, youngs_modulus_pa: 20000}");
  ASSERT_EQ(stiff.size(), 2U);
  EXPECT_NE(stiff[1].find("liver, E 20000 Pa (as the scene says; by name 5400)"), std::string::npos) << stiff[1];
}

/// Warnings among the advice on a block of such cells under a ball of 5 mm, or other shapes.
std::vector<std::string> warningsOn(const std::string& cells,
                                    const std::string& shapes = "{sphere: {radius_m: 0.005}}") {
  std::string tool = onlyBall("[0, 0, 0.0251]");
  const std::string links = "contact_links: [tip]";
  tool.replace(tool.find(links), links.size(), "contact_links: [{link: tip, shapes: [" + shapes + "]}]");
  const Simulator simulator = makeSimulator(blockScene("[0.04, 0.04, 0.02]", cells, "poissons_ratio: 0.4") + tool,
                                            {{"probe", probeUrdf(0.005)}});
  std::vector<std::string> warnings;
  for (const Advice& advice : simulator.advice()) {
    if (advice.is_warning) warnings.push_back(advice.text);
  }
  return warnings;
}

TEST(Advisor, WarnsOfCellsTooCoarseForWhatTouches) {
  const std::vector<std::string> warnings = warningsOn("[4, 4, 2]");  // of 10 mm
  ASSERT_EQ(warnings.size(), 1U);
  for (const char* part : {"'block'", " mm (its shorter surface edges), under shapes of 5 mm half extent", "% when"}) {
    EXPECT_NE(warnings[0].find(part), std::string::npos) << warnings[0];
  }
  EXPECT_TRUE(warningsOn("[10, 10, 5]").empty());  // of 4 mm, 42 % expected
  // Small parts of a tool seldom carry the force: the largest shape decides.
  EXPECT_TRUE(warningsOn("[10, 10, 5]", "{sphere: {radius_m: 0.005}}, {sphere: {radius_m: 0.001}}").empty());
  EXPECT_EQ(warningsOn("[10, 10, 5]", "{sphere: {radius_m: 0.001}}").size(), 1U);
}

TEST(Advisor, RefusesWhatDoesNotGoTogether) {
  EXPECT_THROW(
      makeSimulator(slabYaml("friction_path: general") + "solver: {method: cone4}\n", {{"probe", probeUrdf(0.005)}}),
      std::invalid_argument);
  Scene scene = parseScene(slabYaml("sleep: auto"), "scene", nullptr);
  scene.advisor.sleep_error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Simulator(scene, ownEnvironment({{"probe", probeUrdf(0.005)}})), std::invalid_argument);
}

}  // namespace advisor_test
}  // namespace tissue_contact
