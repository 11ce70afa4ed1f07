#include "ros/publish/crtk_wrench.h"

namespace tissue_contact {

Wrench bodyMeasuredForce(const Wrench& felt) {
  // Not -x, which makes a minus of zero.
  return {Vector3::Zero() - felt.force, Vector3::Zero() - felt.torque};
}

Wrench spatialMeasuredForce(const Wrench& felt, const Pose& X_BT) {
  const Wrench body = bodyMeasuredForce(felt);
  const Vector3 force = X_BT.linear() * body.force;
  return {force, X_BT.linear() * body.torque + X_BT.translation().cross(force)};
}

}  // namespace tissue_contact
