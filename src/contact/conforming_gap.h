/// @file
/// Room `contact`, private: the gap between a shape and a tissue whose surface bends with the shape between its nodes.
#pragma once

#include <array>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Flat triangles that may nowhere cut a shape of radius R keep their vertices up to edge^2 / (8 R) to edge^2 / (4 R) away
/// from it: tissue seems to be met early, by a shape that is larger than it is, and the force of a press is too large by
/// 1.5 times that over the depth. Where the shape is smooth as seen from the triangle, the gap of a point is therefore
/// taken as that of a surface through the same vertices with the shape's own curvature in between, sum w_i phi(x_i),
/// which is phi(p) plus the sagitta. With l^2 = sum w_i |x_i - p|^2 the sagitta is l^2 / (2 R), so 2 sagitta / l = l / R
/// tells how smooth that is: all of the sagitta counts up to l / R = 1/4 (edges of half the radius), none from 1/2 on (an
/// edge or a tip that pokes into the middle of a triangle).
/// Where all of it counts, the vertices' own contacts say the same and the point needs none.
/// @param corners, distances of the triangle's vertices, m, and the shape's signed distance phi there.
/// @param weights barycentric.
/// @param gap phi at that point, m.
struct ConformingGap {
  double gap = 0.0;    ///< m; but for round-off not less than the one given where that is the triangle's least
  bool fully = false;  ///< all of the sagitta counts
};
ConformingGap conformingGap(const std::array<Vector3, 3>& corners, const std::array<double, 3>& distances,
                            const Vector3& weights, double gap);

}  // namespace tissue_contact
