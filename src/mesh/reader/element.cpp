#include "mesh/reader/element.h"

#include <algorithm>
#include <iterator>

namespace tissue_contact {
namespace {

/// Local corners, counter-clockwise seen from outside; the last of a triangle is -1.
using LocalFace = std::array<int, 4>;

constexpr LocalFace kPyramidFaces[] = {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}};
constexpr LocalFace kPrismFaces[] = {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
constexpr LocalFace kHexahedronFaces[] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                          {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

/// The triangles of a face of three or four corners; a quadrangle from its smallest on.
template <typename Use>
void forTriangles(ElementCorners face, const Use& use) {
  const auto end = face.begin() + static_cast<std::ptrdiff_t>(cornerCount(face));
  std::rotate(face.begin(), std::min_element(face.begin(), end), end);
  use(Triangle{face[0], face[1], face[2]});
  if (face[3] >= 0) use(Triangle{face[0], face[2], face[3]});
}

template <std::size_t N>
void splitBySmallest(const ElementCorners& corners, const LocalFace (&faces)[N], std::vector<Tetrahedron>& tetrahedra) {
  const auto used = corners.begin() + static_cast<std::ptrdiff_t>(cornerCount(corners));
  const int apex = *std::min_element(corners.begin(), used);
  for (const LocalFace& local : faces) {
    ElementCorners face = kNoCorners;
    for (std::size_t i = 0; i < local.size() && local[i] >= 0; ++i) {
      face[i] = corners[static_cast<std::size_t>(local[i])];
    }
    forTriangles(face, [&](const Triangle& t) {
      const bool has_apex = t[0] == apex || t[1] == apex || t[2] == apex;
      const bool has_collapsed = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
      if (!has_apex && !has_collapsed) tetrahedra.push_back({apex, t[0], t[1], t[2]});
    });
  }
}

}  // namespace

std::size_t cornerCount(const ElementCorners& corners) {
  return static_cast<std::size_t>(std::find(corners.begin(), corners.end(), -1) - corners.begin());
}

void addTetrahedra(const ElementCorners& corners, std::vector<Tetrahedron>& tetrahedra) {
  switch (cornerCount(corners)) {
    case 5:
      return splitBySmallest(corners, kPyramidFaces, tetrahedra);
    case 6:
      return splitBySmallest(corners, kPrismFaces, tetrahedra);
    case 8:
      return splitBySmallest(corners, kHexahedronFaces, tetrahedra);
    default:
      tetrahedra.push_back({corners[0], corners[1], corners[2], corners[3]});
  }
}

void addTriangles(const ElementCorners& quadrangle, std::vector<Triangle>& triangles) {
  forTriangles(quadrangle, [&](const Triangle& triangle) { triangles.push_back(triangle); });
}

}  // namespace tissue_contact
