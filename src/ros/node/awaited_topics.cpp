#include "ros/node/awaited_topics.h"

#include <algorithm>
#include <cstddef>

namespace tissue_contact {

AwaitedTopics::AwaitedTopics(JointStatePlayer& player, double most_s)
    : player_(&player),
      most_s_(most_s),
      kept_up_s_(player.topics().size(), 0.0),
      awaited_(player.topics().size(), false) {}

void AwaitedTopics::noteReceipt(int topic, double received_s) {
  if (!now_s_) now_s_ = received_s;
  noteTime(received_s);
  received_s_ = running_s_;
  if (!player_->isOvertaken(topic)) kept_up_s_[static_cast<std::size_t>(topic)] = running_s_;
}

void AwaitedTopics::noteTime(double now_s) {
  if (!now_s_) return;
  running_s_ += std::clamp(now_s - *now_s_, 0.0, 2.0 * kLook_s);
  now_s_ = std::max(*now_s_, now_s);
  for (std::size_t t = 0; t < awaited_.size(); ++t) {
    const int topic = static_cast<int>(t);
    awaited_[t] = running_s_ < kept_up_s_[t] + most_s_ && player_->isOvertaken(topic);
    player_->keepWaitingFor(topic, awaited_[t]);
  }
}

bool AwaitedTopics::isWaiting() const { return std::find(awaited_.begin(), awaited_.end(), true) != awaited_.end(); }

}  // namespace tissue_contact
