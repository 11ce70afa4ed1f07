/// @file
/// A scene that sets every key once, with the files it names, and helpers to spoil one line of it.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "support/refusal.h"
#include "support/replaced.h"
#include "support/temporary_directory.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

/// One place of a good scene, spoilt.
struct BadScene {
  const char* from;     ///< what of the good scene is replaced
  const char* to;       ///< by what
  const char* where;    ///< start of the message: line and key path
  const char* problem;  ///< text the message must hold
};

/// A directory of its own for each test, removed afterwards.
class SceneTest : public testing::Test {
 protected:
  SceneTest() {
    for (const char* name : {"arm.urdf", "organ.vtk", "jaw.STL", "skin.obj"}) write(name, "x");
  }

  std::string path(const std::string& name) const { return directory_.path(name); }
  void write(const std::string& name, const std::string& text) const { directory_.write(name, text); }

  Scene parse(const std::string& yaml) const {
    return parseScene(yaml, path("scene.yaml"), [this](const std::string& package) {
      return package == "tissue_contact" ? directory_.path().string() : std::string();
    });
  }

  /// What parse() refuses `yaml` with, the directory taken out; fails the test when it is accepted.
  std::string refusal(const std::string& yaml) const {
    SCOPED_TRACE(yaml.substr(0, 300));
    std::string message = tissue_contact::refusal([&] { parse(yaml); });
    const std::string directory = path("");
    if (message.compare(0, directory.size(), directory) == 0) message.erase(0, directory.size());
    return message;
  }

  void expectRefusedAt(const std::string& yaml, const std::string& where, const std::string& problem) const {
    const std::string message = refusal(yaml);
    EXPECT_EQ(message.find("scene.yaml:" + where + ": "), 0U) << message;
    EXPECT_NE(message.find(problem), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }

  void expectRefused(const std::string& good, const BadScene& bad) const {
    expectRefusedAt(replaced(good, bad.from, bad.to), bad.where, bad.problem);
  }

  template <std::size_t count>
  void expectAllRefused(const std::string& good, const BadScene (&all)[count]) const {
    for (const BadScene& bad : all) {
      SCOPED_TRACE(bad.to);
      expectRefused(good, bad);
    }
  }

  /// How many of 2000 copies of `good` with a few bytes changed or lost (seeded) are refused; anything thrown but
  /// std::invalid_argument ends the test.
  int refusedWhenDamaged(const std::string& good) const {
    unsigned state = 12345;
    const auto random = [&state](std::size_t below) {
      state = state * 1664525U + 1013904223U;
      return static_cast<std::size_t>(state >> 8U) % below;
    };
    int refused = 0;
    for (int round = 0; round < 2000; ++round) {
      std::string damaged = good;
      for (std::size_t i = 0, changes = 1 + random(4); i < changes; ++i) {
        const std::size_t at = random(damaged.size());
        if (random(3) == 0) {
          damaged.erase(at, 1 + random(30));
        } else {
          damaged[at] = static_cast<char>(random(2) == 0 ? random(256) : "{}[]:-,&*!|>'\"%@\n\t #?"[random(22)]);
        }
      }
      try {
        parse(damaged);
      } catch (const std::invalid_argument&) {
        ++refused;
      }
    }
    return refused;
  }

  TemporaryDirectory directory_;
};

/// Line numbers matter to the tests: keep them in step.
inline const char* const kFullScene = R"(world_frame: lab
gravity_m_per_s2: [0.1, 0.2, -9.81]
tissues:
  - name: pad
    block:
      size_m: [0.1, 0.08, 0.04]
      cells: [10, 8, 4]
      grading:
        x: {growth: 1.25, fine_at: minimum}
        y: {growth: 1.5}
        z: {growth: 2, fine_at: maximum}
    pose:
      position_m: [1, 2, 3]
      rpy_rad: [0.1, 0.2, 0.3]
    material:
      model: linear
      youngs_modulus_pa: 5e3
      poissons_ratio: 0.45
      density_kg_per_m3: 1060
    damping:
      mass_per_s: 0.5
      stiffness_s: 0.002
    fixed:
      - box: {min_m: [-1, -2, -3], max_m: [1, 2, 3]}
      - plane: {point_m: [0, 0, 0.01], normal: [0, 0, 2]}
      - sphere: {center_m: [0.1, 0.2, 0.3], radius_m: 0.05}
  - name: organ
    mesh:
      file: organ.vtk
      scale_m_per_unit: 0.01
      remove_unreferenced_nodes: true
    pose: {tf_frame: operating_table, quaternion_xyzw: [0, 0, 1, 0]}
    material: {model: corotational, youngs_modulus_pa: 2000, poissons_ratio: 0.3, density_kg_per_m3: 1000}
instruments:
  - name: arm
    urdf: package://tissue_contact/arm.urdf
    base_pose:
      position_m: [0.2, 0, 0]
    joint_state_topics: [/PSM2/measured_js, /PSM2/jaw/measured_js]
    joint_names:
      outer_yaw: yaw
      outer_pitch: pitch
    initial_joint_positions:
      yaw: 0.25
    tip_link: tip
    contact_links:
      - shaft
      - link: jaw
        shapes:
          - sphere: {radius_m: 0.002}
          - box: {size_m: [0.01, 0.02, 0.03]}
            pose: {position_m: [0, 0, 0.005], rpy_rad: [0, 0, 1.5]}
          - cylinder: {radius_m: 0.004, length_m: 0.1}
          - mesh: {file: jaw.STL, scale: [0.001, 0.002, 0.003]}
          - mesh: {file: jaw.STL, scale: 0.001}
  - name: arm2
    robot_description: /arm2/robot_description
    tip_link: tip
    contact_links: [jaw]
friction:
  - {instrument: arm, tissue: pad, static: 0.6, kinetic: 0.4}
  - {instrument: arm, tissue: organ, static: 0.3, kinetic: 0.3}
step: {max_step_s: 0.002, max_gap_s: 0.5}
solver:
  iterations: 20
  contact_passes: 3
  tolerance: 1.0e-7
publish:
  mesh_rate_hz: 1
  contacts_rate_hz: 2
  status_rate_hz: 3
  markers_rate_hz: 0
  tf: true
)";

inline const char* const kSmallestScene = R"(tissues:
  - name: pad
    block: {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}
    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.45, density_kg_per_m3: 1000}
instruments:
  - name: arm
    tip_link: tip
    contact_links: [tip]
)";

}  // namespace tissue_contact
