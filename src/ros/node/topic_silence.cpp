#include "ros/node/topic_silence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

/// Drivers may start after the node.
constexpr double kPatience_s = 10.0;

/// Of a topic on which something has come of late, s.
constexpr double kOfLate_s = 1.5;

std::string secondsText(double seconds) { return std::to_string(static_cast<long>(std::floor(seconds))) + " s"; }

}  // namespace

double longestSilence(double max_gap_s) {
  constexpr double kUsual_s = 2.0;
  return std::max(kUsual_s, max_gap_s);
}

TopicSilence::TopicSilence(std::vector<std::string> topics, std::vector<bool> triggers, double longest_s)
    : topics_(topics.size()), longest_s_(longest_s) {
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    topics_[t].name = std::move(topics[t]);
    topics_[t].triggers = triggers[t];
  }
}

std::vector<std::string> TopicSilence::look(const std::vector<std::optional<double>>& heard_s, double now_s) {
  std::vector<std::string> lines;
  summary_.clear();
  if (!began_s_) began_s_ = now_s;
  const double apart_s = now_s - last_s_.value_or(now_s);
  const bool was_held_up = apart_s > longest_s_ && apart_s > 2.0 * apart_s_;  // what has come may lie unread
  last_s_ = now_s;
  apart_s_ = apart_s;
  for (Topic& topic : topics_) topic.is_silent |= was_held_up;
  noteHeard(heard_s);
  const auto is_heard = [](const Topic& topic) { return topic.heard_s.has_value(); };
  if (!first_s_ && std::any_of(topics_.begin(), topics_.end(), is_heard)) first_s_ = now_s;
  if (was_held_up) return lines;
  const auto comes = [&](const Topic& topic) { return topic.heard_s && now_s - *topic.heard_s <= kOfLate_s; };
  const bool others_come = std::any_of(topics_.begin(), topics_.end(), comes);
  noteSilent(now_s, others_come, lines);
  noteMissing(now_s, others_come, lines);
  return lines;
}

void TopicSilence::noteHeard(const std::vector<std::optional<double>>& heard_s) {
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    Topic& topic = topics_[t];
    if (heard_s[t] == topic.heard_s) continue;
    if (topic.heard_s && !topic.is_silent) {
      constexpr double kIntervals = 3.0;
      topic.longest_s = std::max({topic.longest_s, longest_s_, kIntervals * (*heard_s[t] - *topic.heard_s)});
    }
    topic.is_silent = false;
    topic.heard_s = heard_s[t];
  }
}

void TopicSilence::noteSilent(double now_s, bool others_come, std::vector<std::string>& lines) {
  for (Topic& topic : topics_) {
    if (!(topic.longest_s > 0.0)) continue;
    const double silent_s = now_s - *topic.heard_s;
    topic.is_silent |= silent_s > topic.longest_s;
    if (silent_s <= topic.longest_s) {
      topic.told_of_silence = false;
      continue;
    }
    const std::string line = "no joint state for " + secondsText(silent_s) + " on " + topic.name +
                             (others_come ? ", while others come" : "");
    summary_ += (summary_.empty() ? "" : "; ") + line;
    if (!others_come || std::exchange(topic.told_of_silence, true)) continue;
    lines.push_back(
        line + ": what it moves stays where it was, and its forces go on. Has its driver ended? See `rostopic hz`");
  }
}

void TopicSilence::noteMissing(double now_s, bool others_come, std::vector<std::string>& lines) {
  if (!first_s_) {
    if (now_s - *began_s_ < kPatience_s || std::exchange(told_of_all_, true)) return;
    std::vector<std::string> names;
    for (const Topic& topic : topics_) names.push_back(topic.name);
    lines.push_back("no joint state yet, within " + secondsText(kPatience_s) + ", on " + listOf(names) +
                    ": nothing moves. Does `rostopic info` name a publisher? joint_state_topics of the scene name what "
                    "is listened to");
    return;
  }
  if (!others_come || now_s - *first_s_ < kPatience_s) return;
  for (Topic& topic : topics_) {
    if (topic.heard_s || !topic.triggers || std::exchange(topic.told_of_absence, true)) continue;
    lines.push_back("no joint state yet on " + topic.name +
                    ", while others come: what it moves stays at its initial position, without a wrench. Does "
                    "`rostopic info` name a publisher?");
  }
}

}  // namespace tissue_contact
