/// @file
/// Saved states with changes that their checksum does not betray: refused, with nothing changed, or gone on from. What is then
/// not finite is not published (src/ros/conversions.h).
#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "fuzz/fuzz_support.h"
#include "support/text_scene.h"
#include "tissue_contact/core/content_hash.h"

using namespace tissue_contact;

namespace {

constexpr int kMostChanges = 16;

/// Two balls press two tissues that keep all there is to keep: averaged strain of both kinds, Prony terms,
/// nodes that sleep, a mesh that follows.
Simulator pressed() {
  const std::string second =
      "  - name: other\n    block: {size_m: [0.02, 0.02, 0.01], cells: [2, 2, 1]}\n    pose: {position_m: [0.05, 0, "
      "0]}\n"
      "    material: {model: neo_hookean, dilatation: patch, youngs_modulus_pa: 5000, poissons_ratio: 0.4, "
      "density_kg_per_m3: 1000}\n"
      "    refinement: {cell_m: 0.004, nodes_at_most: 60}\n"
      "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n";
  const auto ball = [](const std::string& name, const std::string& at) {
    return "  - {name: " + name +
           ", robot_description: probe, tip_link: tip, contact_links: [tip], joint_state_topics: [/js], " +
           "base_pose: {position_m: " + at + "}}\n";
  };
  SceneEnvironment environment;
  environment.urdf_text = [](const std::string& /*name*/) { return probeUrdf(0.005); };
  const std::string scene =
      blockScene("[0.02, 0.02, 0.01]", "[2, 2, 1]",
                 "model: corotational, poissons_ratio: 0.49, dilatation: patch, prony_series: [{modulus_ratio: 0.5, "
                 "time_s: 0.1}]") +
      second + "instruments:\n" + ball("left", "[0, 0, 0.0145]") + ball("right", "[0.05, 0, 0.0145]") +
      "friction: [{instrument: left, tissue: block, static: 0.6, kinetic: 0.4}]\nadvisor: {sleep_error: 0.1}\n";
  Simulator simulator(parseScene(scene, "text scene", nullptr), environment);
  for (int step = 1; step <= 40; ++step) {
    const Vector3 at(5e-5 * std::max(step - 20, 0), 0.0, -5e-5 * std::min(step, 20));
    simulator.advance(0.005, {at, at});
  }
  return simulator;
}

std::string changed(std::string state, fuzz::Bytes& bytes) {
  state.resize(state.size() - sizeof(std::uint64_t));
  for (int i = 0; i < kMostChanges && bytes.left() > 0; ++i) {
    const std::size_t at = bytes.take<std::uint32_t>() % state.size();
    const auto count = std::min<std::size_t>(1U << bytes.take<std::uint8_t>() % 4, state.size() - at);
    const auto value = bytes.take<std::uint64_t>();
    std::memcpy(&state[at], &value, count);
  }
  ContentHash content;
  content.add(state.data(), state.size());
  const std::uint64_t hash = content.value();
  state.append(reinterpret_cast<const char*>(&hash), sizeof hash);
  return state;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Simulator simulator = pressed();
  static const std::string state = simulator.saveState();
  simulator.restoreState(state);
  const NodalVectors x = simulator.positions(1);
  fuzz::Bytes bytes(data, size);
  try {
    simulator.restoreState(changed(state, bytes));
  } catch (const std::invalid_argument&) {
    fuzz::require(simulator.positions(1) == x, "a state that is refused changes nothing");
    return 0;
  }
  const long before = simulator.stepCount();
  for (int step = 0; step < 2; ++step) {
    simulator.advance(0.005, {simulator.jointPositions(0), simulator.jointPositions(1)});
  }
  fuzz::require(simulator.stepCount() > before, "it goes on");
  return 0;
}
