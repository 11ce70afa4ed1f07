/// @file
/// Room `mesh`, private: what a mesh file calls its parts: physical groups of Gmsh, cell data of VTK.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/bisection.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/region_description.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

struct MeshLabels {
  struct Group {
    int dimension = 0;  ///< 0: points ... 3: volume
    std::int64_t number = 0;
    std::string name;  ///< empty: it has none
    /// Indices of nodes: one for points, four for tetrahedra; the rest are -1.
    std::vector<std::array<int, 4>> elements;
  };
  struct CellData {
    std::string name;
    std::vector<double> values;  ///< per volume of the file
  };
  NodalVectors nodes;  ///< of the file, with those that no tetrahedron uses, m
  std::vector<Group> groups;
  std::vector<CellData> cell_data;
  std::vector<int> volume_of;  ///< per tetrahedron: the volume of the file that it is, or a part of
};

/// Whether any of them is a group or cell data.
bool namesLabels(const std::vector<Region>& regions);

/// The regions with each group and cell data as the places it consists of: nodes, centroids of tetrahedra and of their faces, centroids of
/// triangles. So it holds what it holds whatever is asked: nodes, elements or surface triangles.
/// @param entry of the regions in their tissue, "fixed".
/// @throws EntryError naming `source`, what there is not and what there is.
std::vector<Region> withPlaces(const std::vector<Region>& regions, const MeshLabels& labels, const TetMesh& mesh,
                               const std::string& entry, const std::string& source);

/// Of such regions each group and cell data with the parts of what it holds as well.
std::vector<Region> withParts(const std::vector<Region>& regions, const std::vector<LastingPart>& parts,
                              double rounding);

}  // namespace tissue_contact
