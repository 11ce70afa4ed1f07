/// @file
/// Room `ros`, private: numbers from the parameter server.
#pragma once

#include <ros/node_handle.h>

#include <string>

#include "tissue_contact/core/range.h"

namespace tissue_contact {

/// A parameter that is a number; `otherwise` where it is not set.
/// @throws std::invalid_argument naming it, what was given, and the range.
double numberParameter(const ros::NodeHandle& node, const std::string& name, double otherwise, const Range& range);

}  // namespace tissue_contact
