/// @file
/// Simulations whose meshes are prepared beside the steps: neither the speed of the worker nor saving, changed materials, a reset or a
/// second tissue makes another bit. Run with the thread sanitizer as well.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/refusal.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace prepared_meshes_test {

constexpr double kStep = 0.001;

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

/// Both balls alike, so that both tissues have their meshes due in the same step.
void goAlike(Simulator& simulator, long to) {
  while (simulator.stepCount() < to) {
    const auto k = static_cast<double>(simulator.stepCount() + 1);
    const Vector3 q(5e-5 * std::max(k - 80.0, 0.0), 0.0, -2.5e-5 * std::min(k, 80.0));
    simulator.advance(kStep, {q, q});
  }
}

// The contacts of the first are those of its new mesh then, in their order, and can be saved and restored.
TEST(PreparedMeshes, OfOneTissueAreUsedThoughThatOfAnotherCannotBeMade) {
  std::string scene = twoBlocks();
  const std::string place = "[0.1, 0.002, 0.0354]";
  scene.replace(scene.find(place), place.size(), "[0.09, 0.001, 0.0352]");
  Simulator simulator = makeSimulator(scene);
  goAlike(simulator, 90);
  Scene bad = simulator.scene();
  bad.tissues[1].material.youngs_modulus_pa = -1.0;
  simulator.retune(bad);
  EXPECT_FALSE(refusal([&] { goAlike(simulator, 91); }).empty());
  std::string error;
  int before = 0;
  for (long k = 91; k <= 260 && error.empty(); ++k) {
    before = simulator.meshRevision(0);
    try {
      goAlike(simulator, k);
    } catch (const std::invalid_argument& refused) {
      error = refused.what();
    }
  }
  expectContains(error, {"youngs_modulus_pa"});
  EXPECT_EQ(simulator.meshRevision(0), before + 1) << "the first moved in that step";
  EXPECT_TRUE(simulator.lastProblem().contacts.empty()) << "they have nodes of the mesh before";
  Simulator restored = makeSimulator(scene);
  EXPECT_NO_THROW(restored.restoreState(simulator.saveState()));
}

TEST(PreparedMeshes, LookNoFartherForWhatComesFastInTinySteps) {
  std::string scene = twoBlocks();
  const std::string place = "[-0.01, 0.001, 0.0352]";
  scene.replace(scene.find(place), place.size(), "[-0.01, 0.001, 0.135]");
  Simulator simulator = makeSimulator(scene);
  const auto advance = [&](double q) { simulator.advance(1e-6, {Vector3(0.0, 0.0, q), Vector3(0.0, 0.0, 0.0)}); };
  advance(-1e-5);  // at 10 m/s: 20 ms would be 200 mm
  EXPECT_EQ(simulator.meshMoves(0).at_once, 0);
  EXPECT_EQ(simulator.meshMoves(1).at_once, 1);
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

/// The steps, up to 260, in which a simulation of the blocks goes over to a prepared mesh of the first.
const std::vector<long>& moves() {
  static const std::vector<long> all = [] {
    std::vector<long> steps;
    Simulator simulator = makeSimulator(twoBlocks());
    for (long k = 1; k <= 260; ++k) {
      const int before = simulator.meshMoves(0).prepared;
      go(simulator, k);
      if (simulator.meshMoves(0).prepared > before) steps.push_back(k);
    }
    return steps;
  }();
  return all;
}

/// So many steps before a move a mesh has been prepared: 20 to 7 its parts, 6 to 1 its stiffness too; at 21 and 0 none.
constexpr long kBeforeMoves[] = {21, 20, 13, 7, 6, 1, 0};

// Saved and restored before, within and after preparations, and between mesh and stiffness.
TEST(PreparedMeshes, StatesSavedWhileTheyArePreparedGoOnToTheSameBits) {
  Simulator whole = makeSimulator(twoBlocks());
  Simulator saved = makeSimulator(twoBlocks());
  Simulator restored = makeSimulator(twoBlocks());
  ASSERT_GE(moves().size(), 2U);
  ASSERT_GE(moves()[1] - moves()[0], 22);
  for (std::size_t m = 0; m < 2; ++m) {
    for (const long before : kBeforeMoves) {
      go(saved, moves()[m] - before);
      restored.restoreState(saved.saveState());
      go(whole, moves()[m] - before + 1);
      go(restored, moves()[m] - before + 1);
      expectEqual(whole, restored, std::to_string(before) + " steps before a move");
      std::swap(saved, restored);
    }
  }
  go(whole, 260);
  go(saved, 260);
  expectEqual(whole, saved, "at the end");
}

// A simulation that was built of the new material takes the state right after the move: the mesh that was being prepared has it.
TEST(PreparedMeshes, TakeMaterialsThatChangeMeanwhile) {
  ASSERT_FALSE(moves().empty());
  for (const long before : {20, 13, 6}) {
    Simulator simulator = makeSimulator(twoBlocks());
    go(simulator, moves()[0] - before);
    Scene scene = simulator.scene();
    scene.tissues[0].material.youngs_modulus_pa = 8000.0;
    simulator.retune(scene);
    const int revision = simulator.meshRevision(0);
    go(simulator, moves()[0]);
    ASSERT_EQ(simulator.meshRevision(0), revision + 1) << before;
    Simulator stiff = makeSimulator(twoBlocks(8000));
    stiff.restoreState(simulator.saveState());
    go(simulator, moves()[0] + 10);
    go(stiff, moves()[0] + 10);
    expectEqual(simulator, stiff, "changed " + std::to_string(before) + " steps before a move");
  }
}

TEST(PreparedMeshes, ResetAndEndWhileTheyArePrepared) {
  Simulator simulator = makeSimulator(twoBlocks());
  Simulator other = makeSimulator(twoBlocks());
  ASSERT_FALSE(moves().empty());
  go(other, moves()[0] + 5);
  for (const long before : {20, 13, 6}) {
    go(simulator, moves()[0] - before);
    simulator.reset();
  }
  go(simulator, moves()[0] + 5);
  expectEqual(simulator, other, "after resets");
  for (const long before : {20, 6}) {
    Simulator ends = makeSimulator(twoBlocks());
    go(ends, moves()[0] - before);
  }
}

}  // namespace prepared_meshes_test
}  // namespace tissue_contact
