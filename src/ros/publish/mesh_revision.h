/// @file
/// Room `ros`, private: a tissue's mesh for as long as it stays the same, so that messages of it can be made while the simulator goes on
/// to the next one.
#pragma once

#include <memory>
#include <vector>

#include "ros/publish/publish_options.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// What is published of a mesh beside where its nodes are. Const once made: threads share it.
struct MeshRevision {
  MeshRevision(const Tissue& tissue, int number);

  int revision;                 ///< see Simulator::meshRevision
  NodalVectors rest_positions;  ///< m, world frame
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Triangle> surface;
  std::vector<bool> fixed;  ///< per node

  Eigen::Index nodeCount() const { return rest_positions.cols(); }
};

/// The mesh that is published of one tissue. Not thread-safe; the revisions it gives out are.
class ShownMesh {
 public:
  /// @param tissue for PublishedMesh::kUnrefined as it is before the simulator was first advanced.
  ShownMesh(const Tissue& tissue, int revision, PublishedMesh which);

  /// To be called with the tissue as it is now. Copies its mesh where that has changed since the last call and is what is shown.
  const std::shared_ptr<const MeshRevision>& follow(const Tissue& tissue, int revision);

 private:
  PublishedMesh which_;
  std::shared_ptr<const MeshRevision> now_;
};

}  // namespace tissue_contact
