/// @file
/// Room `instrument`: everything that an instrument is built from, in SI units.
#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "tissue_contact/core/placed_pose.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Collision geometry in its own frame S: sphere and box centred, cylinder centred with its axis along z (as in URDF).
struct SphereGeometry {
  double radius_m = 0.0;
};
struct BoxGeometry {
  Vector3 size_m = Vector3::Zero();  ///< full edge lengths
};
struct CylinderGeometry {
  double radius_m = 0.0;
  double length_m = 0.0;
};
struct MeshGeometry {
  std::string file;  ///< absolute path: STL, OBJ or DAE
  Vector3 scale = Vector3::Ones();
};
using ShapeGeometry = std::variant<SphereGeometry, BoxGeometry, CylinderGeometry, MeshGeometry>;

struct ShapeDescription {
  ShapeGeometry geometry;
  Pose X_LS = Pose::Identity();  ///< pose of the shape in its link's frame L
};

/// Of one instrument, and of all together: each shape is compared with every other of its instrument in each step, and
/// triangles take memory and time to prepare.
constexpr std::size_t kMostShapes = 1000;
constexpr std::size_t kMostShapeTriangles = 2'000'000;

/// A link that touches tissue. With no shapes named here its URDF <collision> is used, or else its <visual>.
struct ContactLinkDescription {
  std::string link;
  std::vector<ShapeDescription> shapes;
};

/// A topic of joint states of an instrument.
struct JointStateTopic {
  std::string name;
  /// Its stamps are moments of the simulation, each with a wrench. If not, it only updates joints (a jaw beside its arm).
  bool triggers = true;
};

/// A joint that gives way to what tissue does to it: where it is differs from its joint state by `effort / stiffness`, and by whatever it takes where
/// the effort would exceed the limit.
struct JointCompliance {
  std::string joint;                                              ///< of the URDF, independent
  bool slides = false;                                            ///< N/m and N in place of N m/rad and N m
  double stiffness = 0.0;                                         ///< N m/rad or N/m, > 0
  double effort_limit = std::numeric_limits<double>::infinity();  ///< N m or N, > 0
};

struct InstrumentDescription {
  std::string name;
  std::string urdf_file;                    ///< absolute path; empty: the URDF comes from `robot_description_parameter`
  std::string robot_description_parameter;  ///< ROS parameter holding the URDF text; empty if `urdf_file` is given
  PoseDescription base_pose;                ///< of the URDF root link
  std::vector<JointStateTopic> joint_state_topics;        ///< empty for a fixed obstacle; else at least one triggers
  std::map<std::string, std::string> joint_names;         ///< recorded joint name -> URDF joint name
  std::map<std::string, double> initial_joint_positions;  ///< URDF joint name -> rad or m; others start at 0
  std::vector<JointCompliance> compliant_joints;
  std::string tip_link;  ///< wrench origin and frame
  std::vector<ContactLinkDescription> contact_links;
};

}  // namespace tissue_contact
