#include "ros/node/private_parameters.h"

#include <ros/console.h>
#include <ros/exceptions.h>
#include <ros/init.h>
#include <ros/param.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <stdexcept>

#include "tissue_contact/core/command_line.h"
#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

const std::string kBecomes = ":=";
constexpr std::size_t kMaxPrintedName = 256;  // printed of a name that anybody may have set

bool contains(const std::vector<std::string>& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

/// What an instrument reads that names neither a URDF nor another parameter.
constexpr const char* kRobotDescription = "robot_description";

/// diagnostic_period is diagnostic_updater's; roscpp, rosconsole and tf2_ros read none.
const std::vector<std::string> kOwnNames = {"diagnostic_period",
                                            "markers/color",
                                            "markers/displacement_full_scale_m",
                                            "markers/force_arrow_m_per_n",
                                            "markers/pressure_full_scale_pa",
                                            "markers/strain_full_scale",
                                            "publish_mesh",
                                            "scene",
                                            "set",
                                            "tf_timeout_s"};

std::string refusalText(const std::string& refused, const std::string& own, const std::vector<std::string>& names,
                        const std::vector<std::string>& arguments) {
  const std::string relative = refused.substr(own.size() + 1);
  const std::string nearest = nearestWord(relative, names);
  return "parameter '" + printable(refused, kMaxPrintedName) + "' is none that this node reads; " +
         (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") +
         (relative == kRobotDescription ? "No instrument of the scene takes its URDF from it. " : "") + "It reads " +
         joined(names) + ". " +
         (contains(arguments, relative)
              ? "It was given as _" + printable(relative, kMaxPrintedName) + ":=..."
              : "Correct it where it is set (a launch file?), or remove it: rosparam delete " +
                    printable(refused, kMaxPrintedName));
}

}  // namespace

ParameterNames nodeParameters(const Scene* scene) {
  ParameterNames names{kOwnNames, {}, false};
  if (scene == nullptr) {
    names.urdfs.emplace_back(kRobotDescription);
    return names;
  }
  for (const InstrumentDescription& instrument : scene->instruments) {
    const std::string& name = instrument.robot_description_parameter;
    if (!name.empty() && !contains(names.own, name) && !contains(names.urdfs, name)) names.urdfs.push_back(name);
  }
  return names;
}

bool asksForHelp(int argc, const char* const* argv) {
  std::vector<std::string> own;
  std::copy_if(argv + 1, argv + argc, std::back_inserter(own),
               [](const std::string& argument) { return argument.find(kBecomes) == std::string::npos; });
  try {
    return CommandLine(own, {}).help();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string(error.what()) +
                                ", _parameter:=value (the scene: _scene:=/path/scene.yaml), from:=to and __name:=name");
  }
}

void startRos(int& argc, char** argv, const std::string& node_name) {
  try {
    ros::init(argc, argv, node_name, ros::init_options::NoSigintHandler);
  } catch (const ros::InvalidNameException& error) {
    throw std::invalid_argument(
        std::string(error.what()) +
        "; from:=to renames a topic, service or node; a parameter has an underscore before its name: "
        "_scene:=/path/scene.yaml");
  }
}

std::vector<std::string> privateArguments(int argc, const char* const* argv) {
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::size_t end = argument.find(kBecomes);
    if (end == std::string::npos || end < 2 || argument[0] != '_' || argument[1] == '_') continue;
    names.push_back(argument.substr(1, end - 1));
  }
  return names;
}

std::vector<std::string> unknownNames(const std::vector<std::string>& set, const std::string& own,
                                      const std::vector<std::string>& known) {
  std::vector<std::string> unknown;
  for (const std::string& name : set) {
    if (name.compare(0, own.size() + 1, own + "/") == 0 && !contains(known, name)) unknown.push_back(name);
  }
  std::sort(unknown.begin(), unknown.end());
  return unknown;
}

std::string misspelt(const std::string& name, const std::vector<std::string>& own) {
  constexpr std::size_t kMostLetters = 2;
  return nearestWord(name, own, kMostLetters);
}

void refuseUnknownParameters(const ros::NodeHandle& private_node, const ParameterNames& parameters,
                             const std::vector<std::string>& arguments) {
  std::vector<std::string> set;
  if (!ros::param::getParamNames(set)) return;  // the master went away: told by who needs it
  std::vector<std::string> names = parameters.own;
  names.insert(names.end(), parameters.urdfs.begin(), parameters.urdfs.end());
  std::vector<std::string> known;
  known.reserve(names.size());
  for (const std::string& name : names) known.push_back(private_node.resolveName(name));
  const std::string& own = private_node.getNamespace();
  const std::vector<std::string> unknown = unknownNames(set, own, known);
  if (unknown.empty()) return;
  std::vector<std::string> refused;
  std::vector<std::string> ignored;
  for (const std::string& name : unknown) {
    const std::string relative = name.substr(own.size() + 1);
    const bool is_argument = contains(arguments, relative);
    if (is_argument) ros::param::del(name);
    (is_argument || parameters.are_all || !misspelt(relative, parameters.own).empty() ? refused : ignored)
        .push_back(name);
  }
  if (!refused.empty()) throw std::invalid_argument(refusalText(refused.front(), own, names, arguments));
  ROS_WARN_STREAM("parameters that this node does not read: " << listOf(ignored) << "; it reads " << joined(names));
}

}  // namespace tissue_contact
