#include "ros/place/place.h"

#include <algorithm>
#include <exception>
#include <iostream>
#include <map>
#include <stdexcept>

#include "ros/absolute_path.h"
#include "tissue_contact/core/command_line.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/core/whole_file.h"

namespace tissue_contact {
namespace {

constexpr Range kPlace{-1e6, 1e6, "m"};

/// Keys of each task beside --scene and --urdf: needed, then allowed.
struct Task {
  std::vector<std::string> needed;
  std::vector<std::string> allowed;
  void (*run)(const PlaceOptions&);
};

const std::map<std::string, Task>& tasks() {
  static const std::map<std::string, Task> tasks = {
      {"base", {{"--bag", "--measured"}, {"--instrument"}, placeBase}},
      {"surface", {{"--x", "--y"}, {"--bag"}, placeSurface}},
      {"approach", {{"--bag"}, {}, placeApproach}},
      {"picture", {{"--out"}, {"--bag"}, placePicture}},
  };
  return tasks;
}

const Task& taskNamed(const std::vector<std::string>& words) {
  const std::string given = words.empty() ? "" : words.front();
  const auto found = tasks().find(given);
  if (found != tasks().end() && words.size() == 1) return found->second;
  throw std::invalid_argument(
      (words.size() > 1 ? "one task at a time, not " + inQuotes(words[1]) + " too" : "the task is " + inQuotes(given)) +
      "; it must be base, surface, approach or picture; see --help");
}

void requireKeys(const CommandLine& line, const std::string& name, const Task& task) {
  for (const std::string& key : task.needed) line.required(key);
  for (const char* key : {"--bag", "--measured", "--instrument", "--x", "--y", "--out"}) {
    const auto has = [key](const std::vector<std::string>& keys) {
      return std::find(keys.begin(), keys.end(), key) != keys.end();
    };
    if (!line.has(key) || has(task.needed) || has(task.allowed)) continue;
    throw std::invalid_argument(std::string(key) + " says nothing to " + name + "; see --help");
  }
}

}  // namespace

std::string placeUsage() {
  return "usage: tissue_contact_place base     --scene S.yaml --bag B.bag --measured TOPIC [--instrument NAME]\n"
         "       tissue_contact_place surface  --scene S.yaml --x X --y Y [--bag B.bag]\n"
         "       tissue_contact_place approach --scene S.yaml --bag B.bag\n"
         "       tissue_contact_place picture  --scene S.yaml [--bag B.bag] --out PICTURE.png\n"
         "\n"
         "Where things are in a scene, before it runs and without a roscore. All in metres, in the scene's world "
         "frame.\n"
         "\n"
         "  base      base_pose of an instrument, to paste into the scene: by registration of its tip, moved by the "
         "bag's\n"
         "            joint states, to the tip poses that TOPIC has (PoseStamped or TransformStamped, e.g.\n"
         "            /PSM2/measured_cp); with what is left of the distance between them\n"
         "  surface   where the vertical line through X, Y meets the tissues at rest: point, normal, material\n"
         "  approach  how near the bag brings the instruments to the tissues at rest: when, where, which shape, and "
         "the\n"
         "            shift that would make it touch\n"
         "  picture   the scene from three sides, with the way of the instruments' tips if there is a bag\n"
         "\n"
         "  --urdf FILE  text for the robot_description parameter that the scene takes its URDF from; or "
         "package://...\n"
         "  --bag FILE   also where tf frames that the scene names are taken from\n"
         "  --help       this text\n"
         "\n"
         "Exit code: 0, or 1 with a message on stderr.\n";
}

PlaceOptions parsePlaceOptions(const std::vector<std::string>& arguments) {
  const CommandLine line(
      arguments, {{"--scene", "--bag", "--urdf", "--measured", "--instrument", "--x", "--y", "--out"}, {}, {}, true});
  PlaceOptions options;
  options.help = line.help();
  if (options.help) return options;
  const Task& task = taskNamed(line.words());
  options.task = line.words().front();
  options.scene_file = line.required("--scene");
  requireKeys(line, options.task, task);
  options.bag_file = line.value("--bag");
  options.urdf_file = withoutUri(line.value("--urdf"));
  options.measured = line.value("--measured");
  options.instrument = line.value("--instrument");
  options.x_m = line.number("--x", 0.0, kPlace);
  options.y_m = line.number("--y", 0.0, kPlace);
  options.out_file = line.value("--out");
  return options;
}

int runPlace(int argc, char** argv) {
  try {
    const PlaceOptions options = parsePlaceOptions({argv + 1, argv + argc});
    if (options.help) {
      std::cout << placeUsage();
    } else {
      tasks().at(options.task).run(options);
    }
    requireWritten(std::cout);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "tissue_contact_place: " << error.what() << "\n";
    return 1;
  }
}

}  // namespace tissue_contact
