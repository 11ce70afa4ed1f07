/// @file
/// Room `core`: the Eigen aliases and index types every other room is written in. SI units throughout.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

namespace tissue_contact {

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using VectorX = Eigen::VectorXd;
using Matrix2 = Eigen::Matrix2d;
using Matrix3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

/// One value per node: 3 x n, column i belongs to node i (positions in m, velocities in m/s, forces in N).
using NodalVectors = Eigen::Matrix3Xd;

/// A rigid pose. `X_AB` maps coordinates of frame B into frame A: p_A = X_AB * p_B.
using Pose = Eigen::Isometry3d;

/// Node indices of a triangle, counter-clockwise seen from outside the tissue.
using Triangle = std::array<int, 3>;

/// Node indices (a, b, c, d) of a tetrahedron with positive volume: (b-a) x (c-a) . (d-a) > 0.
using Tetrahedron = std::array<int, 4>;

/// Force (N) and torque (N m) about a stated point, in a stated frame.
struct Wrench {
  Vector3 force = Vector3::Zero();
  Vector3 torque = Vector3::Zero();
};

}  // namespace tissue_contact
