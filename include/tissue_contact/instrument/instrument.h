/// @file
/// Room `instrument`: one instrument of a scene: kinematic model, base pose, joint-name map, touching links.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/collision_shape.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "tissue_contact/instrument/robot_model.h"

namespace tissue_contact {

/// A link that touches tissue, with all its shapes.
struct ContactLink {
  std::string name;
  int link = -1;  ///< index into RobotModel::links()
  std::vector<CollisionShape> shapes;
};

/// See JointCompliance.
struct CompliantJoint {
  int joint = -1;             ///< index into RobotModel::joints()
  double stiffness = 0.0;     ///< N m/rad or N/m
  double effort_limit = 0.0;  ///< N m or N; may be infinite
  bool slides = false;        ///< N/m and N, m
};

/// Const after construction.
class Instrument {
 public:
  /// @param X_WB pose of the URDF root link in the world (tf already looked up).
  /// @throws std::invalid_argument naming the instrument and the link or joint: unknown tip or contact link, contact
  /// link
  ///   without any shape, joint map to an unknown or mimic joint, initial position of an unknown joint, compliance of
  ///   an unknown or of the other kind of joint, or of one twice, a moving URDF without joint-state topics or a rigid one with them.
  Instrument(const InstrumentDescription& description, RobotModel model, const Pose& X_WB);

  const std::string& name() const { return name_; }
  const RobotModel& model() const { return model_; }
  bool isObstacle() const { return model_.joints().empty(); }  ///< its URDF has no moving joint
  int tipLink() const { return tip_link_; }
  const std::vector<ContactLink>& contactLinks() const { return contact_links_; }
  const VectorX& initialPositions() const { return initial_positions_; }

  const std::vector<CompliantJoint>& compliantJoints() const { return compliant_joints_; }

  /// Independent joint meant by a recorded name (through the map, or the URDF's own name); -1 when it means none.
  int jointOfRecordedName(const std::string& recorded) const;
  /// Of names from outside those of joints that joint_names gives another name, and which: for messages. Empty: none is.
  std::string mappedText(const std::vector<std::string>& names) const;

  /// Poses of all links in the world frame; `X_WL` is resized to model().links().size().
  void linkPoses(const VectorX& positions, std::vector<Pose>& X_WL) const;

 private:
  std::string name_;
  RobotModel model_;
  Pose X_WB_;
  int tip_link_ = -1;
  std::vector<ContactLink> contact_links_;
  VectorX initial_positions_;
  std::vector<CompliantJoint> compliant_joints_;
  std::map<std::string, int> joint_of_recorded_name_;
};

}  // namespace tissue_contact
