/// @file
/// Room `ros`, private: the joint states of a bag. A bag file and a scene's topics in; samples in the order of the recording out.
#pragma once

#include <ros/time.h>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

class BagReader;

/// Times of recording, both included.
struct BagWindow {
  ros::Time from = ros::TIME_MIN;
  ros::Time until = ros::TIME_MAX;
};

/// The file is not trusted: whatever it holds, it is read as it was recorded or refused, in memory that its size and
/// its claims have no say in (limits: bag_reader.h). Refused are all errors of structure, with the file's name; a stamp
/// or a position that makes no sense is the player's to refuse.
class JointStateBag {
 public:
  /// @param file of format 2.0, compressed or not.
  /// @param topics as JointStatePlayer::topics(). A relative name means the same as in a node without a namespace.
  /// @throws std::runtime_error when the bag cannot be read, has a message on none of the topics, or has on one of them
  ///   what is no sensor_msgs/JointState.
  JointStateBag(const std::string& file, const std::vector<std::string>& topics);
  ~JointStateBag();
  JointStateBag(const JointStateBag&) = delete;
  JointStateBag& operator=(const JointStateBag&) = delete;

  const std::set<std::string>& missingTopics() const { return missing_; }  ///< of those asked for
  const ros::Time& begin() const;                                          ///< when the first was recorded
  const ros::Time& end() const;

  /// By time of recording; among equal times as rosbag::View has them. What lies outside the window is not read.
  /// @param take index into the topics, sample, time of recording. What it throws goes through.
  /// @throws std::runtime_error at the first place where the bag is damaged.
  void forEach(const std::function<void(int topic, JointStateSample sample, ros::Time recorded)>& take,
               const BagWindow& window = {}) const;

 private:
  void findTopics();

  std::unique_ptr<BagReader> bag_;
  std::map<std::string, int> index_;  ///< by global name
  std::set<std::string> missing_;
};

/// Why nothing of a bag was played. @param first_refusal empty: none of its joint states was refused.
std::string nothingPlayed(const std::string& file, const std::string& first_refusal);

/// "a, b", or "none".
std::string joinedNames(const std::set<std::string>& names);

}  // namespace tissue_contact
