#include "ros/joint_silence.h"

#include <algorithm>
#include <utility>

namespace tissue_contact {

void JointSilence::note(std::size_t topic, double now_s, const std::vector<std::size_t>& joints) {
  if (topic >= topics_.size()) topics_.resize(topic + 1);
  passTime(topics_[topic], now_s);
  for (const std::size_t number : joints) noteJoint(number, topic);
}

void JointSilence::passTime(Topic& topic, double now_s) const {
  const double most_s = 0.5 * longest_s_;
  const double apart_s = now_s - topic.newest_s.value_or(now_s);
  topic.passed_s += std::clamp(apart_s, 0.0, most_s);
  const bool goes_back = apart_s < -longest_s_;  // a loop; by less: another driver's clock
  if (!topic.newest_s || apart_s > 0.0 || goes_back) topic.newest_s = now_s;
}

void JointSilence::noteJoint(std::size_t number, std::size_t topic) {
  if (number >= joints_.size()) joints_.resize(number + 1);
  Joint& joint = joints_[number];
  if (joint.topic == topic) {
    constexpr double kIntervals = 3.0;
    const double apart_s = topics_[topic].passed_s - joint.named_s;
    if (silence(joint) == 0.0 || joint.longest_s == 0.0) {  // what the first interval is, nobody knows before it ends
      joint.longest_s = std::max({joint.longest_s, longest_s_, kIntervals * apart_s});
    } else if (apart_s > joint.longest.silent_s) {
      joint.longest = {number, topic, apart_s};
    }
  }
  joint.topic = topic;
  joint.named_s = topics_[topic].passed_s;
  joint.told = false;
}

/// How long it has been silent; 0: it is not.
double JointSilence::silence(const Joint& joint) const {
  if (!joint.topic) return 0.0;
  const double silent_s = topics_[*joint.topic].passed_s - joint.named_s;
  return silent_s > std::max(longest_s_, joint.longest_s) ? silent_s : 0.0;
}

std::vector<JointSilence::Silent> JointSilence::now() const {
  std::vector<Silent> silent;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const double silent_s = silence(joints_[j]);
    if (silent_s > 0.0) silent.push_back({j, *joints_[j].topic, silent_s});
  }
  return silent;
}

std::vector<JointSilence::Silent> JointSilence::takeNew() {
  std::vector<Silent> silent = now();
  const auto was_told = [this](const Silent& one) { return std::exchange(joints_[one.joint].told, true); };
  silent.erase(std::remove_if(silent.begin(), silent.end(), was_told), silent.end());
  return silent;
}

std::vector<JointSilence::Silent> JointSilence::longest() const {
  std::vector<Silent> silent = now();
  for (const Joint& joint : joints_) {
    if (!(joint.longest.silent_s > 0.0)) continue;
    const auto at =
        std::find_if(silent.begin(), silent.end(), [&](const Silent& one) { return one.joint == joint.longest.joint; });
    if (at == silent.end()) {
      silent.push_back(joint.longest);
    } else if (joint.longest.silent_s > at->silent_s) {
      *at = joint.longest;
    }
  }
  std::sort(silent.begin(), silent.end(), [](const Silent& a, const Silent& b) { return a.joint < b.joint; });
  return silent;
}

}  // namespace tissue_contact
