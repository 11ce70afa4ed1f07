#include <algorithm>
#include <limits>
#include <stdexcept>

#include "benchmark/benchmark.h"
#include "tissue_contact/core/command_line.h"
#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

const std::vector<std::string> kScenes = {"press-drag", "grasp", "partial-slip", "robot", "robot-sweep"};

void requireTogether(const CommandLine& line) {
  const bool own = line.has("--scene");
  if (own != line.has("--bag")) throw std::invalid_argument("--scene and --bag belong together; give both");
  for (const char* const key : {"--urdf", "--from", "--duration"}) {
    if (!own && line.has(key)) throw std::invalid_argument(std::string(key) + " needs --scene and --bag");
  }
  for (const char* const key : {"--out", "--only", "--robot-bag", "--quick", "--no-plot"}) {
    if (own && line.has(key)) throw std::invalid_argument(std::string(key) + " does not go with --scene");
  }
  const std::string only = line.value("--only");
  if (!only.empty() && std::find(kScenes.begin(), kScenes.end(), only) == kScenes.end()) {
    throw std::invalid_argument("--only '" + only + "' is unknown; " + suggestion(only, kScenes) +
                                "there are: " + joined(kScenes));
  }
  const bool plays_recording = only.rfind("robot", 0) == 0;
  if (!only.empty() && !plays_recording && line.has("--robot-bag")) {
    throw std::invalid_argument("--robot-bag does not go with --only " + only + ", which plays no recording");
  }
  if (plays_recording && !line.has("--robot-bag")) {
    throw std::invalid_argument("--only " + only + " needs --robot-bag FILE, the recording of a dVRK PSM");
  }
}

}  // namespace

BenchmarkOptions parseBenchmarkOptions(const std::vector<std::string>& arguments) {
  constexpr double kMost = std::numeric_limits<double>::max();
  const CommandLine line(arguments,
                         {{"--out", "--only", "--robot-bag", "--scene", "--bag", "--urdf", "--from", "--duration"},
                          {"--quick", "--no-plot"},
                          {}});
  BenchmarkOptions options;
  options.help = line.help();
  if (options.help) return options;
  requireTogether(line);
  if (line.has("--out")) options.out_directory = line.value("--out");
  options.only = line.value("--only");
  options.scenes.robot_bag = line.value("--robot-bag");
  options.scenes.quick = line.has("--quick");
  options.plot = !line.has("--no-plot");
  options.own.scene_file = line.value("--scene");
  options.own.bag_file = line.value("--bag");
  options.own.urdf_file = line.value("--urdf");
  TimeWindow& window = options.own.window;
  window.from_s = line.number("--from", window.from_s, {0.0, kMost, "s"});
  window.duration_s = line.number("--duration", window.duration_s, {0.0, kMost, "s", "", true});
  return options;
}

}  // namespace tissue_contact
