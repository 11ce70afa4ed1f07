#include "ros/replay/bag_recorder.h"

#include <ros/message_traits.h>
#include <rosbag/bag.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "ros/conversions.h"
#include "ros/publish/instrument_messages.h"

namespace tissue_contact {
namespace {

constexpr const char* kNode = "/tissue_contact";

std::string topicOf(const std::string& name) { return std::string(kNode) + "/" + name; }

/// Of a connection on which a player is to latch.
boost::shared_ptr<ros::M_string> latchedTopologies() {
  namespace traits = ros::message_traits;
  return boost::make_shared<ros::M_string>(ros::M_string{{"callerid", kNode},
                                                         {"latching", "1"},
                                                         {"md5sum", traits::md5sum<TissueTopology>()},
                                                         {"message_definition", traits::definition<TissueTopology>()},
                                                         {"type", traits::datatype<TissueTopology>()}});
}

}  // namespace

BagRecorder::BagRecorder(const std::string& file, const Simulator& simulator, const JointStatePlayer& player,
                         const PublishOptions& options)
    : simulator_(simulator),
      player_(player),
      options_(options),
      name_(file),
      file_(file),
      bag_(std::make_unique<rosbag::Bag>()),
      taker_(simulator, player, options, PublishedMesh::kRefined),
      messages_(simulator, MarkerStyle(), options.markers_rate_hz > 0.0, sink()),
      frames_(frameNames(simulator)),
      wrenches_(wrenchMessages(simulator, frames_)),
      latched_(latchedTopologies()) {
  checkNames(simulator);
  guarded([this] { bag_->open(file_.path(), rosbag::bagmode::Write); });
}

BagRecorder::~BagRecorder() {
  try {
    if (bag_) guarded([this] { bag_->close(); });
  } catch (const std::runtime_error&) {  // the run has failed already; guarded() has let go of the bag
    written_ = 0;
  }
}

/// rosbag's errors as those of other results.
template <typename Work>
void BagRecorder::guarded(const Work& work) {
  errno = 0;
  try {
    work();
  } catch (const rosbag::BagException& error) {
    const std::string reason = errno != 0 ? std::generic_category().message(errno) : error.what();
    // Its destructor would try to write again, throw, and so end the process; what it holds goes with that anyway.
    static_cast<void>(bag_.release());
    throw WriteError("cannot write '" + name_ + "': " + reason);
  }
}

template <typename Message>
void BagRecorder::write(const std::string& topic, const Message& message, const Header& header) {
  guarded([&] { bag_->write(topic, recorded_, message, header); });
  ++written_;
}

MessageSink BagRecorder::sink() {
  const auto tissue = [this](std::size_t t) { return simulator_.scene().tissues[t].name; };
  MessageSink sink;
  sink.meshes.topology = [this, tissue](std::size_t t, const TissueTopology& message) {
    write(topicOf(tissue(t) + "/topology"), message, latched_);
  };
  sink.meshes.wants_mesh = [](std::size_t) { return true; };
  sink.meshes.mesh = [this, tissue](std::size_t t, const TissueMesh& message) {
    write(topicOf(tissue(t) + "/mesh"), message);
  };
  sink.contacts = [this](const ContactArray& message) { write(topicOf("contacts"), message); };
  sink.status = [this](const Status& message) { write(topicOf("status"), message); };
  sink.markers = [this](const visualization_msgs::MarkerArray& message) { write(topicOf("markers"), message); };
  return sink;
}

void BagRecorder::record(const PlayedSample& played, int steps, ros::Time recorded) {
  recorded_ = recorded;
  for (const int i : played.instruments) {
    auto& wrench = wrenches_[static_cast<std::size_t>(i)];
    fillWrench(simulator_.wrench(i), played.stamp_ns, wrench);
    const std::string& name = simulator_.instruments()[static_cast<std::size_t>(i)].name();
    write(topicOf(name + "/wrench"), wrench);
    if (!options_.crtk) continue;
    fillCrtk(simulator_, frames_, i, played.stamp_ns, crtk_);
    write(topicOf(name + "/body/measured_cf"), crtk_.body);
    write(topicOf(name + "/spatial/measured_cf"), crtk_.spatial);
  }
  const BulkyTopics due = taker_.due(played, {});
  if (due.any()) {
    const auto complete = [this](Status& status) {
      status.joint_states_waiting = static_cast<std::uint64_t>(player_.waiting());
      status.joint_states_received = status.joint_states_waiting + status.joint_states_accepted +
                                     status.joint_states_merged + status.joint_states_refused;
    };
    taker_.take(played, due, steps, complete, snapshot_);
    messages_.tell(snapshot_);
  }
  if (options_.tf && played.stamp_ns != last_stamp_ns_) {
    fillTransforms(simulator_, frames_, played.stamp_ns, transforms_);
    write("/tf", transforms_);
  }
  last_stamp_ns_ = played.stamp_ns;
}

void BagRecorder::finish() {
  guarded([this] { bag_->close(); });
}

bool BagRecorder::commitPartial() {
  if (!bag_ || written_ == 0) return false;
  finish();
  file_.commitPartial();
  return true;
}

}  // namespace tissue_contact
