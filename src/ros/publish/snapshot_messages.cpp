#include "ros/publish/snapshot_messages.h"

#include <utility>

#include "ros/conversions.h"

namespace tissue_contact {

SnapshotMessages::SnapshotMessages(const Simulator& simulator, const MarkerStyle& style, bool with_markers,
                                   MessageSink sink)
    : simulator_(simulator),
      sink_(std::move(sink)),
      scene_markers_(simulator, style, with_markers),
      mesh_messages_(simulator.scene(), sink_.meshes) {
  contacts_.header.frame_id = simulator.scene().world_frame;
}

void SnapshotMessages::tell(const SceneSnapshot& snapshot) {
  if (snapshot.with_status) sink_.status(snapshot.status);
  if (snapshot.contact_array) {
    fillContacts(simulator_, snapshot, contacts_);
    sink_.contacts(contacts_);
  }
  mesh_messages_.tell(snapshot);
  if (snapshot.markers) sink_.markers(scene_markers_.update(snapshot));
}

}  // namespace tissue_contact
