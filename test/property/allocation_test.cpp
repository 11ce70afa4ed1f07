// A step allocates nothing once it has done the like before: memory that is asked for in a step may come late.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <vector>

#include "support/text_scene.h"
#include "validation/joint_path.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TISSUE_CONTACT_COUNTS_MALLOC
#endif

namespace {

bool counting = false;
long allocations = 0;

#ifdef TISSUE_CONTACT_COUNTS_MALLOC
void note() { allocations += counting ? 1 : 0; }
#endif

}  // namespace

#ifdef TISSUE_CONTACT_COUNTS_MALLOC
// Also what Eigen and the standard library allocate comes by here.
extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void* old, std::size_t size);               // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT(bugprone-reserved-identifier)
void* malloc(std::size_t size) {
  note();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  note();
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note();
  return __libc_memalign(alignment, size);
}
}
#endif

namespace tissue_contact {
namespace {

/// Of one block that a probe presses and drags over, there and back.
struct Case {
  const char* name;
  const char* material;       ///< more keys of it
  const char* sections;       ///< more of the scene
  const char* tissue = "";    ///< more lines of it
  const char* friction = "";  ///< more keys of it
};

constexpr const char* kAttachedAndPressed =
    "    attachments: [{where: [{plane: {point_m: [0.03, 0, 0], normal: [-1, 0, 0]}}], stiffness_pa_per_m: 1e5}]\n"
    "    pressure_pa: 200\n";

void PrintTo(const Case& value, std::ostream* out) { *out << value.name; }

bool stepAllocates(Simulator& simulator, const std::vector<VectorX>& joints) {
  allocations = 0;
  counting = true;
  simulator.advance(0.001, joints);
  counting = false;
  return allocations > 0;
}

class Allocation : public testing::TestWithParam<Case> {
 protected:
  static Simulator makeScene() {
    std::string block = blockScene("[0.06, 0.06, 0.02]", "[6, 6, 3]");
    const std::string key = "density_kg_per_m3: 1000";
    block.insert(block.find(key) + key.size(), GetParam().material);
    return makeSimulator(block + GetParam().tissue + "instruments:\n" + probeEntry("probe", "/js", "[0, 0, 0.0255]") +
                         "friction: [{instrument: probe, tissue: block, static: 0.5, kinetic: 0.4" +
                         GetParam().friction + "}]\n" + GetParam().sections);
  }

  /// @return steps that allocated.
  static int run(Simulator& simulator) {
    std::vector<VectorX> joints = {simulator.jointPositions(0)};
    int with = 0;
    for (int i = 0; i < 200; ++i) {
      joints[0][2] -= i < 50 ? 5e-5 : 0.0;
      joints[0][0] += i < 50 ? 0.0 : (i < 120 ? 4e-5 : -4e-5);
      with += stepAllocates(simulator, joints) ? 1 : 0;
    }
    return with;
  }
};

TEST_P(Allocation, NoneInAStepThatHasBeenDoneBefore) {
#ifndef TISSUE_CONTACT_COUNTS_MALLOC
  GTEST_SKIP() << "this build has a malloc of its own";
#endif
  Simulator simulator = makeScene();
  EXPECT_GT(run(simulator), 0) << "allocations are not counted here";
  EXPECT_FALSE(simulator.contacts().empty());
  simulator.reset();
  EXPECT_EQ(run(simulator), 0);
}

INSTANTIATE_TEST_SUITE_P(, Allocation,
                         testing::Values(Case{"Corotational", "", ""},                                                //
                                         Case{"AveragedDilatation", ", model: corotational, dilatation: patch", ""},  //
                                         Case{"NeoHookean", ", model: neo_hookean", ""},                              //
                                         Case{"AveragedNeoHookean", ", model: neo_hookean, dilatation: patch", ""},   //
                                         Case{"Linear", ", model: linear", ""},                                       //
                                         Case{"MassSpring", ", model: mass_spring", ""},                              //
                                         Case{"NeverAsleep", "", "advisor: {sleep: never}\n"},
                                         Case{"AttachedAndPressed", "", "", kAttachedAndPressed},
                                         Case{"Viscoelastic", ", prony_series: [{modulus_ratio: 1, time_s: 0.1}]", ""},
                                         Case{"FrictionOverPressure", "", "", "",
                                              ", pressures_pa: [0, 5000], pressure_factors: [1, 0.8]"}),
                         [](const auto& one) { return std::string(one.param.name); });

class AllocationAtRest : public Allocation {};

/// Nodes that fall asleep and wake: pressed, held until all rests, let go, and again.
TEST_P(AllocationAtRest, NoneWhereNodesSleepAndWake) {
#ifndef TISSUE_CONTACT_COUNTS_MALLOC
  GTEST_SKIP() << "this build has a malloc of its own";
#endif
  Simulator simulator = makeScene();
  std::vector<VectorX> joints = {simulator.jointPositions(0)};
  int with = 0;
  int slept = 0;
  for (int cycle = 0; cycle < 3; ++cycle) {
    for (int i = 0; i < 1500; ++i) {
      joints[0][2] -= i < 50 ? 5e-5 : (i >= 750 && i < 800 ? -5e-5 : 0.0);
      const bool allocated = stepAllocates(simulator, joints);
      if (cycle == 2) with += allocated ? 1 : 0;
      if (cycle == 2) slept += simulator.report().sleeping_nodes > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(slept, 0);
  EXPECT_EQ(with, 0);
}

INSTANTIATE_TEST_SUITE_P(, AllocationAtRest,
                         testing::Values(Case{"Corotational", "", ""}, Case{"NeoHookean", ", model: neo_hookean", ""},
                                         Case{"AttachedAndPressed", "", "", kAttachedAndPressed},
                                         Case{"FrictionOverPressure", "", "", "",
                                              ", pressures_pa: [0, 5000], pressure_factors: [1, 0.8]"}),
                         [](const auto& one) { return std::string(one.param.name); });

/// @return steps of a second run that allocated.
template <typename Step>
int allocatingSteps(Simulator& simulator, int steps, const Step& step) {
  int with = 0;
  for (int run = 0; run < 2; ++run) {
    simulator.reset();
    with = 0;
    for (int k = 0; k < steps; ++k) {
      const std::vector<VectorX> joints = step(k);
      with += stepAllocates(simulator, joints) ? 1 : 0;
    }
  }
  return with;
}

TEST(AllocationOfScenes, NoneWhereTissuesTouch) {
#ifndef TISSUE_CONTACT_COUNTS_MALLOC
  GTEST_SKIP() << "this build has a malloc of its own";
#endif
  Simulator simulator =
      makeSimulator("gravity_m_per_s2: [0.5, 0, -9.81]\n" + blockScene() +
                    "  - name: top\n    block: {size_m: [0.02, 0.02, 0.01], cells: [2, 2, 1]}\n"
                    "    pose: {position_m: [0.003, 0.002, 0.02]}\n"
                    "    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}\n"
                    "instruments: []\ntissue_pairs: [{tissue: block, other: top}]\n"
                    "friction: [{tissue: block, other_tissue: top, static: 0.4}]\n");
  EXPECT_EQ(allocatingSteps(simulator, 200, [](int) { return std::vector<VectorX>(); }), 0);
  EXPECT_FALSE(simulator.contacts().empty());
}

TEST(AllocationOfScenes, NoneInAGrasp) {
#ifndef TISSUE_CONTACT_COUNTS_MALLOC
  GTEST_SKIP() << "this build has a malloc of its own";
#endif
  const SceneEnvironment environment = ownEnvironment();
  Simulator simulator(loadScene(packageDirectory() + "/config/grasp.yaml", environment.package_path), environment);
  const std::vector<Vector3> path = graspPath(packageDirectory());
  const auto joints = [&](int k) {
    return std::vector<VectorX>{graspJoints(simulator.instruments()[0], path, path.at(3).x() + 0.001 * k)};
  };
  EXPECT_EQ(allocatingSteps(simulator, 1000, joints), 0);  // the jaws close on the flap
  EXPECT_FALSE(simulator.contacts().empty());
}

}  // namespace
}  // namespace tissue_contact
