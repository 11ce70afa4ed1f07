/// @file
/// Scene files: read, and where the scene is small and names no other file, built and stepped.
#include <stdexcept>
#include <variant>
#include <vector>

#include "fuzz/fuzz_support.h"
#include "support/text_scene.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "tissue_contact/mesh/mesh_description.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/tissue/tissue_description.h"

using namespace tissue_contact;

namespace {

constexpr int kMostNodes = 60;
constexpr double kMostSteps = 4.0;

int nodeCount(const TissueDescription& tissue) {
  double nodes = 1.0;
  if (const auto* block = std::get_if<BlockDescription>(&tissue.geometry)) {
    for (const int cells : block->cells) nodes *= cells + 1.0;
  } else if (const auto* sheet = std::get_if<SheetDescription>(&tissue.geometry)) {
    for (const int cells : sheet->cells) nodes *= cells + 1.0;
  } else {
    return kMostNodes + 1;  // a file
  }
  return static_cast<int>(std::min(nodes, kMostNodes + 1.0));
}

bool isSmall(const Scene& scene) {
  int nodes = 0;
  for (const TissueDescription& tissue : scene.tissues) nodes += std::min(nodeCount(tissue), kMostNodes + 1);
  for (const InstrumentDescription& instrument : scene.instruments) {
    if (!instrument.urdf_file.empty()) return false;
  }
  return nodes <= kMostNodes && scene.instruments.size() <= 3;
}

void step(const Scene& scene, const SceneEnvironment& environment) {
  Simulator simulator(scene, environment);
  std::vector<VectorX> targets;
  for (const Instrument& instrument : simulator.instruments()) targets.push_back(instrument.initialPositions());
  AdvanceLimits limits;
  limits.most_steps = 2;
  simulator.advance(kMostSteps * scene.step.max_step_s, targets, limits);
  for (int t = 0; t < static_cast<int>(simulator.tissues().size()); ++t) {
    fuzz::require(simulator.positions(t).allFinite() && simulator.velocities(t).allFinite(), "finite nodes");
  }
  for (int i = 0; i < static_cast<int>(simulator.instruments().size()); ++i) {
    fuzz::require(simulator.wrench(i).force.allFinite(), "finite wrenches");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const SceneEnvironment environment = [] {
    SceneEnvironment made;
    made.urdf_text = [](const std::string&) { return probeUrdf(0.004); };
    made.frame_pose = [](const std::string&) { return Pose::Identity(); };
    made.clock = [] { return 0.0; };
    return made;
  }();
  try {
    const Scene scene = parseScene(fuzz::textOf(data, size), "input.yaml", {});
    if (isSmall(scene)) step(scene, environment);
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
