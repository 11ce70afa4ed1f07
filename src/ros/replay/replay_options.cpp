#include <cstdint>
#include <stdexcept>
#include <string>

#include "ros/absolute_path.h"
#include "ros/replay/replay.h"
#include "tissue_contact/core/command_line.h"

namespace tissue_contact {
namespace {

constexpr Range kFrom{0.0, 1e9, "s"};
constexpr Range kDuration{0.0, 1e9, "s", "", true};

}  // namespace

std::string replayUsage() {
  return "usage: tissue_contact_replay --scene SCENE.yaml [--set KEY=VALUE ...] --bag IN.bag\n"
         "         [--csv OUT.csv] [--out OUT.bag [--plot DIR]] [--manifest MADE.yaml] [--from S] [--duration S] "
         "[--urdf ROBOT.urdf]\n"
         "         [--changes TOPIC] [--timing TIMES.csv] [--dump-step N --dump-file PROBLEM.txt]\n"
         "       tissue_contact_replay --batch LINES\n"
         "\n"
         "Plays the joint states of a bag through a scene, with the stepping of tissue_contact_node but without a\n"
         "roscore, and writes one CSV line per state of an arm, or what the node publishes: the same bytes every "
         "time.\n"
         "--csv or --out is needed.\n"
         "\n"
         "  --scene FILE  the scene (doc/scene.md)\n"
         "  --set KEY=VALUE  a key of the scene, as if the file said so: "
         "tissues.block.material.youngs_modulus_pa=4000,\n"
         "                friction.0.static=0.5; elements of lists by name or index; any number of times\n"
         "  --bag FILE    a ROS bag with the scene's joint-state topics; tf frames are taken from its /tf_static and "
         "/tf\n"
         "  --csv FILE    the result; replaced when the replay is complete, untouched when it fails or is interrupted\n"
         "  --out FILE    a bag of what a node called /tissue_contact publishes, in time with the bag that is played, "
         "so that\n"
         "                `rosbag play IN.bag OUT.bag` shows both; what is recorded when the replay fails or is "
         "interrupted is\n"
         "                left in FILE.partial\n"
         "  --plot DIR    pictures of that bag: force over time, friction over normal force\n"
         "  --from S      begin so many seconds into the recording, with undeformed tissue\n"
         "  --duration S  play so many seconds of it\n"
         "  --urdf FILE   text for the robot_description parameter that the scene takes its URDF from; or "
         "package://...\n"
         "  --changes TOPIC  numbers of the scene changed while the node ran, played back at the same moments: their "
         "topic, if "
         "the\n"
         "                bag has several; none: as the scene has them throughout\n"
         "  --timing FILE   wall times of this run, one line per simulated interval; replaced or untouched as the CSV\n"
         "  --manifest FILE  YAML: hashes of every input, of the program and of the results, versions, arguments, "
         "counts\n"
         "  --batch LINES   many replays, one after the other: a file with the arguments of one in each line, tabs "
         "between\n"
         "                them, or - for standard input; each is answered with a line, ok<tab>CPU seconds or\n"
         "                failed<tab>CPU seconds<tab>message, or broken in place of failed where it is no replay's "
         "fault\n"
         "  --dump-step N   with --dump-file: write the contact problem of implicit step N (from 1), for "
         "tissue_contact_solve\n"
         "  --dump-file FILE  where to; replaced when that step is taken\n"
         "  --help        this text\n"
         "\n"
         "Results replace regular files only, and keep their permissions: no input, link, device, FIFO or folder.\n"
         "Inputs must be regular files.\n"
         "Exit code: 0 when the results were written, of a batch: when each line was answered; 1 with a message on "
         "stderr\n"
         "otherwise.\n";
}

ReplayOptions parseReplayOptions(const std::vector<std::string>& arguments) {
  const CommandLine line(arguments, {{"--scene", "--bag", "--csv", "--out", "--plot", "--from", "--duration", "--urdf",
                                      "--changes", "--timing", "--manifest", "--batch", "--dump-step", "--dump-file"},
                                     {},
                                     {"--set"}});
  ReplayOptions options;
  options.help = line.help();
  options.arguments = arguments;
  options.batch_file = line.value("--batch");
  if (options.help) return options;
  if (line.has("--batch")) {
    if (arguments.size() != (arguments[0] == "--batch" ? 2 : 1))
      throw std::invalid_argument("--batch takes the arguments of its replays from its lines; give no others");
    return options;
  }
  options.scene_file = line.required("--scene");
  options.settings = line.all("--set");
  options.bag_file = line.required("--bag");
  options.csv_file = line.value("--csv");
  options.out_file = line.value("--out");
  if (options.csv_file.empty() && options.out_file.empty()) {
    throw std::invalid_argument("--csv or --out is missing; see --help");
  }
  options.plot_folder = line.value("--plot");
  if (line.has("--plot") && options.out_file.empty()) {
    throw std::invalid_argument("--plot needs --out: the pictures are of that bag");
  }
  options.from_s = line.number("--from", options.from_s, kFrom);
  options.duration_s = line.number("--duration", options.duration_s, kDuration);
  options.urdf_file = withoutUri(line.value("--urdf"));
  options.changes_topic = line.value("--changes");
  options.timing_file = line.value("--timing");
  options.manifest_file = line.value("--manifest");
  if (line.has("--dump-step") || line.has("--dump-file")) {
    constexpr std::int64_t kMost = 999'999'999'999'999;
    options.dump_file = line.required("--dump-file");
    line.required("--dump-step");
    options.dump_step = static_cast<long>(line.integer("--dump-step", 0, 1, kMost));
  }
  return options;
}

}  // namespace tissue_contact
