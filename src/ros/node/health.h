/// @file
/// Room `ros`, private: how a live run goes: counted, timed, told to /diagnostics, Status and, sparingly, to the console.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ros/node/joint_state_inbox.h"
#include "ros/node/live_figures.h"
#include "ros/node/real_time_factor.h"
#include "ros/node/topic_silence.h"
#include "tissue_contact/Status.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/law_error.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// One thread steps and notes; any thread may ask for the figures, and waits no longer than a copy of them takes.
class Health {
 public:
  /// All must outlive this. Only the stepping thread's calls read of `simulator` and `player` what may change.
  /// @param topics what those of the player are called on the ROS graph.
  Health(const Simulator& simulator, const JointStatePlayer& player, const JointStateInbox& inbox,
         std::vector<std::string> topics);

  /// Who names the publishers of a topic in a warning; before any thread starts.
  void setPublishers(std::function<std::string(int topic)> publishers) { publishers_ = std::move(publishers); }

  // ------------------------------------------------------------------------------------ the stepping thread

  /// The newest of the states that are now played was received then, or: nothing is played any more.
  void noteWork(std::optional<double> received_s);

  /// Notes one played moment. Warns about each kind of refusal, and about gaps and jumps, at most every 5 s of wall
  /// time, and about every reset unless there are many; reports an error when a step gave no finite answer, once until the next reset.
  /// @param steps implicit steps it took.
  /// @param step_cost_s usual wall time of one.
  /// @return whether the result is finite and so may be published.
  bool note(const PlayedSample& played, int steps, double step_cost_s);

  /// `count` wrenches went out, `lag_s` after the receipt of the state they answer.
  void noteWrenches(std::size_t count, std::optional<double> lag_s);

  /// Looks at the likely errors of the forces, which cost something, ten times a second: once the wrenches are out.
  /// @param stamp_ns of the moment they are of: also ten times a second of that, since a bag may be played faster.
  void noteForceErrors(std::int64_t stamp_ns);

  void notePaused(bool paused);
  void noteFailure();         ///< the stepping thread ends
  void noteReset();           ///< the simulation began anew, or with another state
  void tellBegunInContact();  ///< beganInContact(): warns, seldom
  void noteSnapshotsDropped(std::int64_t dropped);
  void notePolicy(bool newest_state);
  void noteSilentJoints(const std::string& text);               ///< JointWatch::silentJoints()
  void setMaxLag(double max_lag_s) { max_lag_s_ = max_lag_s; }  ///< in place of the scene's

  /// The part of a Status that LiveFigures have.
  void addTo(Status& status) const;

  // ------------------------------------------------------------------------------------ any thread

  LiveFigures figures() const;

  // ------------------------------------------------------------------------------------ the diagnostics thread

  /// Summary and counts. ERROR when a step gave no finite answer since the last reset, or when since the last call
  /// the lag was far over its bound or joint states came by two clocks; WARN when it was over it, forces were such as no tissue bears, refined cells
  /// were longer than asked for, steps were lengthened to hold the lag, time went backwards in the last seconds, a topic that only updates is ahead of the others, one has fallen silent, or a joint on one, a joint state was refused or dropped, or a gap or jump was cut short. Steps that used up their
  /// iterations are counted but are no alarm: a fixed budget per step is how the solver keeps real time. The log says
  /// what to change when the machine does not keep up (KeepUpNews).
  /// @param missing see Receiver::missing().
  void fill(std::int64_t missing, diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  using Clock = std::chrono::steady_clock;
  /// Lets so many warnings through every 5 s of wall time.
  class Throttle {
   public:
    explicit Throttle(int most = 1) : most_(most) {}
    bool pass();

   private:
    int most_;
    int passed_ = 0;
    std::optional<Clock::time_point> began_;
  };

  void warn(const PlayedSample& played, int steps);
  void warnOfResult(const PlayedSample& played);
  std::string notConvergedText(const PlayedSample& played);
  bool noteSteps(const PlayedSample& played, int steps, bool finite);
  void noteCells(const CoarseCells& cells);
  static void tellBroken(const PlayedSample& played, bool finite);
  double worstLag(const LiveFigures& figures);
  void tellSilence();
  std::string heldText(const LiveFigures& now);
  void summarize(const LiveFigures& now, double worst_lag_s, diagnostic_updater::DiagnosticStatusWrapper& status);

  const Simulator& simulator_;
  const JointStatePlayer& player_;
  const JointStateInbox& inbox_;

  // The stepping thread's alone.
  std::array<Throttle, kVerdictCount> refusals_;
  std::function<std::string(int topic)> publishers_;
  Throttle gaps_;
  Throttle placed_{3};             // an arm and its jaw, of two
  Throttle resets_{3};             // short recordings in a loop
  Throttle contacts_at_first_{3};  // as resets
  Throttle resumptions_;
  Throttle jumps_;
  Throttle implausible_loads_;
  Throttle laws_left_;  // each press may leave it anew
  Throttle not_converged_{5};
  std::optional<Clock::time_point> looked_at_force_errors_;
  std::int64_t looked_at_stamp_ns_ = 0;
  LawAlarm law_alarm_;
  bool told_of_cells_ = false;

  std::atomic<int> nodes_;  ///< of all tissues now
  std::atomic<double> max_lag_s_;

  mutable std::mutex mutex_;  ///< guards the members up to those of the diagnostics thread
  LiveFigures figures_;
  double silent_joints_until_s_ = 0.0;
  RealTimeFactor real_time_factor_;
  std::int64_t played_stamp_ns_ = 0;
  std::int64_t held_by_player_ = 0;
  std::optional<double> working_on_s_;  ///< receipt of the newest state that is being played
  double worst_lag_s_ = 0.0;            ///< of wrenches since the diagnostics were last told

  // The diagnostics thread's alone.
  LiveFigures told_;
  bool told_of_hold_ = false;  ///< the present one
  KeepUpNews keep_up_news_;
  double reset_told_until_s_ = 0.0;        ///< that time went backwards
  const std::vector<std::string> topics_;  ///< as people know them
  TopicSilence silence_;
};

}  // namespace tissue_contact
