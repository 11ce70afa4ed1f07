/// @file
/// Room `simulation`, private: a body that nothing holds turns without being braked by the matrix of its step.
#pragma once

#include "tissue_contact/core/types.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// Adds (dt^2 K + dt D) w to b, so that stiffness and damping act on v - w. w is the velocity that takes the nodes through the step as
/// a rigid body, w = (exp(dt [omega]) - 1) r / dt about the centre of mass, with the omega that has the angular momentum of v (a
/// body that turns alone has the same one at the end). f(x + dt w) is f(x), turned.
///
/// Without it a step sees a body that turns stretch, by w's centripetal part; K and D of turned elements have a share of it too (they
/// are those of up to kTangentAngle ago), and so has the damping of a stressed body, whose K has a geometric part. Against all
/// three such a body turned as in syrup.
/// @param mass kg. @param x m. @param v m/s: at the step's start. @param w scratch.
/// @param system with K, D and their scales for this step. @pre no node is fixed or still.
void letTurn(const VectorX& mass, const NodalVectors& x, const NodalVectors& v, double dt_s, NodalVectors& w,
             BodySystem& system);

}  // namespace tissue_contact
