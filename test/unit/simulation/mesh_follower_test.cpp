/// @file
/// Meshes that are prepared beside the steps: when they are begun and used, that neither the speed of the worker nor saving, changed
/// materials or a second tissue makes another bit, and what becomes of errors. Run with the thread sanitizer as well.
#include "simulation/mesh_follower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/refusal.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace {

TissueDescription block() {
  TissueDescription description;
  description.name = "block";
  description.geometry = BlockDescription{Vector3(0.1, 0.1, 0.04), {10, 10, 4}, {}};
  description.material.youngs_modulus_pa = 5000.0;
  description.material.poissons_ratio = 0.45;
  description.material.density_kg_per_m3 = 1000.0;
  description.fixed = {PlaneRegion{Vector3::Zero(), Vector3::UnitZ()}};
  description.refinement = {RefinementDescription::Mode::kAuto, 0.0, 0.0, 0};
  return description;
}

constexpr double kStep = 0.001;

/// Touched on the upper face; the fine cells reach 3.75 mm.
TouchedPlace at(double x, double speed = 0.0, bool touches = true) {
  return {Vector3(x, 0.0, 0.04), 0.00125, Vector3(speed, 0.0, 0.0), touches};
}

/// A follower of a block at rest, in steps of a millisecond.
struct Followed {
  TissueRefinement refinement{block(), Pose::Identity(), nullptr};
  FoldWatch folds;
  std::unique_ptr<MeshFollower> follower;
  BackgroundWorker worker;
  int steps = 0;

  Followed() {
    const MeshUsers users = {0, ElasticModel::kCorotational, false, &folds};
    follower = std::make_unique<MeshFollower>(users, refinement, worker);
  }
  ComingMesh* step(const std::vector<TouchedPlace>& places) {
    return follower->follow(places, refinement.mesh().mesh.positions, steps++ == 0 ? 0.0 : kStep);
  }
  /// How many steps later than the next one goes over to another mesh; 100: none does.
  int stepsUntilItMoves(const std::vector<TouchedPlace>& places) {
    for (int k = 0; k < 100; ++k) {
      if (step(places) != nullptr) return k;
    }
    return 100;
  }
};

TEST(MeshFollower, HasTheFirstMeshAtOnce) {
  Followed followed;
  ComingMesh* const coming = followed.step({at(0.0, 0.0, false)});
  ASSERT_NE(coming, nullptr);
  ASSERT_TRUE(coming->tissue.has_value());
  EXPECT_GT(coming->tissue->nodeCount(), 700);
  EXPECT_EQ(followed.refinement.revision(), 1);
  EXPECT_EQ(followed.follower->moves().at_once, 1);
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.0)}), 100);
}

// From .5 of the reach on one is prepared; what comes near as well, before it touches.
TEST(MeshFollower, HasOthersTwentyStepsAfterTheyAreBegun) {
  for (const bool touches : {true, false}) {
    Followed followed;
    followed.step({at(0.0)});
    EXPECT_EQ(followed.stepsUntilItMoves({at(0.003, 0.0, touches)}), 20);
    EXPECT_EQ(followed.follower->moves().prepared, 1);
    EXPECT_EQ(followed.follower->moves().at_once, 1) << "the first";
    EXPECT_GT(followed.refinement.tissue().nodeCount(), 700);
    EXPECT_TRUE(followed.refinement.cells().isCovered({Vector3(0.003, 0.0, 0.04), 0.00125}, FineCells::kCovered));
  }
}

// At 100 mm/s a place .6 mm from the middle of what is fine leaves half the reach (1.875 mm) within 20 steps; the mesh is fine for as long
// as the next one would take, 4 mm on.
TEST(MeshFollower, SeesAheadByTheSpeedOfWhatTouches) {
  Followed followed;
  followed.step({at(0.0)});
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.0006)}), 100);
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.0006, 0.1)}), 20);
  for (double x = 0.0; x <= 0.0046; x += 0.0002) {
    EXPECT_TRUE(followed.refinement.cells().isCovered({Vector3(x, 0.0, 0.04), 0.00125}, FineCells::kCovered)) << x;
  }
}

TEST(MeshFollower, HasOneAtOnceWhereSomethingTouchesThatJumpedThere) {
  Followed followed;
  followed.step({at(0.0)});
  EXPECT_EQ(followed.step({at(0.01, 0.0, false)}), nullptr) << "it does not touch yet";
  EXPECT_NE(followed.step({at(0.02)}), nullptr);
  EXPECT_EQ(followed.follower->moves().at_once, 2);
  EXPECT_TRUE(followed.refinement.cells().isCovered({Vector3(0.02, 0.0, 0.04), 0.00125}, FineCells::kCovered));
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.02)}), 100) << "what was begun for where it was is dropped";
}

TEST(MeshFollower, WaitsForAWorkerThatIsLate) {
  Followed followed;
  followed.step({at(0.0)});
  followed.worker.start([] { std::this_thread::sleep_for(std::chrono::seconds(1)); });
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.003)}), 20);
  EXPECT_EQ(followed.follower->moves().waited, 1);
}

TEST(MeshFollower, TellsOfLongerCellsWhileSomethingTouches) {
  Followed followed;
  followed.step({at(0.0)});
  EXPECT_EQ(followed.follower->coarsening(), 1.0);
  std::vector<TouchedPlace> places;
  for (int k = 0; k < 60; ++k) places.push_back(at(-0.04 + 0.0014 * k));
  followed.step(places);
  EXPECT_GT(followed.follower->coarsening(), 1.0) << "3000 nodes are not enough";
  followed.step({});
  EXPECT_EQ(followed.follower->coarsening(), 1.0);
}

// A region that no element has: a scene with it would not have been built.
TEST(MeshFollower, ThrowsWhatTheWorkerThrewAndGoesOn) {
  Followed followed;
  followed.step({at(0.0)});
  followed.refinement.description().regions.resize(1);
  followed.refinement.description().regions[0].name = "nowhere";
  followed.refinement.description().regions[0].where = {SphereRegion{Vector3(1.0, 1.0, 1.0), 0.01}};
  expectContains(refusal([&] { followed.stepsUntilItMoves({at(0.003)}); }), {"'block'", "'nowhere'"});
  EXPECT_EQ(followed.refinement.revision(), 1);
  followed.refinement.description().regions.clear();
  EXPECT_EQ(followed.stepsUntilItMoves({at(0.003)}), 20);
  EXPECT_EQ(followed.refinement.revision(), 2);
}

/// Two blocks beside each other, each with a ball of 5 mm some tenths of a millimetre above it. @param modulus_pa of the first.
std::string twoBlocks(int modulus_pa = 5000) {
  const auto tissue = [](const std::string& name, const std::string& modulus, const std::string& x) {
    return "  - name: " + name +
           "\n    block: {size_m: [0.06, 0.06, 0.03], cells: [6, 6, 3]}\n    pose: {position_m: [" + x +
           ", 0, 0]}\n    material: {model: corotational, youngs_modulus_pa: " + modulus +
           ", poissons_ratio: 0.45, density_kg_per_m3: 1000}\n    damping: {stiffness_s: 0.003}\n"
           "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n    refinement: auto\n";
  };
  return "tissues:\n" + tissue("block", std::to_string(modulus_pa), "0") + tissue("other", "5000", "0.1") +
         "instruments:\n" + probeEntry("probe", "/a", "[-0.01, 0.001, 0.0352]") +
         probeEntry("second", "/b", "[0.1, 0.002, 0.0354]") +
         "friction:\n  - {instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}\n"
         "  - {instrument: second, tissue: other, static: 0.5, kinetic: 0.4}\n";
}

/// 80 steps down, then along at 50 and 40 mm/s.
void go(Simulator& simulator, long to) {
  while (simulator.stepCount() < to) {
    const auto k = static_cast<double>(simulator.stepCount() + 1);
    const double down = -2.5e-5 * std::min(k, 80.0);
    const double along = std::max(k - 80.0, 0.0);
    simulator.advance(kStep, {Vector3(5e-5 * along, 0.0, down), Vector3(0.0, 4e-5 * along, 0.9 * down)});
  }
}

void expectEqual(const Simulator& a, const Simulator& b, const std::string& when) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(a.wrench(i).force, b.wrench(i).force) << when;
    ASSERT_EQ(a.positions(i).cols(), b.positions(i).cols()) << when;
    EXPECT_TRUE(a.positions(i) == b.positions(i)) << when;
    EXPECT_TRUE(a.velocities(i) == b.velocities(i)) << when;
  }
}

TEST(PreparedMeshes, MoveInTwoTissuesAndRepeatToTheBit) {
  Simulator first = makeSimulator(twoBlocks());
  go(first, 260);
  for (int t = 0; t < 2; ++t) {
    EXPECT_GE(first.meshMoves(t).prepared, 2) << t;
    EXPECT_EQ(first.meshMoves(t).at_once, 1) << t;
  }
  Simulator second = makeSimulator(twoBlocks());
  for (long k = 10; k <= 260; k += 10) {
    go(second, k);
    std::this_thread::sleep_for(std::chrono::milliseconds(k % 50 == 0 ? 30 : 0));  // the worker is ahead, or is not
  }
  expectEqual(first, second, "at the end");
}

// Each of these steps lies before, within or after some preparation, or between its mesh and its stiffness.
TEST(PreparedMeshes, StatesSavedWhileTheyArePreparedGoOnToTheSameBits) {
  Simulator whole = makeSimulator(twoBlocks());
  Simulator saved = makeSimulator(twoBlocks());
  Simulator restored = makeSimulator(twoBlocks());
  long at = 96;
  go(whole, at);
  go(saved, at);
  for (const long further : {1, 4, 9, 2, 7, 3, 8, 21, 5, 13, 6, 30}) {
    restored.restoreState(saved.saveState());
    at += further;
    go(whole, at);
    go(saved, at);
    go(restored, at);
    expectEqual(whole, restored, "step " + std::to_string(at));
    std::swap(saved, restored);
  }
  EXPECT_GE(whole.meshMoves(0).prepared, 3);
}

// Of what is being prepared too: a simulation that was built of the new material takes the state after the move.
TEST(PreparedMeshes, TakeMaterialsThatChangeMeanwhile) {
  for (const long changed_at : {100, 104, 109, 113, 118, 123}) {
    Simulator simulator = makeSimulator(twoBlocks());
    go(simulator, changed_at);
    Scene scene = simulator.scene();
    scene.tissues[0].material.youngs_modulus_pa = 8000.0;
    simulator.retune(scene);
    const int revision = simulator.meshRevision(0);
    go(simulator, changed_at + 60);
    EXPECT_GT(simulator.meshRevision(0), revision);
    Simulator stiff = makeSimulator(twoBlocks(8000));
    stiff.restoreState(simulator.saveState());
    go(simulator, changed_at + 70);
    go(stiff, changed_at + 70);
    expectEqual(simulator, stiff, "changed at step " + std::to_string(changed_at));
  }
}

TEST(PreparedMeshes, ResetAndEndWhileTheyArePrepared) {
  Simulator simulator = makeSimulator(twoBlocks());
  Simulator other = makeSimulator(twoBlocks());
  go(other, 150);
  for (const long until : {100, 105, 110, 115, 120}) {
    go(simulator, until);
    simulator.reset();
  }
  go(simulator, 150);
  expectEqual(simulator, other, "after resets");
}

}  // namespace
}  // namespace tissue_contact
