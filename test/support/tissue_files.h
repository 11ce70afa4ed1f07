/// @file
/// Meshes as texts of files: the smallest that are accepted, and any.
#pragma once

#include <cstddef>
#include <sstream>
#include <string>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

/// One tetrahedron with edges of 1 m along the axes, far from the origin.
inline std::string vtkTetrahedron() {
  return "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
         "5 0 0 6 0 0 5 1 0 5 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
}

inline std::string vtkOf(const TetMesh& mesh) {
  std::ostringstream vtk;
  vtk.precision(17);
  vtk << "# vtk DataFile Version 2.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << mesh.positions.cols()
      << " double\n"
      << mesh.positions.transpose() << "\nCELLS " << mesh.tetrahedra.size() << ' ' << 5 * mesh.tetrahedra.size()
      << '\n';
  for (const Tetrahedron& t : mesh.tetrahedra) vtk << "4 " << t[0] << ' ' << t[1] << ' ' << t[2] << ' ' << t[3] << '\n';
  vtk << "CELL_TYPES " << mesh.tetrahedra.size() << '\n';
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) vtk << "10\n";
  return vtk.str();
}

/// The surface of a tetrahedron with edges of 1 cm along the axes.
inline std::string stlTetrahedron() {
  const auto facet = [](const char* a, const char* b, const char* c) {
    return std::string("facet normal 0 0 0\nouter loop\nvertex ") + a + "\nvertex " + b + "\nvertex " + c +
           "\nendloop\nendfacet\n";
  };
  const char* const o = "0 0 0";
  const char* const x = ".01 0 0";
  const char* const y = "0 .01 0";
  const char* const z = "0 0 .01";
  return "solid x\n" + facet(o, y, x) + facet(o, x, z) + facet(o, z, y) + facet(x, y, z) + "endsolid x\n";
}

}  // namespace tissue_contact
