/// @file
/// Room `tissue`: one tissue of a scene, placed in the world: mesh, surface, fixed nodes, regions, fibres, masses,
/// elasticity, attachments, pressure.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/mesh_preparation.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/material_description.h"
#include "tissue_contact/tissue/tissue_description.h"

namespace tissue_contact {

/// Told the size of a mesh; may throw to refuse it.
using MeshSizeCheck = std::function<void(std::size_t nodes, std::size_t elements)>;

/// What a Tissue would refuse before it looks at its mesh. @throws EntryError of an entry of the tissue in a scene: a model
/// that does not suit the geometry or differs between regions, a material, damping, attachment or pressure out of range.
void checkTissue(const TissueDescription& description);

struct PlacedMesh;
struct BisectedMesh;

/// Const after construction, but for changeMaterials().
class Tissue {
 public:
  /// @param X_WT pose of the tissue frame in the world (tf already looked up).
  /// @throws std::invalid_argument naming the tissue (and region) for: a bad mesh, a model that does not suit the
  /// geometry or differs between regions, a material, damping or fibre direction out of range, a fixed region that
  /// holds no node, a material region that holds no element, an attachment or pressure that would have no effect.
  /// @param on_size called once the mesh is known and before anything is built from it; may throw to refuse it.
  /// @param preparation of a surface that is to be filled.
  Tissue(const TissueDescription& description, const Pose& X_WT, const MeshSizeCheck& on_size = nullptr,
         const MeshPreparation& preparation = {});
  /// The same volume with its mesh refined (src/tissue/placed_mesh.h, refinableMesh()).
  Tissue(const TissueDescription& description, const Pose& X_WT, const BisectedMesh& mesh);

  /// The materials and the damping of another description of it: masses, damping and elasticity are made again, all else stays.
  /// Elastic states of before are of no more use but to Elasticity::makeStateAfter().
  /// @param description differs in numbers of materials and damping alone; passes checkTissue().
  void changeMaterials(const TissueDescription& description);

  const std::string& name() const { return name_; }
  int nodeCount() const { return static_cast<int>(rest_.cols()); }
  const NodalVectors& restPositions() const { return rest_; }                 ///< m, world frame
  const std::vector<Tetrahedron>& tetrahedra() const { return tetrahedra_; }  ///< none for a membrane
  const std::vector<Triangle>& surface() const { return surface_; }           ///< a membrane's triangles, once each

  /// Of all tetrahedra at rest, m; 0: there are none.
  double smallestHeight() const { return smallest_height_; }

  /// Thickness of a membrane, m: it can be touched from both sides, at half of it from its triangles. 0: a volume.
  double thickness() const { return thickness_; }
  /// Per node of a membrane, N/m: what half its thickness t resists with when squeezed over the node's share A of its
  /// area at rest, (lambda + 2 mu) A / (t / 2), of Poisson's ratio .45 at most: it is wide and does not stretch meanwhile. Empty: a volume.
  const VectorX& thicknessStiffness() const { return thickness_stiffness_; }

  /// Per surface triangle: index into TissueDescription::regions (by the triangle's own centroid; in a refined mesh that of the
  /// triangle it is a part of in the mesh that nothing touches), -1 where none.
  /// Empty: the tissue has no regions.
  const std::vector<int>& surfaceRegions() const { return surface_regions_; }
  /// Likewise per element.
  const std::vector<int>& elementRegions() const { return element_regions_; }
  /// Nodes of each connected part of a volume that is far stiffer than most of it, ascending.
  const std::vector<std::vector<int>>& stiffParts() const { return stiff_parts_; }

  /// Per surface triangle: the fibre direction at rest, projected into it, as coefficients over its edges (x1 - x0,
  /// x2 - x0); applied to the deformed edges they give the carried direction, of length 1 at rest. Zero where fibres
  /// run across the triangle or there are none. Empty: the tissue has no fibres.
  const std::vector<Vector2>& surfaceFibres() const { return surface_fibres_; }

  const std::vector<bool>& fixed() const { return fixed_; }
  const VectorX& nodeMasses() const { return masses_; }  ///< kg, lumped: each element's mass in equal parts
  /// Rayleigh damping; stiffness_s is 0 where regions differ in it, the elasticity's state then has a damping matrix.
  const DampingDescription& damping() const { return damping_; }
  const Elasticity& elasticity() const { return *elasticity_; }  ///< with the springs of attachments

  /// Of all springs that attach free nodes, N/m, against a shift of the body; 0: no attachment.
  double attachmentStiffness() const { return attachment_stiffness_; }

  /// Adds the forces of the pressure on the surface as it is at positions x, N: of each triangle a third of p A times
  /// its inward normal to each corner, which is exact for a pressure that is the same all over a flat triangle. On the
  /// whole of a closed surface they have neither a resultant nor a moment. No allocation.
  void addPressure(const NodalVectors& x, NodalVectors& forces) const;

 private:
  Tissue(const TissueDescription& description, PlacedMesh&& placed);

  struct ElasticParts;

  std::string name_;
  NodalVectors rest_;
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<Triangle> surface_;
  std::vector<bool> fixed_;
  VectorX masses_;
  DampingDescription damping_;
  double thickness_ = 0.0, smallest_height_ = 0.0;
  VectorX thickness_stiffness_;
  std::vector<int> surface_regions_, element_regions_;
  std::vector<std::vector<int>> stiff_parts_;
  std::vector<Vector2> surface_fibres_;
  std::shared_ptr<const ElasticParts> parts_;  ///< what else elasticity_ is made from
  std::unique_ptr<const Elasticity> elasticity_;
  double attachment_stiffness_ = 0.0;
  double pressure_ = 0.0;          ///< Pa
  std::vector<Triangle> pressed_;  ///< surface triangles that it acts on; none without a pressure
};

/// Mean length of the edges of the surfaces of `count` tissues at rest, m; 0 without any.
double meanSurfaceEdge(const Tissue* tissues, std::size_t count);

}  // namespace tissue_contact
