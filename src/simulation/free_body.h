/// @file
/// Room `simulation`, private: what a body that nothing holds keeps: its linear and angular momentum.
#pragma once

#include "tissue_contact/core/types.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

struct FreeMotion {
  double mass = 0.0;                  ///< kg
  Vector3 centre = Vector3::Zero();   ///< of mass, m
  Vector3 linear = Vector3::Zero();   ///< momentum, N s
  Vector3 angular = Vector3::Zero();  ///< momentum about the centre, N m s
  Matrix3 inertia = Matrix3::Zero();  ///< about the centre, kg m^2

  /// Of the rigid motion with the same momentum, rad/s. Of nodes on a line, about that line, round-off.
  Vector3 omega() const { return turnWith(angular); }
  Vector3 turnWith(const Vector3& angular_momentum) const;  ///< rad/s
};

/// @param mass kg.
/// @param x m,
/// @param v m/s, 3 x nodes.
FreeMotion freeMotionOf(const VectorX& mass, const NodalVectors& x, const NodalVectors& v);

/// Gives the nodes of a body that goes on with another mesh, of the same mass, the momenta it had, the angular one
/// about its own centre of mass.
void keepMomentum(const FreeMotion& had, const VectorX& mass, const NodalVectors& x, NodalVectors& v);

/// Lets a body turn without being braked by the matrix of its step: adds (dt^2 K + dt D) w to b, so that stiffness
/// and damping act on v - w. w takes the nodes through the step as a rigid body, w = (exp(dt [omega]) - 1) r / dt
/// about the centre of mass; a body that turns alone has the same omega at the end, and f(x + dt w) is f(x), turned.
///
/// Without it a step sees a body that turns stretch, by w's centripetal part; K and D of elements that have turned
/// since (by up to kTangentAngle) have a share of it too, and so has the damping of a stressed body, whose K has a
/// geometric part. Not of a body whose forces do not turn with it (ElasticModel::kLinear), and not of turns by more
/// than a radian in the step. A tissue of several separate parts turns as one here: a part at rest is strained by
/// (omega dt)^2 / 2.
/// @param v at the step's start.
/// @param w scratch, of x's size.
/// @param system with K, D and their scales for this step.
/// @pre no node is fixed or still.
void letTurn(const VectorX& mass, const NodalVectors& x, const NodalVectors& v, double dt_s, NodalVectors& w,
             BodySystem& system);

}  // namespace tissue_contact
