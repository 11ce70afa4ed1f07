/// @file
/// Room `mesh`: what a mesh is generated or read from, in SI units.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Of a generated mesh, and of all tissues of a scene: a step over so many takes seconds.
constexpr std::size_t kMostElements = 2'000'000;

/// Spacing of the cells of a block along one axis: each cell is `growth` times as long as its neighbour nearer
/// `fine_at`.
struct AxisGrading {
  enum class FineAt { kMinimum, kCenter, kMaximum };
  double growth = 1.0;  ///< >= 1, dimensionless; 1 = even spacing
  FineAt fine_at = FineAt::kCenter;
};

/// Generated block. Tissue frame T: origin at the centre of the block's lowest face (z = 0), z up to size_m.z().
struct BlockDescription {
  Vector3 size_m = Vector3::Zero();
  std::array<int, 3> cells = {0, 0, 0};  ///< cells (not nodes) along x, y, z; 5 tetrahedra each, alternating split
  std::array<AxisGrading, 3> grading;
};

/// What becomes of nodes that lie in one place, as elements around them do not hang together there: the file is refused; they become one;
/// or they stay, as a cut that may open.
enum class CoincidentNodes { kRefuse, kMerge, kKeep };

/// A tetrahedral mesh file (.msh, .vtk), or a surface (.stl, .obj, .ply) to be filled with tetrahedra. File coordinates times
/// `scale_m_per_unit` are metres in the tissue frame T.
struct MeshDescription {
  std::string file;  ///< absolute path
  double scale_m_per_unit = 1.0;
  bool remove_unreferenced_nodes = false;  ///< drop nodes that no tetrahedron uses instead of refusing the file
  CoincidentNodes coincident_nodes = CoincidentNodes::kRefuse;
  double cell_size_m = 0.0;         ///< 0: a tetrahedral mesh; else the edge of the cells that fill the surface, m
  double cell_size_inside_m = 0.0;  ///< of the cells deep inside; 0: the same
};

/// Generated flat sheet (membrane, cloth, strip). Tissue frame T: origin at its centre, normal along z.
struct SheetDescription {
  Vector2 size_m = Vector2::Zero();
  std::array<int, 2> cells = {0, 0};  ///< along x, y; 2 triangles each, alternating split
  double thickness_m = 0.0;
};

/// Triangle mesh file (.stl, .obj, .dae) used as a membrane. File coordinates times the scale are metres in T.
struct ShellDescription {
  std::string file;  ///< absolute path
  double scale_m_per_unit = 1.0;
  double thickness_m = 0.0;
};

}  // namespace tissue_contact
