/// @file
/// Room `ros/replay`, private: the bag that a replay writes. A simulator that was just advanced in; the node's messages in a file out.
#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <ros/time.h>
#include <tf2_msgs/TFMessage.h>

#include <boost/shared_ptr.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ros/publish/instrument_messages.h"
#include "ros/publish/publish_options.h"
#include "ros/publish/snapshot_messages.h"
#include "ros/publish/snapshot_taker.h"
#include "tissue_contact/core/whole_file.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace rosbag {
class Bag;
}

namespace tissue_contact {

/// The messages that a node called /tissue_contact publishes when every topic has a subscriber, /diagnostics aside; what only a clock
/// tells (Status: step_time, lag, real_time_factor) is 0. So the same bytes every time. Topologies are latched.
///
/// Times of recording are those of the joint states that were played last, as those of a node would be whose steps take no time: the
/// bag is in step with the one that was played, and they can be played together.
class BagRecorder {
 public:
  /// @param simulator not advanced yet; it and the player must outlive this.
  /// @throws std::invalid_argument for a file that is no place for a result, and names that are none for topics.
  BagRecorder(const std::string& file, const Simulator& simulator, const JointStatePlayer& player,
              const PublishOptions& options);
  ~BagRecorder();
  BagRecorder(const BagRecorder&) = delete;
  BagRecorder& operator=(const BagRecorder&) = delete;

  /// Writes what an accepted moment owes.
  /// @param steps implicit steps taken to it.
  /// @param recorded when the joint state was that made it, > 0.
  /// @throws std::runtime_error naming the file and the reason.
  void record(const PlayedSample& played, int steps, ros::Time recorded);

  /// Writes the index, so that of several results none takes its place when one does not fit on the disk.
  /// @throws as record().
  void finish();
  /// Where the bag is until it takes the target's place.
  std::string path() const { return file_.path(); }
  /// Finished, takes the target's place.
  void commit() { file_.commit(); }
  /// Finished or not, takes the place that says "partial", if any message was recorded.
  /// @return whether it did.
  /// @throws as record().
  bool commitPartial();

 private:
  using Header = boost::shared_ptr<std::map<std::string, std::string>>;

  MessageSink sink();
  template <typename Message>
  void write(const std::string& topic, const Message& message, const Header& header = {});
  template <typename Work>
  void guarded(const Work& work);

  const Simulator& simulator_;
  const JointStatePlayer& player_;
  const PublishOptions options_;
  const std::string name_;
  WholeFile file_;
  std::unique_ptr<rosbag::Bag> bag_;
  SnapshotTaker taker_;
  SnapshotMessages messages_;
  SceneSnapshot snapshot_;
  const FrameNames frames_;
  std::vector<geometry_msgs::WrenchStamped> wrenches_;
  CrtkMessages crtk_;
  tf2_msgs::TFMessage transforms_;
  Header latched_;
  ros::Time recorded_;
  std::int64_t last_stamp_ns_ = 0;
  std::int64_t written_ = 0;  ///< messages
};

}  // namespace tissue_contact
