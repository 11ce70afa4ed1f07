/// @file
/// Room `contact`, private: the face of a shape through which a vertex of the tissue leaves it, where the nearest one stands across the
/// tissue's surface.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "contact/shape/shape_distance.h"

namespace tissue_contact {

/// A surface around one of its vertices, in the shape's frame.
struct VertexSurroundings {
  Vector3 outward = Vector3::Zero();                               ///< sum of the triangles' normals
  double shortest_edge = std::numeric_limits<double>::infinity();  ///< m, of those that end at the vertex
  double least_facing = 1.0;                                       ///< least product of a triangle's normal with `side`

  /// @param side normal of the shape there.
  void add(const Vector3& vertex, const std::array<Vector3, 3>& corners, const Vector3& normal, const Vector3& side) {
    outward += normal;
    least_facing = std::min(least_facing, normal.dot(side));
    for (const Vector3& corner : corners) {
      const double edge = (corner - vertex).norm();
      if (edge > 0.0) shortest_edge = std::min(shortest_edge, edge);
    }
  }
};

/// What else of a tool there is beside a shape.
class ShapesBeside {
 public:
  virtual ~ShapesBeside() = default;
  /// Whether any of it is near the way between two points of the shape's frame, m, or lies in front of its end along `normal_S`, so that
  /// tissue there is held between both.
  virtual bool closeWay(const Vector3& p_S, const Vector3& end_S, const Vector3& normal_S) const = 0;
};

/// A tool with edges (box, cylinder, mesh) that slides over a surface meets the next vertex sideways: it stands before the tool's side, a little
/// above its lower face. The side is nearer, but the surface there runs under the tool; a real one, which has points between its vertices,
/// passes below the edge. Pushed by the side, vertices are carried ahead: flat tools 12 mm wide, .1 to .4 mm deep in cells of 2 mm, were
/// held back by .5 to 1.3 times their load in the middle of a drag, 2.7 at most, where friction is .4 (flat_tool_test). So where the shape's normal is more than 37 degrees off the way into the tissue,
/// no triangle around the vertex faces it, and beyond an edge a face less than that off ends the shape within half an edge of the surface below (a deeper step the
/// cells can show themselves), the tissue leaves through that face. The gap grows with the way in from the side, so that no force
/// begins with a jump.
/// @param p_S the vertex, of a volume, in the shape's frame, m.
/// @param here the shape's distance there.
/// @param beside asked whether it closes the way to that face, so that nothing leaves there; null: there is nothing.
/// @returns that face's normal and gap; an infinite one where the vertex is still outside, beside the shape, and nothing
///   need hold it; else `here`.
SignedDistance leavingFace(const ShapeDistance& shape, const Vector3& p_S, const VertexSurroundings& around,
                           const SignedDistance& here, const ShapesBeside* beside = nullptr);

}  // namespace tissue_contact
