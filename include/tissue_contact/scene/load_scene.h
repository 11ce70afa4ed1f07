/// @file
/// Room `scene`: YAML file in, checked Scene out. No ROS.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tissue_contact/core/resolve_path.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

/// Reads, checks and completes a scene.
/// @param file a path or a `package://` or `file://` URI. Paths in it may be those, or relative to the file.
///   Of `publish`, which is for whoever publishes, only the keys are checked.
/// @param settings "KEY=VALUE", each as if the file said so: "tissues.block.material.youngs_modulus_pa=4000". KEY is a path of keys joined
///   by '.'; an element of a list is told by its name, or by its index ("friction.0.static" or "friction[0].static"); a key that holds a
///   '.' stands in double quotes. VALUE is YAML. At most 1000, of at most 4096 bytes each. In messages "--set KEY=VALUE" takes the place
///   of "<file>:<line>".
/// @throws std::invalid_argument "<file>:<line>: <key path>: <what is wrong, the allowed range and the fix>" for unknown
///   keys, wrong types, values out of range, duplicate or unknown names and missing files.
Scene loadScene(const std::string& file, const PackagePath& package_path,
                const std::vector<std::string>& settings = {});

/// As loadScene, from text; `file` is used in messages and as the base of relative paths.
Scene parseScene(const std::string& yaml, const std::string& file, const PackagePath& package_path,
                 const std::vector<std::string>& settings = {});

/// Every key the loader knows, by where its map stands, "[]" for any element of a list: "tissues[].material". Maps of joint
/// names have free keys and are not among them; tissues[].pose also stands for instruments[].base_pose,
/// tissues[].block.grading.x for y and z, tissues[].fixed[] for tissues[].regions[].where[],
/// tissues[].attachments[].where[] and tissues[].pressure_where[].
const std::map<std::string, std::vector<std::string>>& sceneKeys();

}  // namespace tissue_contact
