/// @file
/// Room `tissue`: one tissue of a scene, placed in the world: mesh, surface, fixed nodes, masses and elasticity.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/scene/scene.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/tet_mesh.h"

namespace tissue_contact {

/// Const after construction.
class Tissue {
 public:
  /// @param X_WT pose of the tissue frame in the world (tf already looked up). @throws std::invalid_argument.
  Tissue(const TissueDescription& description, const Pose& X_WT);

  const std::string& name() const { return name_; }
  int nodeCount() const { return static_cast<int>(rest_.cols()); }
  const NodalVectors& restPositions() const { return rest_; }  ///< m, world frame
  const std::vector<Tetrahedron>& tetrahedra() const { return tetrahedra_; }
  const std::vector<Triangle>& surface() const { return surface_; }
  const std::vector<bool>& fixed() const { return fixed_; }
  const VectorX& nodeMasses() const { return masses_; }  ///< kg, lumped: a quarter of each tetrahedron's mass
  const DampingDescription& damping() const { return damping_; }
  const Elasticity& elasticity() const { return elasticity_; }

 private:
  struct PlacedMesh;
  static PlacedMesh placeMesh(const TissueDescription& description, const Pose& X_WT);
  Tissue(const TissueDescription& description, const PlacedMesh& placed);

  std::string name_;
  NodalVectors rest_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<Triangle> surface_;
  std::vector<bool> fixed_;
  VectorX masses_;
  DampingDescription damping_;
  Elasticity elasticity_;
};

}  // namespace tissue_contact
