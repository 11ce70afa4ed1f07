/// @file
/// Room `contact`: the few tolerances of contact detection. All are relative, so a scene in metres and the same scene
/// in millimetres give the same contacts. "Size" is ShapeDistance::size() of the shape at hand.
#pragma once

namespace tissue_contact {

/// Of the size: points whose distances differ by less are equally close. It makes the choice among them continuous
/// (their weighted mean), at the price of a location that may be this much off the minimum; 2 nm for a 2 mm instrument.
constexpr double kTie = 1e-6;

/// Of the size: below this distance the direction between two closest points is round-off, and the normal comes from
/// the feature of the shape instead.
constexpr double kTouch = 1e-9;

/// Of the size: a closest point whose gap is not smaller than that of a vertex or corner contact of the same triangle
/// by more than this adds nothing (the surfaces lie flush) and is left out. Larger than kTie, which it must absorb.
constexpr double kFlush = 1e-5;

/// Cosine: a tissue triangle faces the instrument when contact normal . triangle normal is below minus this. Not 0:
/// where a wall slides along a surface the product is round-off, and such contacts would come and go.
constexpr double kFacing = 0.05;

/// Slope: a corner counts as the shape's foremost point towards a triangle when its edges rise no steeper than this
/// towards the triangle, so all corners of a face that lies nearly flush count.
constexpr double kCornerSlope = 0.1;

/// Slope (6 degrees) above which the surface beside an edge or a vertex of a tissue counts as leading away from what it
/// touches.
constexpr double kSharp = 0.1;

/// Slope (1.7 degrees) up to which an edge of a tissue is as good as flat: between two such edges vertices on faces leave
/// a penetration of less than this slope times a quarter of the edge. A crossing that comes when edges have become
/// steeper pushes them out by that at once; with more the force jumps more, with less flat surfaces have more contacts.
constexpr double kFlat = 0.03;

}  // namespace tissue_contact
