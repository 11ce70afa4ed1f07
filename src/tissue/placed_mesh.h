/// @file
/// Room `tissue`, private: the mesh of a tissue, of whatever geometry, with what its description says about nodes,
/// elements and surface triangles.
#pragma once

#include <string>
#include <vector>

#include "mesh/bisection.h"
#include "tissue/attached_elasticity.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/tissue.h"
#include "tissue_contact/tissue/tissue_description.h"

namespace tissue_contact {

struct PlacedMesh {
  NodalVectors rest;                    ///< m, in the world
  std::vector<Tetrahedron> tetrahedra;  ///< the elements of a volume; none: the surface triangles are the elements
  std::vector<Triangle> surface;
  double thickness = 0.0;     ///< m; 0: a volume
  std::vector<int> patch_of;  ///< of each tetrahedron: see MeanStrain
  std::vector<bool> fixed;
  std::vector<int> element_regions;  ///< per element, -1: none; empty: the description has no regions
  std::vector<int> surface_regions;  ///< likewise per surface triangle
  std::vector<Vector2> surface_fibres;
  std::vector<NodeSpring> springs;  ///< of attachments, at free nodes, each node at most once
  std::vector<Triangle> pressed;    ///< surface triangles under the tissue's pressure

  /// By which regions hold elements and surface triangles, m, in the tissue frame: their centroids; of a refined mesh BisectedMesh's.
  NodalVectors element_places, surface_places;

  bool isVolume() const { return !tetrahedra.empty(); }
};

/// @throws std::invalid_argument naming the tissue: see Tissue.
PlacedMesh placeMesh(const TissueDescription& description, const Pose& X_WT, const MeshSizeCheck& on_size,
                     const MeshPreparation& preparation);

struct RefinableMesh {
  TissueDescription description;  ///< with groups and cell data as the places they are
  Bisection bisection;
  double body_coarsening;  ///< refineBody()
};

/// The mesh that a volume's description asks for, to be refined. A block's cells are split into six tetrahedra.
/// @throws std::invalid_argument naming the tissue: see Tissue.
RefinableMesh refinableMesh(const TissueDescription& description, const MeshSizeCheck& on_size,
                            const MeshPreparation& preparation);

/// The same as placeMesh() above with that mesh, refined.
PlacedMesh placeMesh(const TissueDescription& description, const Pose& X_WT, const BisectedMesh& mesh);

/// How messages begin: "tissue '<name>'".
std::string tissueLabel(const TissueDescription& description);

}  // namespace tissue_contact
