/// @file
/// Room `contact`, private: a signed distance sampled on a regular grid. Point in the shape's frame S in; distance and
/// gradient out, at a cost that knows nothing of the triangles the samples came from.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

struct GridSample {
  double distance = 0.0;               ///< m, > 0 outside
  Vector3 gradient = Vector3::Zero();  ///< of length about 1; shorter where opposite or meeting faces are equally near
};

/// The samples are the coefficients of a quadratic B-spline: once continuously differentiable, so that forces do not
/// jump from cell to cell as they do with trilinear interpolation; exact where the distance is linear (flat faces);
/// and, its weights being positive, nowhere steeper than the samples and never outside their range. Where faces meet it
/// rounds with a radius of about the spacing.
struct DistanceGrid {
  Vector3 origin = Vector3::Zero();     ///< of sample (0, 0, 0), m
  double spacing = 0.0;                 ///< m
  std::array<int, 3> size = {0, 0, 0};  ///< samples per axis, >= 4
  std::vector<float> samples;           ///< m, x runs fastest

  std::size_t index(int i, int j, int k) const { return (static_cast<std::size_t>(k) * size[1] + j) * size[0] + i; }
  Vector3 point(int i, int j, int k) const { return origin + spacing * Vector3(i, j, k); }

  /// Where the spline is defined: one spacing inside the samples.
  Eigen::AlignedBox3d box() const;

  /// Outside box(): the length of the way to the box and of the distance there, at a right angle. For a shape inside the
  /// box that is never more than the true distance, and continuous.
  GridSample at(const Vector3& p_S) const;

  /// The distance of at(), to the bit, at half the cost.
  double valueAt(const Vector3& p_S) const;

 private:
  struct Neighbours;
  Neighbours around(const Vector3& p_S) const;
  double valueInside(const Vector3& p_S) const;
  GridSample inside(const Vector3& p_S) const;
};

/// Where inside and outside meet without a surface between them: across an opening of the mesh the samples came from.
struct FieldJump {
  double width_m = 0.0;  ///< by how much the distance jumps, which is about the width of the opening; 0: nowhere
  Vector3 p_S = Vector3::Zero();  ///< between the samples where it jumps most, about the middle of the opening
};

/// Of two neighbouring samples on different sides the surface passes between, so both together are no farther from it than the
/// samples from each other. Looked at are those that differ by more than twice that, since where shells pass through
/// each other the outer surface is known to some spacings only.
FieldJump widestJump(const DistanceGrid& grid);

}  // namespace tissue_contact
