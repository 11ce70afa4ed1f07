#include "ros/publish/snapshot_publisher.h"

#include <algorithm>
#include <utility>

namespace tissue_contact {
namespace {

/// Per subscriber, in roscpp: they are samples of a state, so who stalls wants the newest.
constexpr int kStateQueue = 10;

/// Between the threads: a second of markers or so, for a machine that is busy for that long.
constexpr std::size_t kMostSnapshots = 32;

}  // namespace

SnapshotPublisher::SnapshotPublisher(const Simulator& simulator, const PublishOptions& options,
                                     const MarkerStyle& style)
    : simulator_(simulator),
      options_(options),
      queue_(kMostSnapshots),
      messages_(simulator, style, options.markers_rate_hz > 0.0, sink()) {}

SnapshotPublisher::~SnapshotPublisher() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

MessageSink SnapshotPublisher::sink() {
  MessageSink sink;
  sink.meshes.topology = [this](std::size_t t, const TissueTopology& message) {
    topology_publishers_[t].publish(message);
  };
  sink.meshes.wants_mesh = [this](std::size_t t) {
    return t < mesh_publishers_.size() && mesh_publishers_[t].getNumSubscribers() > 0;
  };
  sink.meshes.mesh = [this](std::size_t t, const TissueMesh& message) { mesh_publishers_[t].publish(message); };
  sink.contacts = [this](const ContactArray& message) { contacts_publisher_.publish(message); };
  sink.status = [this](const Status& message) { status_publisher_.publish(message); };
  sink.markers = [this](const visualization_msgs::MarkerArray& message) { markers_publisher_.publish(message); };
  return sink;
}

void SnapshotPublisher::start(ros::NodeHandle private_node, std::function<void()> on_newcomer) {
  for (const TissueDescription& tissue : simulator_.scene().tissues) {
    topology_publishers_.push_back(
        private_node.advertise<TissueTopology>(tissue.name + "/topology", kStateQueue, true));
    if (!(options_.mesh_rate_hz > 0.0)) continue;
    mesh_publishers_.push_back(private_node.advertise<TissueMesh>(tissue.name + "/mesh", kStateQueue));
  }
  if (options_.contacts_rate_hz > 0.0) {
    contacts_publisher_ = private_node.advertise<ContactArray>("contacts", kStateQueue);
  }
  if (options_.status_rate_hz > 0.0) status_publisher_ = private_node.advertise<Status>("status", kStateQueue);
  if (options_.markers_rate_hz > 0.0) {
    const auto note_newcomer = [this, tell = std::move(on_newcomer)](const ros::SingleSubscriberPublisher&) {
      newcomer_ = true;
      tell();
    };
    markers_publisher_ = private_node.advertise<visualization_msgs::MarkerArray>("markers", kStateQueue, note_newcomer);
  }
  thread_ = std::thread([this] { run(); });
}

bool SnapshotPublisher::meshIsWanted() const {
  return std::any_of(mesh_publishers_.begin(), mesh_publishers_.end(),
                     [](const ros::Publisher& publisher) { return publisher.getNumSubscribers() > 0; });
}

void SnapshotPublisher::run() {
  while (std::unique_ptr<SceneSnapshot> snapshot = queue_.take()) {
    messages_.tell(*snapshot);
    queue_.recycle(std::move(snapshot));
  }
}

}  // namespace tissue_contact
