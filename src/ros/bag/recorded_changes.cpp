#include "ros/bag/recorded_changes.h"

#include <ros/message_traits.h>

#include <algorithm>
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
  bag.forEach([&](const BagMessage& message) {
    try {
      const Changes recorded = readChanges(message.data);
      if (recorded.keys.size() > left) throw BagError("more numbers are changed than are read of a bag");
      left -= recorded.keys.size();
      Change& change = changes_.emplace_back();
      change.loop = recorded.loop;
      change.is_latched = message.recorded <= recording_begins;
      change.stamp_ns = kNanosecondsPerSecond * recorded.header.stamp.sec + recorded.header.stamp.nsec;
      for (std::size_t i = 0; i < recorded.keys.size(); ++i) {
        change.numbers.push_back({recorded.keys[i], recorded.values[i]});
      }
      tuned(scene_, change.numbers);
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
  // What came before the first moment of the recording is there from its start.
  // What came before the first moment of the recording is there from its start.
  const bool is_due =
      played_ns ? std::pair(first_loop_ + loop, *played_ns) >= std::pair(change.loop, change.stamp_ns)
                : next_ns > 0 && (change.is_latched || (change.loop == first_loop_ && change.stamp_ns < next_ns));
  if (!is_due) return std::nullopt;
  if (!played_ns) first_loop_ = change.loop;
  ++taken_;
  return tuned(scene_, change.numbers);
}

}  // namespace tissue_contact
