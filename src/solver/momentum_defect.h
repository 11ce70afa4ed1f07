/// @file
/// Room `solver`, private: what is left of A v = b + J'lambda.
#pragma once

#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// b + J'lambda - A v of a free node i, N s.
/// @tparam kDamped the body has a damping matrix: known when compiled, so that the others do not ask node by node.
/// @param impulses J'lambda of the body.
template <bool kDamped>
[[gnu::always_inline]] inline Vector3 nodeDefect(const BodySystem& body, const NodalVectors& impulses, int i,
                                                 const NodalVectors& v) {
  const Vector3 v_i = v.col(i);
  const Vector3 elastic = body.K->offDiagonalProduct(i, v) + body.K->diagonal[i] * v_i;
  Vector3 defect = body.b.col(i) + impulses.col(i) - body.mass[i] * v_i - body.stiffness_scale * elastic;
  if (kDamped) defect -= body.damping_scale * (body.D->offDiagonalProduct(i, v) + body.D->diagonal[i] * v_i);
  return defect;
}

/// The same of all nodes, zero at fixed ones.
/// @param defect may be `impulses` itself.
/// @return its squared norm, (N s)^2.
double bodyDefect(const BodySystem& body, const NodalVectors& v, const NodalVectors& impulses, NodalVectors& defect);

}  // namespace tissue_contact
