/// @file
/// Room `contact`, private: where and which way a shape presses a vertex of the tissue.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "contact/leaving_face.h"
#include "contact/nodal_normal.h"
#include "contact/shape/shape_distance.h"
#include "mesh/surface/moving_surface.h"
#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {

/// The face through which a vertex leaves a shape (leaving_face.h) or, through the nearest, the shape's mean normal over what the vertex
/// stands for (nodal_normal.h).
/// @param position of a node, in the shape's frame, m.
/// @param lets_under nothing else of the instrument closes the way under the shape.
/// @param here the shape's distance at the vertex.
template <typename Position>
SignedDistance vertexContact(const ShapeDistance& shape, const MovingSurface& surface, int node,
                             const Position& position, bool lets_under, const SignedDistance& here) {
  const auto cornersOf = [&](int triangle) -> std::array<Vector3, 3> {
    const Triangle& nodes = surface.triangles()[triangle];
    return {position(nodes[0]), position(nodes[1]), position(nodes[2])};
  };
  const Vector3 vertex = position(node);
  if (lets_under && shape.hasFlatParts() && surface.isVolume()) {
    VertexSurroundings around;
    surface.anyTriangleOf({node, -1, -1}, [&](int triangle) {
      const std::array<Vector3, 3> corners = cornersOf(triangle);
      around.add(vertex, corners, triangleNormal(corners[0], corners[1], corners[2]), here.normal);
      return false;
    });
    const SignedDistance left = leavingFace(shape, vertex, around, here);
    if (left.normal != here.normal || left.distance != here.distance) return left;
  }
  NodalNormal normal(shape, vertex, here.normal);
  surface.anyTriangleOf({node, -1, -1}, [&](int triangle) {
    const Triangle& nodes = surface.triangles()[triangle];
    normal.add(cornersOf(triangle),
               static_cast<std::size_t>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin()));
    return false;
  });
  return {here.distance, normal.mean()};
}

}  // namespace tissue_contact
