/// @file
/// Room `ros`, private: wrenches as the Collaborative Robotics Toolkit (CRTK) has them on the da Vinci Research Kit: what the arm exerts,
/// where ours is what the tissues exert on it.
#pragma once

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// body/measured_cf: of the arm on its environment, at the tip and in its axes.
///
/// The dVRK takes it from its motors by the body Jacobian, w = (J_b^T)^+ tau, and its example of force feedback negates it for the
/// surgeon's hand (sawIntuitiveResearchKit, mtsIntuitiveResearchKitArm and mtsDerivedTeleOperationPSM).
/// @param felt of the environment on the arm, at the tip and in its axes (N, N m).
Wrench bodyMeasuredForce(const Wrench& felt);

/// spatial/measured_cf: the same, at the origin of the arm's first frame and in its axes: w = (J_s^T)^+ tau with the spatial Jacobian
/// J_s = Ad(X_BT) J_b (Murray, Li, Sastry: A Mathematical Introduction to Robotic Manipulation, 1994, section 3.4).
/// @param X_BT pose of the tip in the arm's first frame.
Wrench spatialMeasuredForce(const Wrench& felt, const Pose& X_BT);

}  // namespace tissue_contact
