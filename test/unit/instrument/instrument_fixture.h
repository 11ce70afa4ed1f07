/// @file
/// What the tests of the room `instrument` share: short URDFs and poses.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/refusal.h"
#include "support/temporary_directory.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/parse_urdf.h"

namespace tissue_contact {

inline std::string robot(const std::string& content) { return "<robot name=\"r\">" + content + "</robot>"; }

/// A joint from `parent` to `child`; `extra` holds <origin>, <axis>, <mimic>. Limits are added: urdfdom asks for them.
inline std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                         const std::string& child, const std::string& extra = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/><limit lower=\"-1\" upper=\"2\" effort=\"1\" velocity=\"1\"/>" + extra + "</joint>";
}

inline RobotModel parse(const std::string& content) { return parseUrdf(robot(content), "test.urdf", "", nullptr); }

inline void expectSamePose(const Pose& actual, const Pose& expected, double tolerance) {
  EXPECT_LE((actual.matrix() - expected.matrix()).cwiseAbs().maxCoeff(), tolerance)
      << actual.matrix() << "\nshould be\n"
      << expected.matrix();
}

inline Pose rotation(double angle, const Vector3& axis) {
  return Pose(Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix());
}

inline Pose translation(double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); }

}  // namespace tissue_contact
