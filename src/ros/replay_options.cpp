/// @file
/// Room `ros`: see replay_options.h.
#include "tissue_contact/ros/replay_options.h"

#include <map>
#include <stdexcept>

namespace tissue_contact {
namespace {

void requireGiven(const std::string& value, const std::string& key) {
  if (value.empty()) throw std::invalid_argument("argument " + key + " is missing or has no value; see --help");
}

long stepNumber(const std::string& text) {
  constexpr std::size_t kMostDigits = 15;
  const bool digits = text.find_first_not_of("0123456789") == std::string::npos && text.size() <= kMostDigits;
  const long step = digits ? std::stol(text) : 0;
  if (step < 1) throw std::invalid_argument("--dump-step is '" + text + "'; it must be a step number from 1");
  return step;
}

}  // namespace

std::string replayUsage() {
  return "usage: tissue_contact_replay --scene SCENE.yaml --bag IN.bag --csv OUT.csv [--urdf ROBOT.urdf]\n"
         "         [--timing TIMES.csv] [--dump-step N --dump-file PROBLEM.txt]\n"
         "\n"
         "Plays the joint states of a bag through a scene, with the stepping of tissue_contact_node but without a\n"
         "roscore, and writes one CSV line per state of an arm: the same bytes every time.\n"
         "\n"
         "  --scene FILE  the scene (doc/scene.md)\n"
         "  --bag FILE    a ROS bag with the scene's joint-state topics; tf frames are taken from its /tf_static and "
         "/tf\n"
         "  --csv FILE    the result; replaced when the replay is complete, untouched when it fails or is interrupted\n"
         "  --urdf FILE   text for the robot_description parameter that the scene takes its URDF from\n"
         "  --timing FILE   wall times of this run, one line per simulated interval; replaced or untouched as the CSV\n"
         "  --dump-step N   with --dump-file: write the contact problem of implicit step N (from 1), for "
         "tissue_contact_solve\n"
         "  --dump-file FILE  where to; replaced when that step is taken\n"
         "  --help        this text\n"
         "\n"
         "Results replace regular files only, and keep their permissions: no input, link, device, FIFO or folder.\n"
         "Inputs must be regular files.\n"
         "Exit code: 0 when the CSV was written, 1 with a message on stderr otherwise.\n";
}

ReplayOptions parseReplayOptions(const std::vector<std::string>& arguments) {
  ReplayOptions options;
  std::string dump_step;
  const std::map<std::string, std::string*> keys = {{"--scene", &options.scene_file},   {"--bag", &options.bag_file},
                                                    {"--csv", &options.csv_file},       {"--urdf", &options.urdf_file},
                                                    {"--timing", &options.timing_file}, {"--dump-step", &dump_step},
                                                    {"--dump-file", &options.dump_file}};
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--help" || arguments[i] == "-h") {
      options.help = true;
      return options;
    }
    const std::size_t equals = arguments[i].find('=');
    const std::string key = arguments[i].substr(0, equals);
    const auto known = keys.find(key);
    if (known == keys.end()) throw std::invalid_argument("unknown argument '" + arguments[i] + "'; see --help");
    if (!known->second->empty()) throw std::invalid_argument("argument " + key + " is given twice");
    const bool in_next = equals == std::string::npos;
    // "--csv --urdf x": a forgotten value, no file of that name.
    if (in_next && i + 1 < arguments.size() && arguments[i + 1].rfind("--", 0) != 0) *known->second = arguments[++i];
    if (!in_next) *known->second = arguments[i].substr(equals + 1);
    requireGiven(*known->second, key);
  }
  requireGiven(options.scene_file, "--scene");
  requireGiven(options.bag_file, "--bag");
  requireGiven(options.csv_file, "--csv");
  if (!dump_step.empty() || !options.dump_file.empty()) {
    requireGiven(dump_step, "--dump-step");
    requireGiven(options.dump_file, "--dump-file");
    options.dump_step = stepNumber(dump_step);
  }
  return options;
}

}  // namespace tissue_contact
