/// @file
/// Room `scene`, private: scene files with sections that are none of the core's.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tissue_contact/core/resolve_path.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

class YamlMap;

/// Reads such a section ("publish"): the map of the whole file in.
using ReadMore = std::function<void(const YamlMap& file)>;

/// As loadScene() of load_scene.h.
/// @param read_more called last; what it finds wrong is refused like all else.
Scene loadScene(const std::string& file, const PackagePath& package_path, const std::vector<std::string>& settings,
                const ReadMore& read_more);

}  // namespace tissue_contact
