/// @file
/// Room `contact`, private: the direction of a vertex's contact, a smooth shape's normal over the surface that the
/// vertex stands for.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "contact/shape/shape_distance.h"
#include "contact/tolerances.h"

namespace tissue_contact {

/// The force on a vertex is the traction on a third of each triangle around it, each a quadrilateral of the
/// vertex, the middles of two edges and that of the triangle. Its direction is therefore the mean of the normals
/// at the centroids of these, (22 x + 7 a + 7 b) / 36 with the other corners a and b, by area. That differs from
/// the normal at the vertex where triangles are larger on one side: a dragged ball stretches the tissue behind it
/// to some 1.7 times its length and presses that ahead together, to some .65, and with vertices' own normals its
/// load is too far ahead by a tenth of an edge (doc/notes/method.md). Where the shape bends by more than kMostTurn on
/// the way from the vertex, its normal there counts less, from kNoTurn on not at all: edges, and tips that poke
/// into triangles. Of a shape with flat parts it counts by the share of the turn that is made at kBegins of the
/// way: where none is, the vertex is on a flat face beside an edge, and that face presses straight.
class NodalNormal {
 public:
  /// @param here of the shape at the vertex; all in the shape's frame.
  /// @param has_inside the surface bounds a volume: only triangles that face the shape bear its pressure.
  NodalNormal(const ShapeDistance& shape, const Vector3& vertex, const Vector3& here, bool has_inside)
      : shape_(shape), vertex_(vertex), here_(here), has_inside_(has_inside) {}

  /// A triangle that has the vertex, counter-clockwise from outside. @param corner the vertex among its corners.
  void add(const std::array<Vector3, 3>& corners, std::size_t corner) {
    const Vector3 a = corners[(corner + 1) % 3] - vertex_;
    const Vector3 b = corners[(corner + 2) % 3] - vertex_;
    const Vector3 cross = a.cross(b);
    const double area = cross.norm();
    if (has_inside_ && !(cross.dot(here_) < -kFacing * area)) return;
    area_ += area;
    const Vector3 way = 7.0 / 36.0 * (a + b);
    const Vector3 turn = turnOn(way);
    const double turned = turn.norm();
    double share = std::clamp((kNoTurn - turned) / (kNoTurn - kMostTurn), 0.0, 1.0);
    if (share > 0.0 && turned > 0.0 && shape_.hasFlatParts()) {
      share *= std::min(turnOn(kBegins * way).norm() / (kBegins * turned), 1.0);
    }
    turns_ += area * share * turn;
  }

  Vector3 mean() const { return area_ > 0.0 ? Vector3((here_ + turns_ / area_).normalized()) : here_; }

 private:
  static constexpr double kMostTurn = 0.25;  // length of the difference of two normals
  static constexpr double kNoTurn = 0.5;
  static constexpr double kBegins = 0.25;  // of the way

  Vector3 turnOn(const Vector3& way) const { return shape_.at(vertex_ + way).normal - here_; }

  const ShapeDistance& shape_;
  const Vector3 vertex_;
  const Vector3 here_;
  const bool has_inside_;
  Vector3 turns_ = Vector3::Zero();  ///< over the areas, twice as large as the triangles
  double area_ = 0.0;
};

}  // namespace tissue_contact
