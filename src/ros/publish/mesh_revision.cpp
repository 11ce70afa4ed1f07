#include "ros/publish/mesh_revision.h"

namespace tissue_contact {

MeshRevision::MeshRevision(const Tissue& tissue, int number)
    : revision(number),
      rest_positions(tissue.restPositions()),
      tetrahedra(tissue.tetrahedra()),
      surface(tissue.surface()),
      fixed(tissue.fixed()) {}

ShownMesh::ShownMesh(const Tissue& tissue, int revision, PublishedMesh which)
    : which_(which), now_(std::make_shared<MeshRevision>(tissue, revision)) {}

const std::shared_ptr<const MeshRevision>& ShownMesh::follow(const Tissue& tissue, int revision) {
  if (which_ == PublishedMesh::kRefined && revision != now_->revision) {
    now_ = std::make_shared<MeshRevision>(tissue, revision);
  }
  return now_;
}

}  // namespace tissue_contact
