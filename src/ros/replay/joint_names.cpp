#include "ros/replay/joint_names.h"

#include <algorithm>
#include <cstddef>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kMostForeign = 12;  // told; a message may name a million

}  // namespace

JointNames::JointNames(const Simulator& simulator, const JointStatePlayer& player)
    : simulator_(simulator), topics_(player.topics().size()), seen_(simulator.instruments().size()) {
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    for (const JointStateTopic& described : simulator.scene().instruments[i].joint_state_topics) {
      const auto at = std::find(player.topics().begin(), player.topics().end(), described.name);
      topics_[static_cast<std::size_t>(at - player.topics().begin())].listeners.push_back(static_cast<int>(i));
    }
  }
}

void JointNames::note(int topic, const std::vector<std::string>& names) {
  Topic& heard = topics_[static_cast<std::size_t>(topic)];
  if (names == heard.last_names) return;
  heard.last_names = names;
  for (const int i : heard.listeners) {
    const Instrument& instrument = simulator_.instruments()[static_cast<std::size_t>(i)];
    Seen& seen = seen_[static_cast<std::size_t>(i)];
    for (const std::string& name : names) {
      const int joint = instrument.jointOfRecordedName(name);
      if (joint >= 0) {
        seen.joints.insert(joint);
      } else if (seen.foreign.size() < kMostForeign &&
                 std::find(seen.foreign.begin(), seen.foreign.end(), name) == seen.foreign.end()) {
        seen.foreign.push_back(name);
      }
    }
  }
}

std::vector<std::string> JointNames::findings() const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const Instrument& instrument = simulator_.instruments()[i];
    std::vector<std::string> still;
    for (std::size_t j = 0; j < instrument.model().joints().size(); ++j) {
      if (seen_[i].joints.count(static_cast<int>(j)) == 0) still.push_back(instrument.model().joints()[j].name);
    }
    if (still.empty() || seen_[i].foreign.empty()) continue;
    lines.push_back("no joint state names these joints of '" + instrument.name() +
                    "', which stay where the scene puts them: " + listOf(still) +
                    "; those that come name others, which are none of its joints: " + listOf(seen_[i].foreign) +
                    ". If they are the same, map them by joint_names");
  }
  return lines;
}

}  // namespace tissue_contact
