/// @file
/// Room `ros`: the joint states of a bag. A bag file and a scene's topics in; samples in the order of the recording out.
#pragma once

#include <ros/time.h>
#include <rosbag/bag.h>

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

class JointStateBag {
 public:
  /// @param topics as JointStatePlayer::topics(). A relative name means the same as in a node without a namespace.
  /// @throws std::runtime_error when the bag cannot be read or has a message on none of the topics.
  JointStateBag(const std::string& file, const std::vector<std::string>& topics);

  const std::set<std::string>& missingTopics() const { return missing_; }  ///< of those asked for
  const ros::Time& begin() const { return begin_; }                        ///< when the first was recorded
  const ros::Time& end() const { return end_; }

  /// @param take index into the topics, sample, time of recording.
  /// @throws std::runtime_error for a message that is no sensor_msgs/JointState.
  void forEach(const std::function<void(int topic, JointStateSample sample, ros::Time recorded)>& take) const;

 private:
  void findTopics();

  std::string file_;
  rosbag::Bag bag_;
  std::map<std::string, int> index_;  ///< by global name
  std::vector<std::string> found_;    ///< as the bag spells them
  std::set<std::string> missing_;
  ros::Time begin_, end_;
};

/// "a, b", or "none".
std::string joinedNames(const std::set<std::string>& names);

}  // namespace tissue_contact
