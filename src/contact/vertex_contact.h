/// @file
/// Room `contact`, private: which way a shape presses a vertex of the tissue.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "contact/leaving_face.h"
#include "contact/nodal_normal.h"
#include "contact/shape/shape_distance.h"
#include "mesh/surface/moving_surface.h"

namespace tissue_contact {

/// What is around a vertex of a surface.
/// @tparam Position of a node, m, and Normal of a triangle: both in the shape's frame.
template <typename Position, typename Normal>
class VertexContact {
 public:
  VertexContact(const ShapeDistance& shape, const MovingSurface& surface, int node, const Position& position,
                const Normal& normal)
      : shape_(shape), surface_(surface), node_(node), position_(position), normal_(normal) {}

  /// The face through which the vertex leaves the shape (leaving_face.h, which see for `beside`).
  /// @param here the shape's distance at it.
  SignedDistance leaves(const SignedDistance& here, const ShapesBeside* beside) const {
    if (!shape_.hasFlatParts() || !surface_.isVolume()) return here;
    VertexSurroundings around;
    eachTriangle([&](int triangle, const std::array<Vector3, 3>& corners) {
      around.add(position_(node_), corners, normal_(triangle), here.normal);
    });
    return leavingFace(shape_, position_(node_), around, here, beside);
  }

  /// Mean normal of the shape over what the vertex stands for (nodal_normal.h).
  /// @param here the shape's normal at the vertex.
  Vector3 meanNormal(const Vector3& here) const {
    NodalNormal mean(shape_, position_(node_), here, surface_.isVolume());
    eachTriangle([&](int triangle, const std::array<Vector3, 3>& corners) {
      const Triangle& nodes = surface_.triangles()[triangle];
      mean.add(corners, static_cast<std::size_t>(std::find(nodes.begin(), nodes.end(), node_) - nodes.begin()));
    });
    return mean.mean();
  }

 private:
  template <typename Visit>
  void eachTriangle(const Visit& visit) const {
    surface_.anyTriangleOf({node_, -1, -1}, [&](int triangle) {
      const Triangle& nodes = surface_.triangles()[triangle];
      visit(triangle, std::array<Vector3, 3>{position_(nodes[0]), position_(nodes[1]), position_(nodes[2])});
      return false;
    });
  }

  const ShapeDistance& shape_;
  const MovingSurface& surface_;
  const int node_;
  const Position& position_;
  const Normal& normal_;
};

}  // namespace tissue_contact
