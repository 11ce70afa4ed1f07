#include "python/binding/loaded_scene.h"

#include <pybind11/stl.h>

#include <chrono>
#include <map>
#include <stdexcept>
#include <utility>

#include "python/binding/arrays.h"
#include "tissue_contact/core/cache_folder.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/instrument/parse_urdf.h"
#include "tissue_contact/scene/load_scene.h"

namespace tissue_contact::python {
namespace {

namespace py = pybind11;

/// What is written in Python (python/tissue_contact/_helpers.py). Takes the GIL: the core calls from wherever it is.
template <typename Result, typename... Arguments>
Result helper(const char* name, const Arguments&... arguments) {
  const py::gil_scoped_acquire gil;
  return py::module::import("tissue_contact._helpers").attr(name)(arguments...).template cast<Result>();
}

std::string packageDirectory(const std::string& package) { return helper<std::string>("package_directory", package); }

void say(const std::string& line) {
  const py::gil_scoped_acquire gil;  // until what it returns is dropped
  helper<py::object>("say", line);
}

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::map<std::string, Pose> posesOf(const py::object& frames) {
  std::map<std::string, Pose> poses;
  if (frames.is_none()) return poses;
  if (!py::isinstance<py::dict>(frames))
    throw py::type_error("frames must be a dict {tf frame: 4 x 4 pose in the world}");
  for (const auto& [name, pose] : py::reinterpret_borrow<py::dict>(frames)) {
    if (!py::isinstance<py::str>(name)) throw py::type_error("frames: the name of a frame must be text");
    const std::string text = py::str(name);
    poses[text] = toPose(pose, "frames: the pose of '" + text + "'");
  }
  return poses;
}

}  // namespace

LoadedScene loadScene(const std::string& file, const py::object& set, std::optional<std::string> yaml) {
  LoadedScene loaded{{}, file, std::move(yaml), helper<std::vector<std::string>>("settings", set)};
  loaded.scene = loaded.yaml ? parseScene(*loaded.yaml, file, packageDirectory, loaded.settings)
                             : tissue_contact::loadScene(file, packageDirectory, loaded.settings);
  return loaded;
}

SceneEnvironment environmentOf(const Scene& scene, const std::string& urdf_file, const py::object& frames) {
  if (!urdf_file.empty() && !takesUrdfFromParameter(scene)) {
    throw std::invalid_argument(
        "urdf='" + urdf_file + "' would change nothing: no instrument of scene '" + scene.file +
        "' takes its URDF from a parameter; leave it out, or have the scene say robot_description in place of urdf");
  }
  SceneEnvironment environment;
  environment.package_path = packageDirectory;
  environment.clock = steadySeconds;
  environment.meshes = {userCacheDirectory(), say, steadySeconds};
  environment.urdf_text = [urdf_file](const std::string& parameter) {
    if (urdf_file.empty()) {
      throw std::invalid_argument("the scene takes a URDF from parameter '" + parameter +
                                  "', and there are no parameters here; give its file: Simulator(scene, urdf=FILE)");
    }
    return readFile(urdf_file, "URDF file", kMaxUrdfBytes);
  };
  environment.frame_pose = [poses = posesOf(frames)](const std::string& frame) {
    const auto found = poses.find(frame);
    if (found != poses.end()) return found->second;
    throw std::invalid_argument("tf frame '" + frame +
                                "' is not known here; give its pose in the world: Simulator(scene, frames={'" + frame +
                                "': 4 x 4 matrix})");
  };
  return environment;
}

}  // namespace tissue_contact::python
