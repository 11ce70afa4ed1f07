/// @file
/// Room `ros`, private: messages of the tissues' meshes in the order in which they are to leave. Snapshots in, messages out; knows no
/// publisher.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "ros/publish/scene_snapshot.h"
#include "tissue_contact/TissueMesh.h"
#include "tissue_contact/TissueTopology.h"

namespace tissue_contact {

/// Where the messages go; each is told of which tissue.
struct MeshSink {
  std::function<void(std::size_t, const TissueTopology&)> topology;
  std::function<bool(std::size_t)> wants_mesh;
  std::function<void(std::size_t, const TissueMesh&)> mesh;
};

/// No mesh leaves before the topology of its revision, whatever snapshots come or were dropped.
class MeshMessages {
 public:
  /// @param scene for the names.
  MeshMessages(const Scene& scene, MeshSink sink);

  /// Topologies that have not been told, and the deformed nodes, as far as the snapshot wants them.
  void tell(const SceneSnapshot& snapshot);

 private:
  void tellTopology(const SceneSnapshot& snapshot, std::size_t tissue);

  MeshSink sink_;
  std::vector<TissueMesh> meshes_;  ///< per tissue, kept for their memory
  std::vector<int> told_;           ///< per tissue: revision of the last topology; -1: none
};

}  // namespace tissue_contact
