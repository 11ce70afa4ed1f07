#include "ros/place/recorded_motion.h"

#include <iostream>
#include <optional>
#include <stdexcept>
#include <utility>

#include "ros/bag/joint_state_bag.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {
namespace {

/// Nothing to touch, so steps of any length are right.
Scene withoutTissues(Scene scene) {
  scene.tissues.clear();
  scene.tissue_pairs.clear();
  scene.friction.clear();
  return scene;
}

}  // namespace

void playMotion(const Scene& scene, const SceneEnvironment& environment, const std::string& bag_file,
                const std::function<void(std::int64_t stamp_ns, const Simulator& instruments)>& take) {
  Simulator instruments(withoutTissues(scene), environment);
  JointStatePlayer player(instruments);
  AdvanceLimits limits;
  limits.most_steps = 1;
  player.setLimits(limits);
  const JointStateBag bag(bag_file, player.topics());
  if (!bag.missingTopics().empty()) {
    std::cerr << "tissue_contact_place: warning: the bag has no message on " << joinedNames(bag.missingTopics())
              << "; its joints stay where the scene puts them\n";
  }
  std::string refusal;
  const auto playAll = [&] {
    while (const std::optional<PlayedSample> played = player.playNext()) {
      if (played->verdict == Verdict::kAccepted) {
        take(played->stamp_ns, instruments);
      } else if (refusal.empty()) {
        refusal = std::string(verdictText(played->verdict)) + ": " + played->detail;
      }
    }
  };
  bag.forEach([&](int topic, JointStateSample sample, ros::Time /*recorded*/) {
    player.push(topic, std::move(sample));
    playAll();
  });
  player.finish();
  playAll();
  if (player.count(Verdict::kAccepted) == 0) {
    throw std::runtime_error(nothingPlayed(bag_file, refusal));
  }
}

}  // namespace tissue_contact
