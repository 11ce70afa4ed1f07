#include "ros/bag/joint_state_bag.h"

#include <ros/message_traits.h>
#include <sensor_msgs/JointState.h>

#include <stdexcept>
#include <vector>

#include "ros/bag/bag_reader.h"
#include "ros/bag/message_reader.h"
#include "ros/conversions.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

using sensor_msgs::JointState;

/// Efforts, which no sample has, are only passed over.
JointState readJointState(std::string_view data) {
  MessageReader reader(data);
  JointState message;
  message.header = reader.header();
  message.name.resize(reader.count(sizeof(std::uint32_t)));
  for (std::string& name : message.name) name = reader.text();
  for (std::vector<double>* values : {&message.position, &message.velocity}) {
    values->resize(reader.count(sizeof(double)));
    for (double& value : *values) value = reader.number<double>();
  }
  reader.take(reader.count(sizeof(double)) * sizeof(double));
  return message;
}

/// The sum alone, as rosbag does it: a type that was renamed is the same.
void requireJointStates(const BagReader& bag, const BagConnection& connection) {
  const std::string md5sum = ros::message_traits::md5sum<JointState>();
  if (connection.md5sum == md5sum) return;
  const std::string type = ros::message_traits::datatype<JointState>();
  if (connection.type == type) {
    bag.fail("topic " + printable(connection.topic) + " is of a " + type + " with another definition (md5sum " +
             printable(connection.md5sum, md5sum.size()) + ", not " + md5sum + ")");
  }
  bag.fail("topic " + printable(connection.topic) + " is of type " + printable(connection.type) + "; it must be " +
           type);
}

}  // namespace

std::string nothingPlayed(const std::string& file, const std::string& first_refusal) {
  if (!first_refusal.empty()) {
    return "no joint state of bag '" + file + "' was accepted; the first was refused: " + first_refusal;
  }
  return "no joint state of bag '" + file +
         "' was played: those that are played only update joints at the moments of other topics, of which there are "
         "none; give a topic "
         "'triggers: true' in the scene's joint_state_topics, or record the others too";
}

std::string joinedNames(const std::set<std::string>& names) {
  constexpr std::size_t kMost = 100;  // robots record some fifty topics
  return names.empty() ? "none" : listOf({names.begin(), names.end()}, kMost);
}

JointStateBag::JointStateBag(const std::string& file, const std::vector<std::string>& topics)
    : bag_(std::make_unique<BagReader>(file)) {
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const auto [other, is_new] = index_.emplace(globalName(topics[i]), static_cast<int>(i));
    if (is_new) continue;
    bag_->fail("the scene's topics " + printable(topics[static_cast<std::size_t>(other->second)]) + " and " +
               printable(topics[i]) + " are one in a bag; spell them alike");
  }
  bag_->select([this](const BagConnection& connection) { return index_.count(globalName(connection.topic)) > 0; });
  findTopics();
}

JointStateBag::~JointStateBag() = default;

const ros::Time& JointStateBag::begin() const { return bag_->begin(); }

const ros::Time& JointStateBag::end() const { return bag_->end(); }

void JointStateBag::findTopics() {
  std::set<std::string> in_bag;
  for (const auto& [topic, index] : index_) missing_.insert(topic);
  for (const auto& [number, connection] : bag_->connections()) {
    in_bag.insert(connection.topic);
    if (bag_->messageCount(number) == 0) continue;
    requireJointStates(*bag_, connection);
    missing_.erase(globalName(connection.topic));
  }
  if (missing_.size() == index_.size()) {
    bag_->fail("it has no message on the scene's joint-state topics (" + joinedNames(missing_) +
               "); its topics are: " + joinedNames(in_bag));
  }
}

void JointStateBag::forEach(const std::function<void(int topic, JointStateSample sample, ros::Time recorded)>& take,
                            const BagWindow& window) const {
  bag_->forEach([&](const BagMessage& message) {
    if (message.recorded < window.from) return true;
    if (message.recorded > window.until) return false;
    const std::string& topic = message.connection.topic;
    JointState state;
    try {
      state = readJointState(message.data);
    } catch (const BagError& error) {
      bag_->fail(message, error);
    }
    take(index_.at(globalName(topic)), toSample(state), message.recorded);
    return true;
  });
}

}  // namespace tissue_contact
