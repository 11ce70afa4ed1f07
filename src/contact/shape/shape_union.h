/// @file
/// Room `contact`, private: shapes of one instrument that touch each other, as one solid. A contact with one of them in;
/// normal and gap with regard to the other out.
///
/// Two shapes that meet (closed jaws, a jaw and its pivot) leave a groove whose walls close up on what is pressed into it:
/// normals become opposed, a little friction locks tissue in, and forces that no tissue could bear follow. Tissue cannot
/// fill such a groove, so where the shapes meet it is filled up: a point counts as inside that no ball of radius rho can
/// reach from outside (closing, Serra 1982, "Image Analysis and Mathematical Morphology"; the surface of a rolling-ball
/// blend). The ball touches both shapes, its centre c lies at distance rho from both; from a point p under it
///   gap = rho - |c - p|,   normal = (c - p) / |c - p|.
/// Between jaws that are open nothing is filled: the groove must close within about rho of the point. With phi the
/// distances of both shapes at p and n their gradients, even walls do so after (phi_1 + phi_2) / |n_1 + n_2|, which is infinite
/// between parallel faces; the radius goes to 0 as that goes from rho to 2 rho. And it must close, as walls that are round or end
/// need not: the radius goes to 0 as the least phi_1 + phi_2 on the way there goes from `room_m` to four times that.
#pragma once

#include "contact/shape/shape_distance.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

struct PlacedShape {
  const ShapeDistance* distance;
  Pose X_WS;
};

/// Signed distance at a point of the world; the normal in the world frame.
SignedDistance distanceAt(const PlacedShape& shape, const Vector3& p_W);

/// Whether what presses a point away from one shape presses it towards the other; also asked of different instruments.
bool areOpposed(const SignedDistance& first, const SignedDistance& second);

/// The distance to the filled groove between two shapes.
/// @param at_first, at_second what distanceAt() says of the shapes at p_W.
/// @param radius_m rho > 0.
/// @param room_m > 0: shapes that near touch each other.
/// @param filled overwritten when the groove is nearer than the first shape.
/// @return whether it is.
bool fillGroove(const PlacedShape& first, const PlacedShape& second, const Vector3& p_W, double radius_m, double room_m,
                const SignedDistance& at_first, const SignedDistance& at_second, SignedDistance& filled);

}  // namespace tissue_contact
