/// @file
/// Room `instrument`: URDF text or file in, RobotModel out (urdfdom).
#pragma once

#include <cstdint>
#include <string>

#include "tissue_contact/core/resolve_path.h"
#include "tissue_contact/instrument/robot_model.h"

namespace tissue_contact {

/// Larger files are refused. PSM-sized URDFs have 20 kB, whole operating theatres below 1 MB.
constexpr std::uintmax_t kMaxUrdfBytes = 16u << 20;

/// @param xml URDF text.
/// @param source what to call it in messages (file path or parameter name).
/// @param base_directory base of relative mesh paths (directory of the URDF file; "" if it came from a parameter).
/// @throws std::invalid_argument naming `source` and the joint or link at fault: malformed XML, unsupported joint types
///   (planar, floating), a mimic of an unknown joint, a mimic cycle, zero axis, non-finite numbers.
RobotModel parseUrdf(const std::string& xml, const std::string& source, const std::string& base_directory,
                     const PackagePath& package_path);

/// Reads the file and parses it.
/// @throws as parseUrdf, and when the file cannot be read.
RobotModel loadUrdf(const std::string& file, const PackagePath& package_path);

}  // namespace tissue_contact
