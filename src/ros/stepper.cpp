/// @file
/// Room `ros`: see stepper.h.
#include "tissue_contact/ros/stepper.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "tissue_contact/ros/environment.h"
#include "tissue_contact/ros/joint_state_policy.h"

namespace tissue_contact {

Stepper::Stepper(Simulator& simulator, JointStatePlayer& player, JointStateInbox& inbox, Outputs& outputs,
                 Health& health, bool simulated_time)
    : simulator_(simulator),
      player_(player),
      inbox_(inbox),
      outputs_(outputs),
      health_(health),
      simulated_time_(simulated_time),
      pacing_(simulator.scene().step.max_lag_s),
      receipts_(player.topics().size()) {
  simulator_.setStepObserver([this] { noteStep(); });
  player_.setLimits(limits(0));
}

Stepper::~Stepper() {
  stop();
  simulator_.setStepObserver(nullptr);
}

void Stepper::start() {
  thread_ = std::thread([this] { run(); });
}

void Stepper::stop() {
  stop_ = true;
  inbox_.wake();
  if (thread_.joinable()) thread_.join();
}

void Stepper::run() {
  try {
    while (!stop_) {
      inbox_.wait();
      outputs_.showToNewcomer();
      takeReceived();
      health_.noteWork(std::nullopt);  // what the player holds counts as waiting, also when it is to play no more
      while (!stop_ && playNext()) {
      }
    }
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    failed_ = true;
  }
}

AdvanceLimits Stepper::limits(int most_steps) const {
  AdvanceLimits limits;
  limits.most_steps = most_steps;
  limits.longest_step_s = longestStep(newest_state_, simulator_.scene().step.max_step_s);
  limits.interrupted = [this] { return stop_.load(); };
  return limits;
}

/// Under every state one after the other, so that what waits is bounded by the inbox; else all there is.
void Stepper::takeReceived() {
  for (std::size_t left = newest_state_ ? inbox_.counts().waiting : 1; left > 0; --left) {
    std::optional<ReceivedState> state = inbox_.take();
    if (!state) return;
    if (state->after_restart) player_.restart();
    newest_received_s_ = state->received_s;
    newest_age_s_ = state->age_s;
    newest_stamp_ns_ = state->sample.stamp_ns;
    if (player_.triggers(state->topic)) {
      receipts_.note(state->topic, newest_stamp_ns_, newest_received_s_);
      pacing_.noteReceived(newest_received_s_);
    }
    player_.push(state->topic, std::move(state->sample));
  }
}

/// Plays and publishes one moment; false when none is ready.
bool Stepper::playNext() {
  const long steps_before = simulator_.stepCount();
  const double start_s = pace();
  health_.noteWork(newest_received_s_);
  const std::optional<PlayedSample> played = player_.playNext();
  if (played) {
    const auto steps = static_cast<int>(simulator_.stepCount() - (played->was_reset ? 0 : steps_before));
    const double step_time_s = steps > 0 ? (steadySeconds() - start_s) / steps : 0.0;
    if (health_.note(*played, steps, pacing_.stepCost())) publish(*played, steps, step_time_s);
    if (played->verdict == Verdict::kAccepted && !policy_chosen_) choosePolicy();
  }
  health_.noteWork(std::nullopt);
  return played.has_value();
}

void Stepper::publish(const PlayedSample& played, int steps, double step_time_s) {
  played_stamp_ns_ = played.stamp_ns;
  if (played.interrupted) return;
  outputs_.publishWrenches(played);
  const std::optional<double> received_s = receipts_.take(played.stamp_ns);
  if (!played.instruments.empty()) {
    health_.noteWrenches(played.instruments.size(),
                         received_s ? std::optional(steadySeconds() - *received_s) : std::nullopt);
  }
  outputs_.publishState(played, steps, step_time_s);
  health_.noteSnapshotsDropped(outputs_.snapshotsDropped());
}

void Stepper::choosePolicy() {
  const StepDescription& step = simulator_.scene().step;
  const PolicyChoice choice = tissue_contact::choosePolicy(step.joint_states, simulated_time_, newest_age_s_);
  policy_chosen_ = true;
  newest_state_ = choice.policy == StatePolicy::kNewestState;
  player_.setPolicy(choice.policy);
  health_.notePolicy(newest_state_);
  if (newest_state_) {
    ROS_INFO_STREAM("newest_state: steps to the newest joint state and merges older ones, lagging by at most "
                    << step.max_lag_s << " s (step.max_lag_s), because " << choice.reason
                    << "; step.joint_states: every_state in the scene overrides it");
  } else {
    ROS_INFO_STREAM("every_state: steps to every joint state, however long it takes, because "
                    << choice.reason << "; step.joint_states: newest_state in the scene overrides it");
  }
}

/// Sets what the interval that may begin now may cost. @return the time.
double Stepper::pace() {
  const double now_s = steadySeconds();
  const double motion_s = 1e-9 * static_cast<double>(newest_stamp_ns_ - played_stamp_ns_);
  constexpr double kMost = 1e6;  // fits an int; a gap is cut to less
  const double steps =
      std::ceil(std::clamp(motion_s / longestStep(newest_state_, simulator_.scene().step.max_step_s), 1.0, kMost));
  pacing_.begin(now_s, newest_received_s_, static_cast<int>(steps));
  if (newest_state_) {
    player_.setLimits(limits(pacing_.mostSteps()));
    simulator_.setSolverDeadline(pacing_.deadline(now_s), pacing_.promptDeadline(now_s));
  }
  return now_s;
}

void Stepper::noteStep() {
  const double now_s = steadySeconds();
  pacing_.noteStep(now_s);
  if (newest_state_) simulator_.setSolverDeadline(pacing_.deadline(now_s), pacing_.promptDeadline(now_s));
}

}  // namespace tissue_contact
