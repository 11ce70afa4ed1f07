/// @file
/// Room `contact`: the contact normal where the signed distance has a ridge.
#pragma once

#include "contact/shape_distance.h"

namespace tissue_contact {

/// The convex combination g of the gradients whose part along the tissue feature is smallest: |tangent * g| -> min.
/// At a minimum of the distance over a face (edge) some combination has no part along that face (edge) at all; that
/// one, not any of the gradients it is made of, is the direction of contact between, say, an instrument edge and a
/// tissue face. It is shorter than 1 on a ridge: moving along g / |g| by s changes the least distance by |g| s.
/// @param tangent projector onto the directions along the feature: I - n n^T for a face, e e^T for an edge
Vector3 stationaryGradient(const GradientSet& gradients, const Matrix3& tangent);

}  // namespace tissue_contact
