/// @file
/// Room `ros`, private: how long, by the wall clock, joint-state topics are waited for that seem to be missing. No clock inside.
#pragma once

#include <optional>
#include <vector>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

/// A topic whose stamps are max_gap_s behind another's is missing or stuck where messages come at the speed they were recorded at. In a
/// recording that is played twenty times as fast they are also behind while its connection stalls for as many milliseconds, and would all be
/// late. So such a topic is waited for until it has not kept up for max_gap_s of wall time as well, not counting time in which this process
/// did nothing: what came then lies unread. Not thread-safe.
class AwaitedTopics {
 public:
  /// @param player must outlive this. @param most_s wall time, > 0.
  AwaitedTopics(JointStatePlayer& player, double most_s);

  /// After a state of the topic was handed to the player.
  /// @param received_s when it came, on a clock that never goes back.
  void noteReceipt(int topic, double received_s);

  /// That time has come and everything received by then was handed to the player. At least every kLook_s while isWaiting().
  void noteTime(double now_s);
  static constexpr double kLook_s = 0.1;

  /// Whether there is such a topic.
  bool isWaiting() const;

  /// Whether nothing has come on any topic for `most_s`, not counting time in which this process did nothing.
  bool isSilent() const { return now_s_ && !(running_s_ < received_s_ + most_s_); }

 private:
  JointStatePlayer* player_;  ///< never null
  double most_s_;
  std::optional<double> now_s_;    ///< the last time noted
  double running_s_ = 0.0;         ///< for how long this process has run since the first state came
  double received_s_ = 0.0;        ///< how long that was when the last state came
  std::vector<double> kept_up_s_;  ///< per topic: how long that was when it last came in time
  std::vector<bool> awaited_;      ///< per topic
};

}  // namespace tissue_contact
