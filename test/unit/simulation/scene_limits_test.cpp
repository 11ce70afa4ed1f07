/// What a scene may take in all: refused with figures, place and fix before memory is taken; what large scenes tell while
/// they are built.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "simulation/scene_budget.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace scene_limits_test {

const char* const kMaterial = "    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n";

std::string tissue(const std::string& name, const std::string& geometry) {
  return "  - name: " + name + "\n    " + geometry + "\n" + kMaterial;
}

std::string block(const std::string& name, int cells) {
  const std::string n = std::to_string(cells);
  return tissue(name, "block: {size_m: [0.1, 0.1, 0.1], cells: [" + n + ", " + n + ", " + n + "]}");
}

/// What building is refused with, or "".
std::string refusal(const std::string& yaml, std::vector<std::string>* said = nullptr) {
  SceneEnvironment environment;
  if (said != nullptr) environment.meshes.say = [said](const std::string& line) { said->push_back(line); };
  try {
    const Simulator simulator(parseScene(yaml, "scene.yaml", nullptr), environment);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// Largest resident size of this process so far, MB.
long residentMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

void expectHas(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(SceneLimits, CountElementsOfAllTissuesBeforeMemoryIsTaken) {
  const long before = residentMegabytes();
  const std::string message = refusal("tissues:\n" + block("liver", 65) + block("spleen", 55));
  EXPECT_EQ(message.find("scene.yaml:5: tissues[1]: tissue 'spleen' has 831875 tetrahedra, 175616 nodes, about "), 0U)
      << message;
  expectHas(message, "2205000 elements in the scene, at most 2000000 are allowed; use fewer cells");
  // One of the two alone would take more than a gigabyte.
  EXPECT_LT(residentMegabytes() - before, 100);
}

TEST(SceneLimits, BoundTheMemoryOfMembranes) {
  const std::string sheet = "sheet: {size_m: [1, 1], cells: [700, 700], thickness_m: 0.001}";
  const std::string message = refusal("tissues:\n" + tissue("skin", sheet));
  EXPECT_EQ(message.find("scene.yaml:2: tissues[0]: tissue 'skin' has 980000 triangles"), 0U) << message;
  expectHas(message, "at most 4096 MB are allowed");
}

TEST(SceneLimits, BoundTheFactor) {
  const long before = residentMegabytes();
  for (const char* solver : {"relaxation: cholesky", "method: reference", "method: condensed_lcp"}) {
    const std::string message = refusal("tissues:\n" + block("liver", 40) + "solver: {" + solver + "}\n");
    EXPECT_EQ(message.find("scene.yaml:2: tissues[0]: tissue 'liver' has 320000 tetrahedra, 68921 nodes"), 0U)
        << message;
    expectHas(message, "at most 2048 MB; use solver: {relaxation: gauss_seidel} or fewer cells");
  }
  EXPECT_LT(residentMegabytes() - before, 100);
}

TEST(SceneLimits, AddUp) {
  const Scene scene = parseScene("tissues:\n" + block("liver", 1), "scene.yaml", nullptr);
  SceneBudget budget(scene);
  EXPECT_NO_THROW(budget.add(scene.tissues[0], 400000, kMostElements));
  EXPECT_THROW(budget.add(scene.tissues[0], 4, 1), EntryError);
}

TEST(BuildProgress, IsToldForLargeTissuesOnly) {
  std::vector<std::string> said;
  EXPECT_EQ(refusal("tissues:\n" + block("liver", 10), &said), "");
  EXPECT_TRUE(said.empty()) << said.front();
  EXPECT_EQ(refusal("tissues:\n" + block("pad", 2) + block("liver", 28), &said), "");
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[0].find("building tissue 'liver' (2 of 2): 109760 tetrahedra, 24389 nodes, about "), 0U) << said[0];
  EXPECT_EQ(said[1], "tissues are built; preparing their surfaces and first stiffness");
}

}  // namespace scene_limits_test
}  // namespace tissue_contact
