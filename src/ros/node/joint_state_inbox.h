/// @file
/// Room `ros`, private: joint states between the thread that receives them and the one that steps. No ROS inside.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

/// A joint state as it came in.
struct ReceivedState {
  int topic = 0;  ///< index into JointStatePlayer::topics()
  JointStateSample sample;
  double received_s = 0.0;     ///< on a clock that never goes back
  double age_s = 0.0;          ///< wall clock minus stamp on receipt
  bool after_restart = false;  ///< the time source was set back between this one and the one before
};

/// A bounded queue: whoever receives never waits, whatever the reader does; what does not fit is counted. Thread-safe.
class JointStateInbox {
 public:
  struct Counts {
    std::int64_t received = 0;
    std::int64_t dropped = 0;          ///< the oldest, when the inbox was full, by number or by bytes
    std::size_t waiting = 0;           ///< not yet taken
    double oldest_received_s = 0.0;    ///< of those waiting; valid when any is
    std::int64_t newest_stamp_ns = 0;  ///< of the last one received; 0: none yet
  };

  /// @param most states that wait at most, > 0.
  /// @param most_bytes they take up at most, one of any size apart: how many names a message holds is up to who sends
  ///   it.
  explicit JointStateInbox(std::size_t most, std::size_t most_bytes = 256'000'000)
      : most_(most), most_bytes_(most_bytes) {}

  void put(ReceivedState state);

  /// The time source was set back: the next state to come is marked with it.
  void noteRestart();

  /// The oldest waiting; nothing if there is none.
  std::optional<ReceivedState> take();

  /// Returns once something waits or wake() was called since the last wait.
  void wait();
  /// The same, but no longer than that.
  /// @return whether it was one of those two.
  bool wait(double most_s);
  void wake();

  Counts counts() const;

  /// When the last state of each of so many topics was received; nothing: never.
  std::vector<std::optional<double>> heard(std::size_t topics) const;

 private:
  void dropOldest();

  const std::size_t most_;
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;  ///< guards all below; held for no longer than a move
  std::condition_variable arrived_;
  std::deque<ReceivedState> waiting_;
  std::size_t bytes_ = 0;  ///< of those waiting
  bool woken_ = false;
  bool restarted_ = false;
  Counts counts_;
  std::vector<std::optional<double>> heard_s_;  ///< per topic, as far as any was received
};

}  // namespace tissue_contact
