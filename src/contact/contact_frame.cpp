/// @file
/// Room `contact`: a tangent frame for a normal.
#include "tissue_contact/contact/contact.h"

namespace tissue_contact {

/// The shortest rotation of a fixed frame (a, b, a x b) onto one whose first column is n. It has no answer at n = -a
/// only (any continuous choice must fail somewhere); a = (2, 3, 6) / 7 keeps that direction away from the axes and
/// diagonals, where normals dwell. With v = a + n, 1 + a . n = |v|^2 / 2 without cancellation.
Matrix3 contactFrame(const Vector3& n) {
  static const Vector3 a = Vector3(2.0, 3.0, 6.0) / 7.0;
  static const Vector3 b = Vector3(3.0, -6.0, 2.0) / 7.0;
  const Vector3 v = a + n;
  const double v_squared = v.squaredNorm();
  Vector3 t1 = b;
  if (v_squared > 1e-24) t1 -= 2.0 * n.dot(b) / v_squared * v;
  t1 = (t1 - n.dot(t1) * n).normalized();  // clears what round-off left where |v| is small
  Matrix3 frame;
  frame << n, t1, n.cross(t1);
  return frame;
}

}  // namespace tissue_contact
