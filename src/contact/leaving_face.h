/// @file
/// Room `contact`, private: the face of a shape through which tissue leaves it, where the nearest one stands across the tissue's surface.
#pragma once

#include "contact/shape/shape_distance.h"

namespace tissue_contact {

/// A tool with edges (box, cylinder, mesh) that slides over a surface meets the next vertex sideways: it stands before the tool's side, a little
/// above its lower face. The side is nearer, but the surface there runs under the tool; a real one, which has points between its vertices,
/// passes below the edge. Pushed by the side, vertices are carried ahead: flat tools 12 mm wide, .1 to .4 mm deep in cells of 2 mm, were
/// held back by .5 to 3.3 times their load where friction is .4. So where the shape's normal is more than 37 degrees off the way into the tissue, and
/// a face less than that off ends the shape within half an edge below (a deeper step the cells can show themselves), the tissue leaves through that
/// face. A wall that the side really pushes faces it, and keeps it.
/// @param p_S a vertex of the surface of a volume, in the shape's frame, m.
/// @param outward_S mean normal of the surface there; unit, or zero: unknown.
/// @param edge_m longest edge there.
/// @param here the shape's distance at p_S.
/// @returns the normal of that face and the way to it along that normal; an infinite distance where the point is still outside, beside
///   the shape, and nothing need hold it; else `here`.
SignedDistance leavingFace(const ShapeDistance& shape, const Vector3& p_S, const Vector3& outward_S, double edge_m,
                           const SignedDistance& here);

}  // namespace tissue_contact
