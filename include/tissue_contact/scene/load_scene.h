/// @file
/// Room `scene`: YAML file in, checked Scene out. No ROS.
#pragma once

#include <functional>
#include <string>

#include "tissue_contact/scene/scene.h"

namespace tissue_contact {

/// Directory of a ROS package, or "" when it is not known. The ROS room passes ros::package::getPath.
using PackagePath = std::function<std::string(const std::string& package)>;

/// Turns `uri` into an absolute path: `package://name/rest` through `package_path`, `file:///rest`, an absolute path, or
/// a path relative to `base_directory`. Does not test that the file exists.
/// @throws std::invalid_argument naming the uri when the package is unknown or the scheme is not one of these.
std::string resolvePath(const std::string& uri, const std::string& base_directory, const PackagePath& package_path);

/// Reads, checks and completes a scene. Paths in it may be `package://`, `file://`, absolute or relative to the file.
/// @throws std::invalid_argument "<file>:<line>: <key path>: <what is wrong, the allowed range and the fix>" for unknown
///   keys, wrong types, values out of range, duplicate or unknown names and missing files.
Scene loadScene(const std::string& file, const PackagePath& package_path);

/// As loadScene, from text; `file` is used in messages and as the base of relative paths.
Scene parseScene(const std::string& yaml, const std::string& file, const PackagePath& package_path);

}  // namespace tissue_contact
