/// @file
/// Python: a scene and where it finds what its file only names, without ROS. Every function needs the GIL.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/scene_environment.h"

namespace tissue_contact::python {

/// A scene, and what made it: enough to make it again in another process.
struct LoadedScene {
  Scene scene;
  std::string file;
  std::optional<std::string> yaml;    ///< in place of the file's text
  std::vector<std::string> settings;  ///< "KEY=VALUE"
};

/// @param set None, a dict {key: value} or a list of "KEY=VALUE". @param yaml in place of the file's text.
/// @throws pybind11::type_error for another `set`, std::invalid_argument as loadScene().
LoadedScene loadScene(const std::string& file, const pybind11::object& set, std::optional<std::string> yaml = {});

/// Packages through rospkg, URDF parameters as the text of one file, poses of tf frames by name. Holds no Python object: the
/// simulator keeps some of it, and calls it without the GIL.
/// @param urdf_file empty: a scene that takes a URDF from a parameter is refused; else one that takes none from there is.
/// @param frames None, or a dict of 4 x 4 poses in the world frame.
SceneEnvironment environmentOf(const Scene& scene, const std::string& urdf_file, const pybind11::object& frames);

}  // namespace tissue_contact::python
