/// @file
/// Room `ros`, private: the bulky topics, made and published by a thread of their own while the simulator steps on.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "ros/publish/publish_options.h"
#include "ros/publish/scene_snapshot.h"
#include "ros/publish/snapshot_messages.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Topics <tissue>/topology (latched), and <tissue>/mesh, contacts, status and markers, each where its rate is not 0.
class SnapshotPublisher {
 public:
  /// Advertises nothing yet.
  /// @param simulator must outlive this; only what never changes is read of it.
  SnapshotPublisher(const Simulator& simulator, const PublishOptions& options, const MarkerStyle& style);
  ~SnapshotPublisher();
  SnapshotPublisher(const SnapshotPublisher&) = delete;
  SnapshotPublisher& operator=(const SnapshotPublisher&) = delete;

  /// Advertises below `private_node` and starts the thread.
  /// @param on_newcomer called, from roscpp's threads, when somebody subscribes to the markers; takeNewcomer() is true
  ///   then.
  void start(ros::NodeHandle private_node, std::function<void()> on_newcomer);

  // Whether anybody listens: what nobody subscribes to need not be put into a snapshot.
  bool meshIsWanted() const;
  bool contactsAreWanted() const { return contacts_publisher_.getNumSubscribers() > 0; }
  bool statusIsWanted() const { return status_publisher_.getNumSubscribers() > 0; }
  bool markersAreWanted() const { return markers_publisher_.getNumSubscribers() > 0; }
  /// Whether a subscriber of the markers came since the last call, who should not see nothing until time goes on.
  bool takeNewcomer() { return newcomer_.exchange(false); }

  SnapshotQueue& queue() { return queue_; }

 private:
  MessageSink sink();
  void run();

  const Simulator& simulator_;
  const PublishOptions options_;
  SnapshotQueue queue_;
  std::atomic<bool> newcomer_{false};
  std::vector<ros::Publisher> topology_publishers_;  ///< one per tissue
  std::vector<ros::Publisher> mesh_publishers_;      ///< one per tissue; empty: not advertised
  ros::Publisher contacts_publisher_;
  ros::Publisher status_publisher_;
  ros::Publisher markers_publisher_;

  SnapshotMessages messages_;  ///< the publishing thread's alone

  std::thread thread_;
};

}  // namespace tissue_contact
