/// @file
/// Room `ros`, private: the thread that steps: joint states from the inbox into the player, wrenches out at once.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "ros/joint_watch.h"
#include "ros/node/awaited_topics.h"
#include "ros/node/health.h"
#include "ros/node/joint_state_inbox.h"
#include "ros/node/joint_state_policy.h"
#include "ros/node/live_pacing.h"
#include "ros/node/live_tuning.h"
#include "ros/node/receipt_times.h"
#include "ros/node/request_queue.h"
#include "ros/publish/outputs.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// From start() until stop() has returned, its thread alone touches simulator, player and outputs.
class Stepper {
 public:
  /// All must outlive this.
  /// @param simulated_time whether ROS time comes from /clock.
  Stepper(Simulator& simulator, JointStatePlayer& player, JointStateInbox& inbox, Outputs& outputs, Health& health,
          LiveTuning& tuning, bool simulated_time);
  ~Stepper();
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  /// Whether joint states may still come; without it they always may. Called on the thread. Before start().
  void setMoreMayCome(std::function<bool()> more_may_come) { more_may_come_ = std::move(more_may_come); }

  void start();

  /// Ends the thread once the step it is at is done.
  void stop();

  /// What other threads ask of this one; it does so between two moments.
  RequestQueue& requests() { return requests_; }

  // In requests alone. The answer tells the time of the simulation.
  Answer reset();                             ///< everything back to the start; what waits counts as merged
  Answer pause();                             ///< takes no more joint states; they wait in the inbox
  Answer resume();                            ///< goes on with those that wait
  Answer stepOnce();                          ///< while paused: to the next moment, under kNewestState the newest
  Answer saveState(const std::string& file);  ///< see saveStateFile()
  Answer loadState(const std::string& file);  ///< see loadStateFile()

  /// Whether the thread ended by itself, after one fatal message. Any thread.
  bool failed() const { return failed_; }

 private:
  void run();
  AdvanceLimits limits(int most_steps) const;
  void takeReceived();
  void push(ReceivedState state);
  bool playNext();
  void retune();
  void publish(const PlayedSample& played, const std::optional<Receipt>& receipt, int steps, double step_time_s);
  void choosePolicy(const PlayedSample& played, const Receipt& receipt);
  void awaitStates();
  double pace();
  void noteStep();
  void noteStart();
  void passOver(std::size_t waiting);
  void beginAnew();
  std::string now() const;

  Simulator& simulator_;
  JointStatePlayer& player_;
  JointStateInbox& inbox_;
  Outputs& outputs_;
  Health& health_;
  LiveTuning& tuning_;

  std::function<bool()> more_may_come_ = [] { return true; };

  // The thread's alone.
  PolicyChooser chooser_;
  LivePacing pacing_;
  ReceiptTimes receipts_;
  AwaitedTopics awaited_;
  JointWatch joint_watch_;
  Approach start_;  ///< of instruments that were placed, before the first step
  bool newest_state_ = false;
  double newest_received_s_ = 0.0;  ///< of the last state handed to the player
  std::int64_t played_stamp_ns_ = 0;
  std::int64_t published_ = 0;  ///< moments
  bool paused_ = false;

  RequestQueue requests_;

  std::atomic<bool> stop_{false};
  std::atomic<bool> failed_{false};
  std::thread thread_;
};

}  // namespace tissue_contact
