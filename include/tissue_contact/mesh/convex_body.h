/// @file
/// Room `mesh`: when a body cannot touch itself. Its shape at rest and present positions in; yes or no out.
///
/// In a body that is convex at rest, the straight way between two of its points X and Y lies inside it. The displacement
/// is linear in every element, so along that way it changes by at most k |X - Y|, with k the largest |F - I| of all
/// elements, and  |x - y| >= (1 - k) |X - Y|:  while k < 1, no two points of the body come together.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Whether a closed surface bounds a convex body: across none of its edges does the node of a neighbour lie before a triangle by more
/// than 1e-9 of the size of its bounding box (the rounding of coordinates), and it goes once around its middle. Linear in the
/// number of triangles; with a triangle lower than 1e-4 of the size, nodes x triangles, all against all.
bool isConvex(const NodalVectors& x, const std::vector<Triangle>& surface);

/// Holds a cache: not thread-safe.
class ConvexBody {
 public:
  /// k at which the body is said to be able to fold: half of what it takes.
  static constexpr double kMostStrain = 0.5;

  /// @param rest 3 x n, m, of a convex body.
  ConvexBody(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra);

  /// Whether k < kMostStrain, and k < 1 even after all nodes have moved by up to `travel_m`, with Frobenius's norm, which
  /// is never less than the spectral one. The answer depends on x
  /// alone; elements are measured only when nodes have moved far enough since to make a difference.
  /// No allocation.
  bool cannotFold(const NodalVectors& x, double travel_m = 0.0);

 private:
  struct Element {
    Tetrahedron nodes;
    Matrix3 rest_inverse;  ///< 1/m
  };
  double strain(const Element& element, const NodalVectors& x) const;

  std::vector<Element> elements_;
  double steepest_ = 0.0;  ///< most that |F| of an element changes when its nodes move by at most 1 m, 1/m
  NodalVectors measured_at_;
  double strain_ = 0.0;    ///< k at measured_at_
  std::size_t worst_ = 0;  ///< the element that was over the limit last
};

}  // namespace tissue_contact
