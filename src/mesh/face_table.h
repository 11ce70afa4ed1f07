/// @file
/// Room `mesh`, private: the faces of a tetrahedral mesh: which tetrahedra share one.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A face as one of its tetrahedra has it.
struct FaceUse {
  Triangle nodes;  ///< ascending, so that both of its tetrahedra say the same
  std::size_t tetrahedron;
  std::size_t opposite;  ///< the node of the tetrahedron that the face lacks, 0 to 3
};

/// Of a tetrahedron of positive volume: counter-clockwise seen from outside.
Triangle outwardFace(const Tetrahedron& tetrahedron, std::size_t opposite);

/// A face that a single tetrahedron has.
struct OuterFace {
  std::size_t tetrahedron;
  std::size_t opposite;
};

/// In ascending order of tetrahedra and opposite nodes.
/// @throws std::invalid_argument as boundaryTriangles().
std::vector<OuterFace> outerFaces(const std::vector<Tetrahedron>& tetrahedra);

/// All faces of all tetrahedra; uses of one face are neighbours in the list, in the order of their tetrahedra.
std::vector<FaceUse> sortedFaces(const std::vector<Tetrahedron>& tetrahedra);

}  // namespace tissue_contact
