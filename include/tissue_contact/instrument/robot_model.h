/// @file
/// Room `instrument`: the kinematic tree of a URDF. URDF text in; poses of all links from joint positions out.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/instrument_description.h"

namespace tissue_contact {

/// A joint that moves by itself. Positions: rad (revolute, continuous) or m (prismatic).
struct IndependentJoint {
  std::string name;
  /// URDF limits (infinite for continuous joints), for reference only: positions outside are simulated as recorded.
  double lower = 0.0;
  double upper = 0.0;
  /// Continuous, and so are those that follow it, at whole multiples: whole turns more or less are the same pose, and drivers leave them out.
  bool turns_on = false;
  /// Revolute, with limits a turn or more apart or none that say anything (0 and 0), and so are those that follow it, at whole multiples: a driver that
  /// gives its angle between -pi and pi leaves out whole turns of this one, too.
  bool wraps = false;

  /// Of the positions that are the same pose as `position`, that nearest to `to`; of joints that do not turn on `position`.
  double nearest(double position, double to) const;

  /// Of a joint that wraps: what a driver has left out between two positions, rad: whole turns where it would turn by more than half of one, faster than
  /// kFastest_rad_per_s. Else 0.
  double turnsLeftOut(double before, double now, double interval_s) const;

  /// Four turns a second, more than twice what the wrists of surgical arms reach: half a turn within an eighth of one.
  static constexpr double kFastest_rad_per_s = 25.0;
};

/// Geometry of one link as the URDF gives it, meshes not yet read. Mesh paths are resolved; one that cannot be (unknown
/// package) is kept as written, since it matters only if the link touches tissue: makeCollisionShape() refuses it.
struct LinkGeometry {
  std::vector<ShapeDescription> collision;
  std::vector<ShapeDescription> visual;
};

/// Kinematic tree, const after construction; built by parseUrdf().
class RobotModel {
 public:
  struct Link {
    std::string name;
    int parent = -1;               ///< index of the parent link, always smaller than this link's; -1 for the root
    Pose X_PJ = Pose::Identity();  ///< joint frame in the parent link at joint position 0
    enum class Motion { kFixed, kRevolute, kPrismatic } motion = Motion::kFixed;
    Vector3 axis = Vector3::UnitX();  ///< unit, in the joint frame
    int joint = -1;                   ///< independent joint that drives this one (through mimic chains), -1 if fixed
    std::string mimic;                ///< name of its own joint, where that mimics the one that drives it
    double multiplier = 1.0;          ///< joint position = multiplier * position[joint] + offset, chains composed
    double offset = 0.0;
    LinkGeometry geometry;
  };

  /// @throws std::invalid_argument naming the link: parents not before children, joint indices out of range, an axis
  /// that
  ///   is not unit, numbers that are not finite, equal names.
  RobotModel(std::string name, std::vector<Link> links, std::vector<IndependentJoint> joints);

  const std::string& name() const { return name_; }
  const std::vector<Link>& links() const { return links_; }  ///< parents before children, root first
  const std::vector<IndependentJoint>& joints() const { return joints_; }
  /// Index of a link or independent joint by name, -1 when there is none.
  int findLink(const std::string& name) const;
  int findJoint(const std::string& name) const;
  /// What to tell somebody who gives positions of these joints: which are mimics, and of what; empty where none is.
  std::string mimicsText(const std::vector<std::string>& names) const;

  /// Pose of every link in the root link's frame B. `positions`: one per independent joint (rad or m).
  /// `X_BL` is resized to links().size(). No allocation once sized. Formula: X_BL = X_BP * X_PJ * motion(position).
  /// Thread-safe.
  /// @throws std::invalid_argument when the number of positions is wrong; positions must be finite.
  void forwardKinematics(const VectorX& positions, std::vector<Pose>& X_BL) const;

 private:
  std::string name_;
  std::vector<Link> links_;
  std::vector<IndependentJoint> joints_;
};

}  // namespace tissue_contact
