/// @file
/// Room `simulation`: JointStatePlayer begun anew, saved and restored.
#include <optional>

#include "instrument/joint_bounds.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

void JointStatePlayer::reset() {
  forgetSamples();
  simulator_.reset();
  forgetJoints();
  time_ns_.reset();
  behind_ns_ = 0;
  restored_ = false;
  ++resets_;
}

/// As if no topic had ever been heard.
void JointStatePlayer::forgetSamples() {
  merged_ += static_cast<std::int64_t>(waiting_);
  waiting_ = 0;
  for (Topic& topic : topic_states_) {
    topic.clock = TopicClock(max_gap_ns_);
    topic.queue.clear();
    topic.kept = {};
    topic.named.clear();
    topic.held.clear();
    topic.last.reset();
    topic.awaited = false;
  }
  newest_.reset();
  released_.reset();
  resumptions_.clear();
  epoch_ = 0;
}

const char* JointStatePlayer::stateTitle() { return "tissue_contact state 11"; }

std::string JointStatePlayer::saveState() {
  StateArchive archive(stateTitle());
  carry(archive);
  return archive.finish();
}

void JointStatePlayer::restoreState(const std::string& state) {
  restoreOrPutBack(
      stateTitle(), state, [this] { return saveState(); }, [this](StateArchive& archive) { carry(archive); },
      [this] { reset(); });
  forgetSamples();
  for (Topic& topic : topic_states_) {
    if (topic.taken) topic.taken->epoch = epoch_;
  }
  owes_.assign(owes_.size(), false);
  restored_ = time_ns_.has_value();
}

void JointStatePlayer::carry(StateArchive& archive) {
  simulator_.carry(archive);
  archive.section("joint states");
  archive.carry(time_ns_);
  archive.carry(behind_ns_);
  constexpr std::int64_t kCentury_ns = 4'000'000'000'000'000'000;  // and so that no difference of two overflows
  archive.check(!time_ns_ || (*time_ns_ >= 0 && *time_ns_ <= kCentury_ns), "a time that no stamp has");
  archive.check(behind_ns_ >= 0 && behind_ns_ < std::max<std::int64_t>(shortest_ns_, 1), "a time that is none");
  archive.require(topic_states_.size(), "it has another number of topics");
  for (Topic& topic : topic_states_) {
    std::optional<std::int64_t> taken_ns;
    if (topic.taken && topic.taken->epoch == epoch_) taken_ns = topic.taken->stamp_ns;
    archive.carry(taken_ns);
    archive.check(!taken_ns || (*taken_ns >= 0 && *taken_ns <= kCentury_ns), "a time that no stamp has");
    if (!archive.isReading()) continue;
    topic.taken = taken_ns ? std::optional(Moment{epoch_, *taken_ns}) : std::nullopt;
    topic.taken_at_ns.reset();
  }
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    archive.carry(targets_[i]);
    archive.carry(velocities_.start[i]);
    archive.carry(heard_[i]);
    archive.check(std::all_of(targets_[i].begin(), targets_[i].end(), isJointPosition),
                  "a joint position that is none");
    for (const Heard heard : heard_[i]) archive.requireIndex(static_cast<int>(heard), 0, 3, "the mark of a joint");
    for (Said& said : said_[i]) {
      archive.carry(said.position);
      archive.carry(said.turns);
      archive.carry(said.stamp_ns);
      archive.carry(said.seen_ns);
      archive.carry(said.right_ns);
      archive.carry(said.arrives_ns);
      archive.carry(said.velocity);
      archive.carry(said.target_velocity);
      archive.check(said.seen_ns >= 0 && said.seen_ns <= kCentury_ns && said.right_ns >= 0 &&
                        said.right_ns <= kCentury_ns && said.arrives_ns >= 0 && said.arrives_ns <= 2 * kCentury_ns,
                    "a joint state that is none");
      archive.check(isJointPosition(said.position) && isJointPosition(said.turns) && said.stamp_ns >= 0 &&
                        said.stamp_ns <= kCentury_ns,
                    "a joint state that is none");
    }
  }
}

}  // namespace tissue_contact
