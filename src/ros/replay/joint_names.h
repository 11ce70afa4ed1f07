/// @file
/// Room `ros`, private: joints that a recording names otherwise than the URDF.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// A message with one known joint is accepted, so a joint that goes by another name would silently stay where it is. A foreign name alone
/// is usual (/joint_states of several arms), and so is a joint that no message names (jaws that were not recorded); both together are not.
class JointNames {
 public:
  JointNames(const Simulator& simulator, const JointStatePlayer& player);

  /// @param topic index into JointStatePlayer::topics(). Names as in the topic's message before cost a comparison.
  void note(int topic, const std::vector<std::string>& names);

  /// A line for each instrument with joints that nothing named, on whose topics were names that are no joint of it.
  std::vector<std::string> findings() const;

 private:
  struct Topic {
    std::vector<int> listeners;  ///< instruments
    std::vector<std::string> last_names;
  };
  struct Seen {
    std::set<int> joints;
    std::vector<std::string> foreign;  ///< the first few, each once
  };

  const Simulator& simulator_;
  std::vector<Topic> topics_;
  std::vector<Seen> seen_;  ///< per instrument
};

}  // namespace tissue_contact
