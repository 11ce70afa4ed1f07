/// @file
/// Room `ros`: see joint_state_bag.h.
#include "tissue_contact/ros/joint_state_bag.h"

#include <rosbag/view.h>
#include <sensor_msgs/JointState.h>

#include <exception>
#include <stdexcept>

#include "tissue_contact/ros/conversions.h"

namespace tissue_contact {
namespace {

std::string globalName(const std::string& topic) { return !topic.empty() && topic[0] == '/' ? topic : "/" + topic; }

}  // namespace

std::string joinedNames(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

JointStateBag::JointStateBag(const std::string& file, const std::vector<std::string>& topics) : file_(file) {
  for (std::size_t i = 0; i < topics.size(); ++i) index_[globalName(topics[i])] = static_cast<int>(i);
  try {
    bag_.open(file, rosbag::bagmode::Read);
  } catch (const std::exception& error) {
    throw std::runtime_error("bag '" + file + "' cannot be read: " + error.what() +
                             "; if it was cut off, `rosbag reindex` may mend it");
  }
  findTopics();
  rosbag::View view(bag_, rosbag::TopicQuery(found_));
  begin_ = view.getBeginTime();
  end_ = view.getEndTime();
}

void JointStateBag::findTopics() {
  std::set<std::string> in_bag;
  for (const auto& [topic, index] : index_) missing_.insert(topic);
  rosbag::View view(bag_);
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    if (!in_bag.insert(connection->topic).second || index_.count(globalName(connection->topic)) == 0) continue;
    found_.push_back(connection->topic);
    missing_.erase(globalName(connection->topic));
  }
  if (found_.empty()) {
    throw std::runtime_error("bag '" + file_ + "' has no message on the scene's joint-state topics (" +
                             joinedNames(missing_) + "); its topics are: " + joinedNames(in_bag));
  }
}

void JointStateBag::forEach(
    const std::function<void(int topic, JointStateSample sample, ros::Time recorded)>& take) const {
  rosbag::View view(bag_, rosbag::TopicQuery(found_));
  for (const rosbag::MessageInstance& instance : view) {
    const sensor_msgs::JointStateConstPtr message = instance.instantiate<sensor_msgs::JointState>();
    if (!message) {
      throw std::runtime_error("topic " + instance.getTopic() + " of bag '" + file_ + "' is of type " +
                               instance.getDataType() + "; it must be sensor_msgs/JointState");
    }
    take(index_.at(globalName(instance.getTopic())), toSample(*message), instance.getTime());
  }
}

}  // namespace tissue_contact
