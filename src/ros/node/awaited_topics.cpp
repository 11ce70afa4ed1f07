#include "ros/node/awaited_topics.h"

#include <algorithm>
#include <cstddef>

namespace tissue_contact {

AwaitedTopics::AwaitedTopics(JointStatePlayer& player, double most_s)
    : player_(&player), most_s_(most_s), kept_up_s_(player.topics().size()), awaited_(player.topics().size(), false) {}

void AwaitedTopics::noteReceipt(int topic, double received_s) {
  if (!first_s_) first_s_ = received_s;
  if (!player_->isOvertaken(topic)) kept_up_s_[static_cast<std::size_t>(topic)] = received_s;
  noteTime(received_s);
}

void AwaitedTopics::noteTime(double now_s) {
  for (std::size_t t = 0; t < awaited_.size(); ++t) {
    const int topic = static_cast<int>(t);
    awaited_[t] = first_s_ && now_s < kept_up_s_[t].value_or(*first_s_) + most_s_ && player_->isOvertaken(topic);
    player_->keepWaitingFor(topic, awaited_[t]);
  }
}

std::optional<double> AwaitedTopics::nextEnd() const {
  std::optional<double> next;
  for (std::size_t t = 0; t < awaited_.size(); ++t) {
    if (!awaited_[t]) continue;
    const double end_s = kept_up_s_[t].value_or(*first_s_) + most_s_;
    next = std::min(end_s, next.value_or(end_s));
  }
  return next;
}

}  // namespace tissue_contact
