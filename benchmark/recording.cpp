#include "benchmark/recording.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "ros/bag/joint_state_bag.h"

namespace tissue_contact {
namespace {

/// As JointStatePlayer::topics(): distinct, in order of first mention.
std::vector<std::string> topicsOf(const Scene& scene) {
  std::vector<std::string> topics;
  for (const InstrumentDescription& instrument : scene.instruments) {
    for (const JointStateTopic& topic : instrument.joint_state_topics) {
      if (std::find(topics.begin(), topics.end(), topic.name) == topics.end()) topics.push_back(topic.name);
    }
  }
  return topics;
}

class Playback {
 public:
  Playback(Simulator& simulator, const Sampled& sampled) : player_(simulator), sampled_(sampled) {}

  void play(const Recording& recording) {
    first_ns_ = recording.entries.front().sample.stamp_ns;
    for (const Recording::Entry& entry : recording.entries) {
      player_.push(entry.topic, entry.sample);
      playAll();
    }
    player_.finish();
    playAll();
    if (player_.count(Verdict::kAccepted) == 0) {
      throw std::runtime_error("no joint state of the recording was accepted; the first was refused: " + refusal_);
    }
  }

 private:
  void playAll() {
    while (const std::optional<PlayedSample> played = player_.playNext()) {
      if (played->verdict == Verdict::kAccepted) {
        sampled_(1e-9 * static_cast<double>(played->stamp_ns - first_ns_));
      } else if (refusal_.empty()) {
        refusal_ = std::string(verdictText(played->verdict)) + ": " + played->detail;
      }
    }
  }

  JointStatePlayer player_;
  const Sampled& sampled_;
  std::int64_t first_ns_ = 0;
  std::string refusal_;
};

}  // namespace

Recording readRecording(const std::string& bag_file, const Scene& scene, const TimeWindow& window) {
  const std::vector<std::string> topics = topicsOf(scene);
  if (topics.empty()) throw std::runtime_error("the scene has no instrument with a joint-state topic: nothing moves");
  const JointStateBag bag(bag_file, topics);
  Recording recording;
  recording.missing_topics.assign(bag.missingTopics().begin(), bag.missingTopics().end());
  bag.forEach([&](int topic, JointStateSample sample, ros::Time recorded) {
    const double time = (recorded - bag.begin()).toSec();
    if (time < window.from_s || (window.duration_s > 0.0 && time > window.from_s + window.duration_s)) return;
    recording.entries.push_back({topic, std::move(sample)});
    recording.duration_s = time - window.from_s;
  });
  if (recording.entries.empty()) {
    throw std::runtime_error("bag '" + bag_file + "' has no joint state in the time asked for; it is " +
                             std::to_string((bag.end() - bag.begin()).toSec()) + " s long");
  }
  return recording;
}

Motion playRecording(Recording recording) {
  // Shared, because a std::function copies what it holds.
  return [shared = std::make_shared<const Recording>(std::move(recording))](
             Simulator& simulator, const Sampled& sampled) { Playback(simulator, sampled).play(*shared); };
}

}  // namespace tissue_contact
