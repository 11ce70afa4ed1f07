/// @file
/// Room `scene`: YAML file in, checked Scene out. No ROS.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tissue_contact/scene/scene.h"

namespace tissue_contact {

/// Directory of a ROS package, or "" when it is not known. The ROS room has packagePath().
using PackagePath = std::function<std::string(const std::string& package)>;

/// Turns `uri` into an absolute path: `package://name/rest` through `package_path`, `file:///rest`, an absolute path,
/// or a path relative to `base_directory`. Does not test that the file exists.
/// @throws std::invalid_argument naming the uri when the package is unknown or the scheme is not one of these.
std::string resolvePath(const std::string& uri, const std::string& base_directory, const PackagePath& package_path);

/// Reads, checks and completes a scene. `file` may be a path or a `package://` or `file://` URI. Paths in it may be `package://`, `file://`, absolute or relative to the file.
/// @throws std::invalid_argument "<file>:<line>: <key path>: <what is wrong, the allowed range and the fix>" for
/// unknown
///   keys, wrong types, values out of range, duplicate or unknown names and missing files.
Scene loadScene(const std::string& file, const PackagePath& package_path);

/// As loadScene, from text; `file` is used in messages and as the base of relative paths.
Scene parseScene(const std::string& yaml, const std::string& file, const PackagePath& package_path);

/// The keys one kind of map in a scene file may have.
struct SceneMapKeys {
  std::string path;  ///< where such a map stands, "[]" for any element of a list: "tissues[].material"
  std::vector<std::string> keys;
};

/// Every key the loader knows, so that the documentation can be checked against it. Maps of joint names have free keys
/// and are not listed; tissues[].pose also stands for instruments[].base_pose, tissues[].block.grading.x for y and z,
/// tissues[].fixed[] for tissues[].regions[].where[].
std::vector<SceneMapKeys> sceneKeys();

}  // namespace tissue_contact
