#include "ros/publish/snapshot_taker.h"

#include <utility>

#include "ros/conversions.h"

namespace tissue_contact {

SnapshotTaker::SnapshotTaker(const Simulator& simulator, const JointStatePlayer& player, const PublishOptions& options,
                             PublishedMesh mesh)
    : simulator_(simulator),
      player_(player),
      meshes_(shownMeshes(simulator, mesh)),
      told_revisions_(meshes_.size(), -1),
      shows_meshes_(options.mesh_rate_hz > 0.0),
      rates_(options),
      mesh_rate_(options.mesh_rate_hz),
      contacts_rate_(options.contacts_rate_hz),
      status_rate_(options.status_rate_hz),
      markers_rate_(options.markers_rate_hz) {}

void SnapshotTaker::setRates(const PublishOptions& rates) {
  const auto set = [](double from, double& to, MessageTimeRate& rate) {
    if (std::exchange(to, from) != from) rate = MessageTimeRate(from);
  };
  set(rates.mesh_rate_hz, rates_.mesh_rate_hz, mesh_rate_);
  set(rates.contacts_rate_hz, rates_.contacts_rate_hz, contacts_rate_);
  set(rates.status_rate_hz, rates_.status_rate_hz, status_rate_);
  set(rates.markers_rate_hz, rates_.markers_rate_hz, markers_rate_);
}

void SnapshotTaker::beginAnew() {
  for (MessageTimeRate* rate : {&mesh_rate_, &contacts_rate_, &status_rate_, &markers_rate_}) rate->reset();
}

BulkyTopics SnapshotTaker::due(const PlayedSample& played, const BulkyTopics& wanted) {
  if (played.was_reset || played.was_resumed) beginAnew();  // time goes back
  const std::int64_t stamp_ns = played.stamp_ns;
  const bool mesh_is_due = mesh_rate_.due(stamp_ns);
  BulkyTopics due;
  // Of meshes that nobody is shown none needs a topology; where none is shown at all, the newest is told as soon as it is there.
  due.topologies = (mesh_is_due || !shows_meshes_) && topologiesChange();
  due.mesh = mesh_is_due && wanted.mesh;
  due.contacts = contacts_rate_.due(stamp_ns) && wanted.contacts;
  due.status = status_rate_.due(stamp_ns) && wanted.status && isFinite(simulator_.residuals());
  due.markers = markers_rate_.due(stamp_ns) && wanted.markers;
  return due;
}

void SnapshotTaker::take(const PlayedSample& played, const BulkyTopics& due, int steps,
                         const std::function<void(Status&)>& complete, SceneSnapshot& snapshot) {
  snapshot.topologies = due.topologies;
  snapshot.mesh = due.mesh;
  snapshot.contact_array = due.contacts;
  snapshot.with_status = due.status;
  snapshot.markers = due.markers;
  takeSnapshot(simulator_, meshes_, played.stamp_ns, snapshot);
  if (!due.status) return;
  Status& status = snapshot.status;
  status.header.frame_id = simulator_.scene().world_frame;
  fillStatus(simulator_, player_, played.stamp_ns, status);
  if (steps == 0) status.discarded = status.jumped = 0;  // told with the interval before
  status.substeps = static_cast<std::uint32_t>(steps);
  complete(status);
}

void SnapshotTaker::takeMarkers(std::int64_t stamp_ns, SceneSnapshot& snapshot) {
  snapshot.markers = true;
  takeSnapshot(simulator_, meshes_, stamp_ns, snapshot);
}

/// Whether the mesh of a tissue is another than when last asked.
bool SnapshotTaker::topologiesChange() {
  bool change = false;
  for (std::size_t t = 0; t < meshes_.size(); ++t) {
    const int revision =
        meshes_[t].follow(simulator_.tissues()[t], simulator_.meshRevision(static_cast<int>(t)))->revision;
    change |= std::exchange(told_revisions_[t], revision) != revision;
  }
  return change;
}

}  // namespace tissue_contact
