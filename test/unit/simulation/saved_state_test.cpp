/// A state that is saved and restored: what follows has the same bits, for every model and whatever a scene uses; what does not fit
/// is refused and changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "support/refusal.h"
#include "support/text_scene.h"
#include "tissue_contact/core/content_hash.h"

namespace tissue_contact {
namespace saved_state_test {

struct Variant {
  std::string name;
  std::string material = "model: corotational, poissons_ratio: 0.45";
  std::string tissue = {};  ///< more lines of the block
  std::string scene = {};   ///< more lines of the scene
  int saved_at = 230;       ///< step; 200 steps down, then along
  std::string friction = "static: 0.5, kinetic: 0.4";
};

void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.name; }

/// A 5 mm ball, 0.1 mm above the middle of a block whose base is fixed.
Simulator make(const Variant& variant) {
  const std::string tissue =
      variant.name == "sheet"
          ? "tissues:\n  - name: block\n    sheet: {size_m: [0.06, 0.06], cells: [8, 8], thickness_m: 0.001}\n"
            "    pose: {position_m: [0, 0, 0.0195]}\n"
            "    material: {youngs_modulus_pa: 5000, density_kg_per_m3: 1000, " +
                variant.material + "}\n    fixed: [{box: {min_m: [-1, -1, -1], max_m: [-0.029, 1, 1]}}]\n"
          : blockScene("[0.06, 0.06, 0.02]", "[6, 6, 3]", variant.material);
  return makeSimulator(tissue + variant.tissue + onlyBall("[0.001, 0.002, 0.0251]") +
                           "friction: [{instrument: probe, tissue: block, " + variant.friction + "}]\n" + variant.scene,
                       {{"probe", probeUrdf(0.005)}});
}

/// 20 mm/s: 200 steps down by 4 mm, 100 along, 1000 at rest, away.
VectorX probeAt(int step) {
  const double down = -2e-5 * std::min(step, 200);
  const double away = 2e-5 * std::max(step - 1300, 0);
  return Vector3(2e-5 * std::clamp(step - 200, 0, 100), 0.0, down + away);
}

void go(Simulator& simulator, int from, int to) {
  for (int step = from + 1; step <= to; ++step) simulator.advance(0.001, {probeAt(step)});
}

void expectEqual(const Simulator& a, const Simulator& b, const std::string& when) {
  ASSERT_EQ(a.positions(0).cols(), b.positions(0).cols()) << when;
  EXPECT_TRUE(a.positions(0) == b.positions(0)) << when;
  EXPECT_TRUE(a.velocities(0) == b.velocities(0)) << when;
  EXPECT_EQ(a.wrench(0).force, b.wrench(0).force) << when;
  EXPECT_EQ(a.wrench(0).torque, b.wrench(0).torque) << when;
  EXPECT_EQ(a.stepCount(), b.stepCount()) << when;
  EXPECT_EQ(a.contacts().size(), b.contacts().size()) << when;
}

class SavedState : public ::testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(
    Models, SavedState,
    ::testing::Values(
        Variant{"corotational"}, Variant{"linear", "model: linear, poissons_ratio: 0.4"},
        Variant{"patches", "model: corotational, poissons_ratio: 0.49, dilatation: patch"},
        Variant{"neo_hookean", "model: neo_hookean, poissons_ratio: 0.45"},
        Variant{"neo_hookean_patches", "model: neo_hookean, poissons_ratio: 0.49, dilatation: patch"},
        Variant{"neo_hookean_by_element", "model: neo_hookean, poissons_ratio: 0.45, dilatation: element"},
        Variant{"neo_hookean_patches_asleep", "model: neo_hookean, poissons_ratio: 0.4, dilatation: patch", "",
                "advisor: {sleep_error: 0.01}\n", 1250},
        Variant{"mass_spring", "model: mass_spring, poissons_ratio: 0.25"},
        Variant{"viscoelastic",
                "model: corotational, poissons_ratio: 0.4, prony_series: [{modulus_ratio: 0.5, time_s: 0.1}]"},
        Variant{"sheet", "model: membrane, poissons_ratio: 0.3"},
        Variant{"attached", "model: corotational, poissons_ratio: 0.4",
                "    attachments: [{where: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, 0.011]}}], stiffness_n_per_m: "
                "20}]\n"},
        Variant{"adapting", "model: corotational, poissons_ratio: 0.4", "", "advisor: {rotations: auto}\n"},
        Variant{"by_pressure", "model: corotational, poissons_ratio: 0.4", "", "", 230,
                "static: 0.5, kinetic: 0.4, pressures_pa: [0, 1000], pressure_factors: [1, 0.5]"},
        Variant{"cholesky", "model: corotational, poissons_ratio: 0.45", "", "solver: {relaxation: cholesky}\n"},
        Variant{"before_contact", "model: corotational, poissons_ratio: 0.45", "", "", 3},
        Variant{"asleep", "model: corotational, poissons_ratio: 0.4", "", "advisor: {sleep_error: 0.01}\n", 1250},
        Variant{"refined", "model: corotational, poissons_ratio: 0.45", "    refinement: auto\n"},
        Variant{"refined_around_a_region", "model: corotational, poissons_ratio: 0.45",
                "    refinement: auto\n    regions: [{name: lump, where: [{sphere: {center_m: [0.004, 0.001, 0.014], "
                "radius_m: 0.003}}], material: {youngs_modulus_pa: 20000}}]\n"}),
    [](const auto& variant) { return variant.param.name; });

TEST_P(SavedState, GoesOnToTheSameBits) {
  const int at = GetParam().saved_at;
  Simulator first = make(GetParam());
  go(first, 0, at);
  EXPECT_EQ(first.report().sleeping_nodes > 0, GetParam().name.find("asleep") != std::string::npos);
  EXPECT_EQ(first.meshRevision(0) > 0, GetParam().name.find("refined") == 0);
  const std::string state = first.saveState();
  Simulator second = make(GetParam());
  if (at % 2 == 0) go(second, 0, 60);  // what it was does not matter
  second.restoreState(state);
  expectEqual(first, second, "restored");
  for (const int further : {1, 2, 60, 130}) {
    const int from = static_cast<int>(first.stepCount());
    go(first, from, at + further);
    go(second, from, at + further);
    expectEqual(first, second, std::to_string(further) + " steps on");
  }
  EXPECT_EQ(first.saveState().size(), second.saveState().size());
}

// Not to the bit with `cholesky`, whose factor saving renews.
TEST_P(SavedState, SavingChangesNothing) {
  Simulator watched = make(GetParam());
  Simulator alone = make(GetParam());
  for (int step = 0; step < 260; step += 20) {
    watched.saveState();
    go(watched, step, step + 20);
    go(alone, step, step + 20);
  }
  if (GetParam().name == "cholesky") {
    EXPECT_NEAR(watched.wrench(0).force.z(), alone.wrench(0).force.z(), 1e-3 * alone.wrench(0).force.z());
  } else {
    expectEqual(watched, alone, "saved every 20 steps");
  }
}

/// Steps too short to find anything slowly hand on what those before have found.
TEST(SavedStateOfAMovedMesh, IsOfThatMesh) {
  const Variant variant{"refined", "model: corotational, poissons_ratio: 0.45", "    refinement: auto\n",
                        "solver: {iterations: 2}\n"};
  Simulator first = make(variant);
  Simulator second = make(variant);
  go(first, 0, 230);
  ASSERT_GT(first.meshRevision(0), 0);
  second.restoreState(first.saveState());
  go(first, 230, 235);
  go(second, 230, 235);
  expectEqual(first, second, "two iterations a step");
}

// Of the smallest tools that a scene may have.
TEST(SavedStateOfAMovedMesh, IsOfCellsOfLessThanAMicrometre) {
  const auto make = [] {
    return makeSimulator(
        blockScene("[0.0006, 0.0006, 0.0002]", "[6, 6, 2]", "model: corotational, poissons_ratio: 0.45") +
            "    refinement: auto\n" + onlyBall("[0, 0, 0.0002022]"),
        {{"probe", probeUrdf(2e-6)}});
  };
  Simulator first = make();
  Simulator second = make();
  for (int k = 1; k <= 40; ++k) first.advance(0.001, {Vector3(0.0, 0.0, -2e-8 * k)});
  ASSERT_GT(first.meshRevision(0), 0);
  ASSERT_GT(first.wrench(0).force.z(), 0.0);
  second.restoreState(first.saveState());
  for (Simulator* one : {&first, &second}) one->advance(0.001, {Vector3(0.0, 0.0, -8.2e-7)});
  expectEqual(first, second, "small");
}

const Variant kPlain{"corotational"};

class RefusedState : public ::testing::Test {
 protected:
  /// Message, after a look at whether anything has changed.
  std::string refusalOf(const std::string& state, const Variant& variant = kPlain) {
    Simulator simulator = make(variant);
    Simulator untouched = make(variant);
    go(simulator, 0, 40);
    go(untouched, 0, 40);
    std::string message = refusal([&] { simulator.restoreState(state); });
    go(simulator, 40, 60);
    go(untouched, 40, 60);
    expectEqual(simulator, untouched, message);
    return message;
  }

  std::string saved() {
    Simulator simulator = make(kPlain);
    go(simulator, 0, 100);
    return simulator.saveState();
  }
};

TEST_F(RefusedState, OfAnotherSceneWithTheReason) {
  const std::string state = saved();
  EXPECT_NE(refusalOf(state, {"softer", "model: corotational, poissons_ratio: 0.44"}).find("material"),
            std::string::npos);
  EXPECT_NE(refusalOf(state, {"another law", "model: linear, poissons_ratio: 0.45"}).find("material"),
            std::string::npos);
  EXPECT_NE(refusalOf(state, {"moved", kPlain.material, "    pose: {position_m: [0, 0, 0.001]}\n"}).find("mesh"),
            std::string::npos);
  EXPECT_NE(refusalOf(state, {"refined", kPlain.material, "    refinement: auto\n"}).find("refined"),
            std::string::npos);
  Simulator thicker_tool = makeSimulator(
      blockScene("[0.06, 0.06, 0.02]", "[6, 6, 3]", kPlain.material) + onlyBall("[0.001, 0.002, 0.0251]") +
          "friction: [{instrument: probe, tissue: block, " + kPlain.friction + "}]\n",
      {{"probe", probeUrdf(0.006)}});
  EXPECT_NE(refusal([&] { thicker_tool.restoreState(state); }).find("another model"), std::string::npos);
  Simulator without_tool = makeSimulator(blockScene() + "instruments: []\n");
  EXPECT_NE(refusal([&] { without_tool.restoreState(state); }).find("number of instruments"), std::string::npos);
}

TEST_F(RefusedState, WhateverByteOfItIsChangedOrMissing) {
  const std::string state = saved();
  std::string changed = state;
  for (std::size_t at = 0; at < state.size(); at += state.size() / 7 + 1) {
    changed[at] = static_cast<char>(changed[at] ^ 1);
    EXPECT_FALSE(refusalOf(changed).empty()) << at;
    changed[at] = state[at];
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, state.size() / 2, state.size() - 1}) {
    EXPECT_FALSE(refusalOf(state.substr(0, size)).empty()) << size;
  }
  EXPECT_FALSE(refusalOf(state + "x").empty());
}

std::string withChecksum(std::string content) {
  ContentHash hash;
  hash.add(content.data(), content.size());
  const std::uint64_t value = hash.value();
  return content.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename T>
std::string bytesOf(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

TEST_F(RefusedState, WithAContactThatNoneIs) {
  Simulator simulator = make(kPlain);
  go(simulator, 0, 100);
  const std::string state = simulator.saveState();
  ASSERT_FALSE(simulator.contacts().empty());
  const Contact& contact = simulator.contacts().front().contact;
  const ContactKey& key = contact.key;
  std::string beginning;  // of a contact in a state
  for (const int index : {key.tissue, key.instrument, key.link, key.shape, key.corner}) beginning += bytesOf(index);
  const std::size_t slot =
      state.rfind(beginning + bytesOf(key.slot) + bytesOf(key.other_tissue) + bytesOf(key.feature));
  ASSERT_NE(slot, std::string::npos);
  const std::size_t slot_at = slot + beginning.size();
  const std::size_t weights_at = state.find(bytesOf(contact.weights), slot_at);
  ASSERT_NE(weights_at, std::string::npos);
  const std::size_t rotation_at = state.find(bytesOf(contact.R_WC), weights_at);
  ASSERT_NE(rotation_at, std::string::npos);
  const auto refusalWith = [&](std::size_t at, const std::string& bytes) {
    std::string content = state.substr(0, state.size() - sizeof(std::uint64_t));
    return refusalOf(withChecksum(content.replace(at, bytes.size(), bytes)));
  };
  for (const int wrong : {-1, 4, 100000})
    EXPECT_NE(refusalWith(slot_at, bytesOf(wrong)).find("slot"), std::string::npos);
  const std::string nan = bytesOf(std::numeric_limits<double>::quiet_NaN());
  for (const std::size_t at : {weights_at + sizeof(double), rotation_at + sizeof(double)}) {
    EXPECT_NE(refusalWith(at, nan).find("place"), std::string::npos) << at;
  }
}

// Made to deceive: with the right checksum. Whatever it says, the simulation goes on or refuses, with finite numbers.
TEST_F(RefusedState, WhateverStandsInItNothingBreaks) {
  const std::string state = saved();
  const std::size_t end = state.size() - sizeof(std::uint64_t);
  int refused = 0;
  constexpr int kPlaces = 300;
  for (int k = 0; k < kPlaces; ++k) {
    std::string deceiving = state.substr(0, end);
    // The end holds the contacts.
    const std::size_t at =
        k < kPlaces / 2 ? end - 1 - 61 * static_cast<std::size_t>(k) : end / kPlaces * static_cast<std::size_t>(k) + 40;
    for (std::size_t i = at; i < std::min(at + 8, end); ++i) deceiving[i] = static_cast<char>(k % 2 == 0 ? 0xff : 0x7f);
    deceiving = withChecksum(deceiving);
    Simulator simulator = make(kPlain);
    try {
      simulator.restoreState(deceiving);
    } catch (const std::invalid_argument&) {
      ++refused;
      continue;
    }
    go(simulator, 100, 103);
    EXPECT_TRUE(simulator.positions(0).allFinite()) << at;
    EXPECT_TRUE(simulator.wrench(0).force.allFinite()) << at;
  }
  EXPECT_GT(refused, 0);  // most places are numbers, which may have any value
}

}  // namespace saved_state_test
}  // namespace tissue_contact
