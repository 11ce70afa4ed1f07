/// @file
/// The smallest meshes that are accepted, as texts of files.
#pragma once

#include <string>

namespace tissue_contact {

/// One tetrahedron with edges of 1 m along the axes, far from the origin.
inline std::string vtkTetrahedron() {
  return "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
         "5 0 0 6 0 0 5 1 0 5 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
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
