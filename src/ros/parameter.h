/// @file
/// Room `ros`, private: numbers and words from the parameter server.
#pragma once

#include <ros/node_handle.h>

#include <optional>
#include <string>
#include <vector>

#include "tissue_contact/core/range.h"

namespace tissue_contact {

/// A parameter that is a number; `otherwise` where it is not set.
/// @throws std::invalid_argument naming it, what was given, the range and the default, which test/ros/reference.py reads there.
double numberParameter(const ros::NodeHandle& node, const std::string& name, double otherwise, const Range& range);

/// A parameter that is a number; none where it is not set: "auto". @throws likewise.
std::optional<double> numberParameter(const ros::NodeHandle& node, const std::string& name, const Range& range);

/// A parameter as text, also where it is set to something else; `otherwise` where it is not set.
std::string textParameter(const ros::NodeHandle& node, const std::string& name, const std::string& otherwise);

/// A parameter that is a list of texts: set as one (rosparam), as the text of a YAML list (rosrun ... _set:="[a=1, b=2]"), or as one
/// text; empty where it is not set.
/// @throws std::invalid_argument naming it and what it must be.
std::vector<std::string> textsParameter(const ros::NodeHandle& node, const std::string& name);

}  // namespace tissue_contact
