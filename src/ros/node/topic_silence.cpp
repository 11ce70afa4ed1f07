#include "ros/node/topic_silence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

/// Drivers may start after the node.
constexpr double kPatience_s = 10.0;

std::string secondsText(double seconds) { return std::to_string(static_cast<long>(std::floor(seconds))) + " s"; }

}  // namespace

TopicSilence::TopicSilence(std::vector<std::string> topics, std::vector<bool> triggers, double longest_s)
    : topics_(std::move(topics)), triggers_(std::move(triggers)), longest_s_(longest_s), told_(topics_.size(), false) {}

std::vector<std::string> TopicSilence::look(const std::vector<std::optional<double>>& heard_s, double now_s) {
  std::vector<std::string> lines;
  if (!began_s_) began_s_ = now_s;
  summary_.clear();
  const auto is_silent = [&](std::size_t t) { return heard_s[t] && now_s - *heard_s[t] > longest_s_; };
  bool others_come = false;
  for (std::size_t t = 0; t < topics_.size(); ++t) others_come |= heard_s[t] && !is_silent(t);
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    if (!heard_s[t]) continue;
    if (!is_silent(t)) {
      told_[t] = false;
      continue;
    }
    const std::string line = "no joint state for " + secondsText(now_s - *heard_s[t]) + " on " + topics_[t] +
                             (others_come ? ", while others come" : "");
    summary_ += (summary_.empty() ? "" : "; ") + line;
    if (others_come && !told_[t]) {
      told_[t] = true;
      lines.push_back(
          line + ": what it moves stays where it was, and its forces go on. Has its driver ended? See `rostopic hz`");
    }
  }
  noteMissing(heard_s, now_s, lines);
  return lines;
}

void TopicSilence::noteMissing(const std::vector<std::optional<double>>& heard_s, double now_s,
                               std::vector<std::string>& lines) {
  if (now_s - *began_s_ < kPatience_s) return;
  const auto is_heard = [](const std::optional<double>& at) { return at.has_value(); };
  if (std::none_of(heard_s.begin(), heard_s.end(), is_heard)) {
    if (std::exchange(told_of_all_, true)) return;
    lines.push_back("no joint state yet, within " + secondsText(kPatience_s) + ", on " + listOf(topics_) +
                    ": nothing moves. Does `rostopic info` name a publisher? joint_state_topics of the scene name what "
                    "is listened to");
    return;
  }
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    if (heard_s[t] || !triggers_[t] || told_[t]) continue;
    told_[t] = true;
    lines.push_back("no joint state yet on " + topics_[t] +
                    ", while others come: what it moves stays at its initial position, without a wrench. Does "
                    "`rostopic info` name a publisher?");
  }
}

}  // namespace tissue_contact
