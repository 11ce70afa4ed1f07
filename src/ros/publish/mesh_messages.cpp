#include "ros/publish/mesh_messages.h"

#include <utility>

#include "ros/conversions.h"

namespace tissue_contact {

MeshMessages::MeshMessages(const Scene& scene, MeshSink sink)
    : sink_(std::move(sink)), told_(scene.tissues.size(), -1) {
  for (const TissueDescription& tissue : scene.tissues) {
    meshes_.emplace_back();
    meshes_.back().header.frame_id = scene.world_frame;
    meshes_.back().tissue = tissue.name;
  }
}

void MeshMessages::tell(const SceneSnapshot& snapshot) {
  if (!snapshot.topologies && !snapshot.mesh) return;
  for (std::size_t t = 0; t < meshes_.size(); ++t) {
    tellTopology(snapshot, t);
    if (!snapshot.mesh || !sink_.wants_mesh(t)) continue;
    fillMesh(snapshot, static_cast<int>(t), meshes_[t]);
    sink_.mesh(t, meshes_[t]);
  }
}

void MeshMessages::tellTopology(const SceneSnapshot& snapshot, std::size_t tissue) {
  const MeshRevision& mesh = *snapshot.revisions[tissue];
  if (mesh.revision == told_[tissue]) return;
  TissueTopology message;  // not kept: it is as large as the mesh, and seldom needed
  message.header.stamp = toTime(snapshot.stamp_ns);
  message.header.frame_id = meshes_[tissue].header.frame_id;
  message.tissue = meshes_[tissue].tissue;
  fillTopology(mesh, message);
  sink_.topology(tissue, message);
  told_[tissue] = mesh.revision;
}

}  // namespace tissue_contact
