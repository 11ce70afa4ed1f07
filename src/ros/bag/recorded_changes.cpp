#include "ros/bag/recorded_changes.h"

#include <ros/message_traits.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "ros/bag/bag_reader.h"
#include "ros/bag/joint_state_bag.h"
#include "ros/bag/message_reader.h"
#include "tissue_contact/Changes.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

/// After the first joint state: by then a recorder has the latched message, by a connection of its own.
const ros::Duration kLatchedWithin(2.0);

/// In all changes of a bag: a slider that was moved for an hour, of a scene with a hundred numbers.
constexpr std::size_t kMostNumbers = 10'000'000;

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

Changes readChanges(std::string_view data) {
  MessageReader reader(data);
  Changes message;
  message.header = reader.header();
  message.loop = reader.number<std::uint32_t>();
  message.keys.resize(reader.count(sizeof(std::uint32_t)));
  for (std::string& key : message.keys) key = reader.text();
  message.values.resize(reader.count(sizeof(double)));
  for (double& value : message.values) value = reader.number<double>();
  if (message.keys.size() != message.values.size()) {
    throw BagError(std::to_string(message.keys.size()) + " keys with " + std::to_string(message.values.size()) +
                   " values");
  }
  return message;
}

bool areSame(const std::vector<TunedNumber>& a, const std::vector<TunedNumber>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const TunedNumber& one, const TunedNumber& other) {
    return one.key == other.key && one.value == other.value;
  });
}

bool hasChanges(const BagConnection& connection) { return connection.md5sum == ros::message_traits::md5sum<Changes>(); }

/// Chooses the messages of one topic.
void selectTopic(const std::string& topic, BagReader& bag) {
  bag.select([&](const BagConnection& connection) {
    return hasChanges(connection) && (topic.empty() || globalName(connection.topic) == globalName(topic));
  });
  std::set<std::string> found;
  for (const auto& [number, connection] : bag.connections()) {
    if (hasChanges(connection) && bag.messageCount(number) > 0) found.insert(globalName(connection.topic));
  }
  if (!topic.empty() && found.empty()) {
    bag.fail("it has no tissue_contact/Changes on the topic " + printable(topic) + " of --changes");
  }
  if (found.size() > 1) {
    bag.fail("several of its topics have changes of a scene's numbers: " + joinedNames(found) +
             "; name that of this scene's node by --changes TOPIC, or give --changes none");
  }
}

/// Whether a joint-state topic of the scene begins again in what was recorded by then.
bool beginsAgain(const std::string& file, const Scene& scene, ros::Time by) {
  const ros::Duration least(0.05);  // stamps that are late go back by less
  std::set<std::string> topics;
  for (const InstrumentDescription& instrument : scene.instruments) {
    for (const JointStateTopic& topic : instrument.joint_state_topics) topics.insert(globalName(topic.name));
  }
  BagReader bag(file);
  bag.select([&](const BagConnection& connection) { return topics.count(globalName(connection.topic)) > 0; });
  std::map<std::string, ros::Time> newest;
  bool begins_again = false;
  bag.forEach([&](const BagMessage& message) {
    if (message.recorded > by) return false;
    try {
      const ros::Time stamp = MessageReader(message.data).header().stamp;
      ros::Time& before = newest[globalName(message.connection.topic)];
      begins_again |= stamp + least < before;
      before = stamp;
    } catch (const BagError&) {  // for whoever plays it to tell
    }
    return !begins_again;
  });
  return begins_again;
}

}  // namespace

RecordedChanges::RecordedChanges(const std::string& file, const std::string& topic, const Scene& scene,
                                 ros::Time recording_begins)
    : scene_(scene) {
  BagReader bag(file);
  const auto& all = bag.connections();
  const auto has_changes = [](const auto& numbered) { return hasChanges(numbered.second); };
  if (topic.empty() && std::none_of(all.begin(), all.end(), has_changes)) return;  // most bags: no index need be read
  selectTopic(topic, bag);
  std::size_t left = kMostNumbers;
  std::vector<TunedNumber> before;
  bool is_first = true;
  bag.forEach([&](const BagMessage& message) {
    try {
      const Changes recorded = readChanges(message.data);
      if (recorded.keys.size() > left) throw BagError("more numbers are changed than are read of a bag");
      left -= recorded.keys.size();
      Change change;
      change.loop = recorded.loop;
      change.is_latched = message.recorded <= recording_begins;
      const bool is_soon = is_first && message.recorded <= recording_begins + kLatchedWithin;
      if (change.is_latched || (is_soon && change.loop > 0 && !beginsAgain(file, scene_, message.recorded))) {
        first_loop_ = change.loop;
      }
      is_first = false;
      change.stamp_ns = kNanosecondsPerSecond * recorded.header.stamp.sec + recorded.header.stamp.nsec;
      for (std::size_t i = 0; i < recorded.keys.size(); ++i) {
        change.numbers.push_back({recorded.keys[i], recorded.values[i]});
      }
      tuned(scene_, change.numbers);
      if (areSame(change.numbers, before)) return true;  // said again at the beginning of a loop
      before = change.numbers;
      changes_.push_back(std::move(change));
    } catch (const BagError& error) {
      bag.fail(message, error);
    } catch (const std::invalid_argument& error) {
      bag.fail(message,
               BagError(std::string(error.what()) + "; give the scene that the node ran with, or --changes none",
                        BagError::Remedy::kAsSaid));
    }
    return true;
  });
}

std::optional<Scene> RecordedChanges::takeDue(std::int64_t loop, const std::optional<std::int64_t>& played_ns,
                                              std::int64_t next_ns) {
  if (taken_ == changes_.size()) return std::nullopt;
  const Change& change = changes_[taken_];
  const std::int64_t at_loop = first_loop_ + loop;
  bool is_due = false;
  if (!played_ns) {  // what came before the first moment of the recording is there from its start
    is_due = next_ns > 0 && (change.is_latched || (change.loop == at_loop && change.stamp_ns < next_ns));
  } else if (at_loop == change.loop) {  // the moment that comes lies before it: after one stray stamp far ahead
    is_due = *played_ns == change.stamp_ns || (*played_ns > change.stamp_ns && next_ns > change.stamp_ns);
  } else {
    is_due = at_loop > change.loop;
  }
  if (!is_due) return std::nullopt;
  ++taken_;
  return tuned(scene_, change.numbers);
}

}  // namespace tissue_contact
