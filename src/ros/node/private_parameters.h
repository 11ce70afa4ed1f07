/// @file
/// Room `ros`, private: the arguments and private parameters a node was started with, against those it knows. What nobody reads
/// would otherwise be accepted silently.
#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

/// Relative to a node's private namespace.
struct ParameterNames {
  std::vector<std::string> own;
  std::vector<std::string> urdfs;  ///< of the scene's instruments
  bool are_all = false;            ///< nothing else may be below the namespace
};

/// Those of the node that simulates. @param scene names the parameters that hold URDFs; null: not known.
ParameterNames nodeParameters(const Scene* scene);

/// Whether --help or -h is among the arguments. Needs no master.
/// @throws std::invalid_argument naming one that is none of the two and no name:=value.
bool asksForHelp(int argc, const char* const* argv);

/// ros::init() without its handler of SIGINT.
/// @throws std::invalid_argument where an argument renames what is no name in ROS: mostly a parameter that lacks its underscore.
void startRos(int& argc, char** argv, const std::string& node_name);

/// "scene" for every argument _scene:=value.
std::vector<std::string> privateArguments(int argc, const char* const* argv);

/// Those of `set` (names from / on) that lie below `own`, a namespace without its last slash, and not in `known`.
std::vector<std::string> unknownNames(const std::vector<std::string>& set, const std::string& own,
                                      const std::vector<std::string>& known);

/// The parameter among the `own` of a node that `name`, relative to its namespace, must be a misspelling of: two letters away at most,
/// or without its unit. Empty otherwise: it may be another node's below this namespace, or a URDF that this scene does not use
/// (one that it does use is missed, and asked for by its name).
std::string misspelt(const std::string& name, const std::vector<std::string>& own);

/// Looks through the parameter server for private parameters that neither the node nor a library it uses reads. Those
/// that came by the command line of this process, or are misspelt, or any that `are_all`, are refused; one warning names the others. What came by
/// the command line is removed from the server again, so that the next start does not meet it.
/// @param parameters all that the node reads.
/// @param arguments see privateArguments().
/// @throws std::invalid_argument naming the first refused, the nearest known name, and where to correct it.
void refuseUnknownParameters(const ros::NodeHandle& private_node, const ParameterNames& parameters,
                             const std::vector<std::string>& arguments);

}  // namespace tissue_contact
