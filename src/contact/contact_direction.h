/// @file
/// Room `contact`, private: which way a shape presses a point of a face or edge of the tissue.
#pragma once

#include "contact/shape/shape_distance.h"
#include "mesh/surface/triangle_geometry.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Projector onto the directions along the face or edge of a triangle that a point lies on; zero at a vertex.
/// @param weights the point's, barycentric, 0 where it lies on an edge.
Matrix3 tangentOf(const TrianglePoints& points, const Vector3& weights);

/// Normal and gap at the point of a feature where the shape is nearest; a normal of 0 where there is no direction of contact.
SignedDistance contactDirection(const ClosestPoint& closest, const Matrix3& tangent);

/// The same at a point that was the nearest once and carries force. Where tissue bends around a tool's edge it lies on one side of
/// the ridge or on the other as round-off and the solver have it, and the faces' normals differ by a right angle: with the nearest face's
/// a block between jaws smaller than its face was pushed up by their upper faces, and walked 5 um/s (box_jaws_test). So near a
/// ridge the combination of the normals there counts that is most nearly perpendicular to the tissue; its gap is right to twice that nearness.
/// @param points a triangle of the feature, and for normal the mean over all its triangles; of a vertex none is needed.
SignedDistance keptContact(const ShapeDistance& shape, const TrianglePoints& points, const Vector3& weights);

}  // namespace tissue_contact
