/// @file
/// Room `validation`: scenes written as text inside a case or a test, with their URDFs beside them.
#pragma once

#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/simulator.h"
#include "validation/package_directory.h"

namespace tissue_contact {

/// Knows this package; `robot_description: <name>` in a scene means entry <name> of `urdfs`.
inline SceneEnvironment ownEnvironment(const std::map<std::string, std::string>& urdfs = {},
                                       const std::function<double()>& clock = nullptr) {
  SceneEnvironment environment;
  environment.package_path = [](const std::string& package) {
    return package == "tissue_contact" ? packageDirectory() : std::string();
  };
  environment.urdf_text = [urdfs](const std::string& name) {
    const auto urdf = urdfs.find(name);
    if (urdf == urdfs.end()) throw std::invalid_argument("there is no URDF '" + name + "'");
    return urdf->second;
  };
  environment.clock = clock;
  return environment;
}

/// Builds a simulator from scene text. @param urdfs, clock see ownEnvironment().
inline Simulator makeSimulator(const std::string& yaml, const std::map<std::string, std::string>& urdfs = {},
                               const std::function<double()>& clock = nullptr) {
  const SceneEnvironment environment = ownEnvironment(urdfs, clock);
  return Simulator(parseScene(yaml, "text scene", environment.package_path), environment);
}

/// The section `tissues` of a small scene: a block of 5 kPa whose base, at z = 0, is held. @param size_m, cells lists.
/// @param material more of it
inline std::string blockScene(const std::string& size_m = "[0.06, 0.06, 0.02]", const std::string& cells = "[4, 4, 2]",
                              const std::string& material = "poissons_ratio: 0.4") {
  return "tissues:\n  - name: block\n    block: {size_m: " + size_m + ", cells: " + cells +
         "}\n    material: {youngs_modulus_pa: 5000, density_kg_per_m3: 1000, " + material +
         "}\n    damping: {stiffness_s: 0.003}\n    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n";
}

/// A scene's only instrument: a ball on probeUrdf() by the name `probe`, with its centre at `position_m` (a list) while all
/// joints are 0.
inline std::string onlyBall(const std::string& position_m) {
  return "instruments:\n  - {name: probe, robot_description: probe, tip_link: tip, contact_links: [tip], "
         "joint_state_topics: [/js],\n"
         "     base_pose: {position_m: " +
         position_m + "}}\n";
}

/// An entry of `instruments`: urdf/probe.urdf, whose ball of 5 mm has its centre at `position_m` (a list) while all joints
/// are 0. @param more lines of that entry.
inline std::string probeEntry(const std::string& name, const std::string& topics, const std::string& position_m,
                              const std::string& more = "") {
  return "  - name: " + name +
         "\n    urdf: package://tissue_contact/urdf/probe.urdf\n    base_pose: {position_m: " + position_m +
         "}\n    joint_state_topics: [" + topics + "]\n    tip_link: tip\n    contact_links: [tip]\n" + more;
}

/// A sphere on three prismatic joints x, y, z along the axes of its base; link `tip` at the sphere's centre.
inline std::string probeUrdf(double radius_m) {
  std::string urdf = "<robot name='probe'><link name='base'/>";
  const std::string axes[3] = {"1 0 0", "0 1 0", "0 0 1"};
  const std::string names[3] = {"x", "y", "z"};
  const std::string links[4] = {"base", "x_link", "y_link", "tip"};
  for (int i = 0; i < 3; ++i) {
    if (i < 2) urdf += "<link name='" + links[i + 1] + "'/>";
    urdf += "<joint name='" + names[i] + "' type='prismatic'><parent link='" + links[i] + "'/><child link='" +
            links[i + 1] + "'/><axis xyz='" + axes[i] +
            "'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
  }
  return urdf + "<link name='tip'><collision><geometry><sphere radius='" + std::to_string(radius_m) +
         "'/></geometry></collision></link></robot>";
}

/// A box that does not move: table or incline. The box's upper face is at z = 0 of the link.
inline std::string tableUrdf() {
  return "<robot name='table'><link name='table'><collision><origin xyz='0 0 -0.05'/><geometry>"
         "<box size='2 2 0.1'/></geometry></collision></link></robot>";
}

/// The same on a prismatic joint along x; link 1.
inline std::string movingTableUrdf() {
  return "<robot name='tray'><link name='base'/><joint name='x' type='prismatic'><parent link='base'/>"
         "<child link='table'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
         "<link name='table'><collision><origin xyz='0 0 -0.05'/><geometry><box size='2 2 0.1'/></geometry>"
         "</collision></link></robot>";
}

}  // namespace tissue_contact
