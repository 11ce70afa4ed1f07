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

thread_local bool counting = false;  // of the thread that steps: workers prepare meshes beside it
thread_local long allocations = 0;

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

constexpr const char* kStiffNodule =
    "    regions: [{name: nodule, where: [{sphere: {center_m: [0, 0, 0.01], radius_m: 0.01}}],\n"
    "               material: {youngs_modulus_pa: 1e5}}]\n";

/// Touched by the probe before the block is.
constexpr const char* kSheetOnTop =
    "  - name: sheet\n    sheet: {size_m: [0.05, 0.05], cells: [9, 9], thickness_m: 0.001}\n"
    "    pose: {position_m: [0, 0, 0.0202]}\n"
    "    material: {youngs_modulus_pa: 50000, poissons_ratio: 0.4, density_kg_per_m3: 1000}\n";

void PrintTo(const Case& value, std::ostream* out) { *out << value.name; }

/// Before a test: a sanitizer has a malloc of its own, so that nothing would be counted.
void skipUnlessCounted() {
#ifndef TISSUE_CONTACT_COUNTS_MALLOC
  GTEST_SKIP() << "this build has a malloc of its own";
#endif
}

bool stepAllocates(Simulator& simulator, const std::vector<VectorX>& joints) {
  allocations = 0;
  counting = true;
  simulator.advance(0.001, joints);
  counting = false;
  return allocations > 0;
}

class Allocation : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override { skipUnlessCounted(); }

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
  Simulator simulator = makeScene();
  EXPECT_GT(run(simulator), 0) << "allocations are not counted here";
  EXPECT_FALSE(simulator.contacts().empty());
  simulator.reset();
  EXPECT_EQ(run(simulator), 0);
}

INSTANTIATE_TEST_SUITE_P(
    , Allocation,
    testing::Values(Case{"Corotational", "", ""},                                                //
                    Case{"AveragedDilatation", ", model: corotational, dilatation: patch", ""},  //
                    Case{"NeoHookean", ", model: neo_hookean", ""},                              //
                    Case{"AveragedNeoHookean", ", model: neo_hookean, dilatation: patch", ""},   //
                    Case{"Linear", ", model: linear", ""},                                       //
                    Case{"MassSpring", ", model: mass_spring", ""},                              //
                    Case{"NeverAsleep", "", "advisor: {sleep: never}\n"},
                    Case{"AttachedAndPressed", "", "", kAttachedAndPressed}, Case{"StiffNodule", "", "", kStiffNodule},
                    Case{"Viscoelastic", ", prony_series: [{modulus_ratio: 1, time_s: 0.1}]", ""},
                    Case{"FrictionOverPressure", "", "", "", ", pressures_pa: [0, 5000], pressure_factors: [1, 0.8]"},
                    Case{"FrictionOverSpeed", "", "", "", ", speeds_m_per_s: [0, 0.05], speed_factors: [1, 0.8]"},
                    Case{"SheetBetween", "", "tissue_pairs: [{tissue: block, other: sheet}]\n", kSheetOnTop},
                    Case{"AdaptedRotations", "", "advisor: {rotations: auto}\n"}),
    [](const auto& one) { return std::string(one.param.name); });

class AllocationAtRest : public Allocation {};

/// Nodes that fall asleep and wake: pressed, held until all rests, let go, and again.
TEST_P(AllocationAtRest, NoneWhereNodesSleepAndWake) {
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

class AllocationOfScenes : public testing::Test {
 protected:
  void SetUp() override { skipUnlessCounted(); }
};

/// A ball of 5 mm that presses into the middle of what lies 20 mm high, and drags over it, there and back.
std::vector<VectorX> pressAndDrag(int k) {
  const int dragged = std::max(0, k - 50);
  return {Vector3(4e-5 * (dragged < 70 ? dragged : 140 - dragged), 0.0, -5e-5 * std::min(k, 50))};
}

TEST_F(AllocationOfScenes, NoneUnderAToolWithEdges) {
  Simulator simulator =
      makeSimulator(blockScene("[0.06, 0.06, 0.02]", "[15, 15, 3]") +
                        "instruments:\n  - name: probe\n    robot_description: probe\n    tip_link: tip\n" +
                        "    joint_state_topics: [/js]\n    base_pose: {position_m: [0, 0, 0.022]}\n" +
                        "    contact_links: [{link: tip, shapes: [box: {size_m: [0.012, 0.008, 0.004]}]}]\n" +
                        "friction: [{instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}]\n",
                    {{"probe", probeUrdf(0.005)}});
  EXPECT_EQ(allocatingSteps(simulator, 200, pressAndDrag), 0);
  EXPECT_FALSE(simulator.contacts().empty());
}

TEST_F(AllocationOfScenes, NoneWhereASheetIsTouched) {
  Simulator simulator = makeSimulator(
      "tissues:\n  - name: sheet\n    sheet: {size_m: [0.06, 0.06], cells: [8, 8], thickness_m: 0.001}\n"
      "    pose: {position_m: [0, 0, 0.02]}\n"
      "    material: {youngs_modulus_pa: 50000, poissons_ratio: 0.4, density_kg_per_m3: 1000}\n"
      "    damping: {stiffness_s: 0.003}\n    fixed: [{plane: {point_m: [-0.03, 0, 0], normal: [1, 0, 0]}},\n"
      "            {plane: {point_m: [0.03, 0, 0], normal: [-1, 0, 0]}}]\n"
      "instruments:\n" +
      probeEntry("probe", "/js", "[0, 0, 0.0255]") +
      "friction: [{instrument: probe, tissue: sheet, law: orthotropic, static: [0.5, 0.3], kinetic: [0.4, 0.2],\n"
      "            axis: {link_direction: [1, 0, 0]}}]\n");
  EXPECT_EQ(allocatingSteps(simulator, 200, pressAndDrag), 0);
  EXPECT_FALSE(simulator.contacts().empty());
}

/// A block under a probe, with more lines of the tissue and of the scene.
Simulator makeProbedBlock(const std::string& tissue, const std::string& sections) {
  return makeSimulator(blockScene() + tissue + "instruments:\n" + probeEntry("probe", "/js", "[0, 0, 0.0255]") +
                       "friction: [{instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}]\n" + sections);
}

/// The first step factors, then one where the ball has landed and one where it has slid; a factor is Eigen's, made anew.
TEST_F(AllocationOfScenes, OnlyInTheFewStepsThatRenewAFactor) {
  Simulator simulator = makeProbedBlock("", "solver: {relaxation: cholesky}\n");
  int moving = 0;
  int held = 0;
  for (int run = 0; run < 2; ++run) {
    simulator.reset();
    moving = held = 0;
    for (int k = 0; k < 290; ++k) {
      const bool allocated = stepAllocates(simulator, pressAndDrag(std::min(k, 190)));
      (k <= 190 ? moving : held) += allocated ? 1 : 0;
    }
  }
  EXPECT_GT(moving, 0) << "no factor was made";
  EXPECT_LE(moving, 6);
  EXPECT_EQ(held, 0);
  EXPECT_FALSE(simulator.contacts().empty());
}

/// A move exchanges what the worker has made for what was there. Nodes carried over have memory of the new number, in the move and
/// where its stiffness is begun, and what is handed to the worker may have some of its own.
TEST_F(AllocationOfScenes, FewWhereAPreparedMeshIsTakenOver) {
  constexpr long kInAMove = 12;
  constexpr long kBesideMoves = 2;
  Simulator simulator = makeProbedBlock("    refinement: {cell_m: 0.003, reach_m: 0.003}\n", "");
  for (int k = 0; k < 400; ++k) stepAllocates(simulator, pressAndDrag(k));
  simulator.reset();
  stepAllocates(simulator, pressAndDrag(0));  // has its mesh at once
  const MeshMoves before = simulator.meshMoves(0);
  int others = 0;
  for (int k = 1; k < 400; ++k) {
    const int revision = simulator.meshRevision(0);
    const bool allocated = stepAllocates(simulator, pressAndDrag(k));
    const bool moved = simulator.meshRevision(0) != revision;
    EXPECT_LE(allocations, moved ? kInAMove : kBesideMoves) << k;
    others += allocated && !moved ? 1 : 0;
  }
  const MeshMoves after = simulator.meshMoves(0);
  EXPECT_EQ(after.at_once, before.at_once);
  EXPECT_GE(after.prepared, before.prepared + 3);
  EXPECT_LE(others, 2 * (after.prepared - before.prepared));  // begun, and its stiffness begun
}

TEST_F(AllocationOfScenes, NoneWhereTissuesTouch) {
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

TEST_F(AllocationOfScenes, NoneInAGrasp) {
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
