/// @file
/// Room `ros`, private: how long, by the wall clock, joint-state topics are waited for that seem to be missing. No clock inside.
#pragma once

#include <optional>
#include <vector>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

/// A topic whose stamps are max_gap_s behind another's is missing or stuck where messages come at the speed they were recorded at. In a
/// recording that is played twenty times as fast they are also behind while its connection stalls for as many milliseconds, and would all be
/// late. So such a topic is waited for until it has not kept up for max_gap_s of wall time as well. Not thread-safe.
class AwaitedTopics {
 public:
  /// @param player must outlive this. @param most_s wall time, > 0.
  AwaitedTopics(JointStatePlayer& player, double most_s);

  /// After a state of the topic was handed to the player.
  /// @param received_s when it came, on a clock that never goes back.
  void noteReceipt(int topic, double received_s);

  /// That time has come and everything received by then was handed to the player.
  void noteTime(double now_s);

  /// When the next of those topics is waited for no longer, on that clock; nothing if there is none.
  std::optional<double> nextEnd() const;

 private:
  JointStatePlayer* player_;  ///< never null
  double most_s_;
  std::vector<std::optional<double>> kept_up_s_;  ///< per topic: when it last came in time
  std::optional<double> first_s_;                 ///< when the first state of all came
  std::vector<bool> awaited_;                     ///< per topic
};

}  // namespace tissue_contact
