/// @file
/// Room `ros`, private: messages of the bulky topics. Snapshots in, messages out, to whoever publishes or records them.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <functional>

#include "ros/publish/mesh_messages.h"
#include "ros/publish/scene_markers.h"
#include "ros/publish/scene_snapshot.h"
#include "tissue_contact/ContactArray.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Where the messages go.
struct MessageSink {
  MeshSink meshes;
  std::function<void(const ContactArray&)> contacts;
  std::function<void(const Status&)> status;
  std::function<void(const visualization_msgs::MarkerArray&)> markers;
};

class SnapshotMessages {
 public:
  /// @param simulator must outlive this; only what never changes is read of it.
  /// @param with_markers whether snapshots may want markers.
  SnapshotMessages(const Simulator& simulator, const MarkerStyle& style, bool with_markers, MessageSink sink);

  /// Tells what the snapshot wants told.
  void tell(const SceneSnapshot& snapshot);

 private:
  const Simulator& simulator_;
  MessageSink sink_;
  SceneMarkers scene_markers_;
  MeshMessages mesh_messages_;
  ContactArray contacts_;
};

}  // namespace tissue_contact
