/// @file
/// Room `mesh`, private: what the readers of mesh files share: the contents they return and the reading of a node.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/labels.h"
#include "mesh/reader/element.h"
#include "mesh/reader/mesh_file_cursor.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A mesh as the file has it: file units, file order. Node indices are in range and coordinates finite.
struct MeshFileContents {
  struct Group {  ///< as MeshLabels::Group
    int dimension = 0;
    std::int64_t number = 0;
    std::string name;
    std::vector<ElementCorners> elements;
  };
  std::vector<Vector3> nodes;
  std::vector<ElementCorners> volumes;          ///< tetrahedra, pyramids, prisms and hexahedra
  std::size_t other_elements = 0;               ///< elements skipped because they are none
  std::size_t other_volumes = 0;                ///< of these: what fills space as well, or may
  std::size_t higher_order = 0;                 ///< volumes that had more nodes than their corners
  std::vector<int> between_corners;             ///< those nodes, as often as such a volume has them
  std::vector<Group> groups;                    ///< none unless asked for
  std::vector<MeshLabels::CellData> cell_data;  ///< per volume
};

/// Gmsh MSH 1, 2.x, 4.0 and 4.1, ASCII and (but for 1) binary of either byte order; `in` at its start.
/// @throws std::invalid_argument.
MeshFileContents readGmsh(MeshFileCursor& in, bool with_labels);

/// Legacy VTK 1 to 5, ASCII and binary, data set UNSTRUCTURED_GRID; `in` at its start.
/// @throws std::invalid_argument.
MeshFileContents readVtk(MeshFileCursor& in, bool with_labels);

/// Reads three coordinates (`bytes` each if binary) of node `index`.
/// @throws std::invalid_argument if one is not finite.
Vector3 readNode(MeshFileCursor& in, int bytes, std::size_t index);

}  // namespace tissue_contact
