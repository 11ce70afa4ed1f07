#include "ros/node/stepper.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <utility>

#include "ros/approach_text.h"
#include "ros/node/state_file.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/ros/environment.h"

namespace tissue_contact {
namespace {

/// How long a subscriber to the markers may wait for them while paused.
constexpr double kLook_s = 0.1;

}  // namespace

Stepper::Stepper(Simulator& simulator, JointStatePlayer& player, JointStateInbox& inbox, Outputs& outputs,
                 Health& health, LiveTuning& tuning, bool simulated_time)
    : simulator_(simulator),
      player_(player),
      inbox_(inbox),
      outputs_(outputs),
      health_(health),
      tuning_(tuning),
      chooser_(simulator.scene().step.joint_states, simulated_time),
      pacing_(simulator.scene().step.max_lag_s),
      receipts_(player.topics().size()),
      awaited_(player, simulator.scene().step.max_gap_s),
      joint_watch_(simulator, player, longestSilence(simulator.scene().step.max_gap_s)),
      requests_([&inbox] { inbox.wake(); }) {
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
  requests_.close();
  inbox_.wake();
  if (thread_.joinable()) thread_.join();
}

void Stepper::run() {
  try {
    while (!stop_) {
      paused_ ? requests_.wait(kLook_s) : awaitStates();
      outputs_.showToNewcomer();
      requests_.answer();
      if (paused_) {
        if (inbox_.counts().waiting == 0) awaited_.noteTime(steadySeconds());
        continue;
      }
      takeReceived();
      health_.noteWork(std::nullopt);  // what the player holds counts as waiting, also when it is to play no more
      while (!stop_ && !paused_ && playNext()) requests_.answer();
    }
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    health_.noteFailure();
    failed_ = true;
  }
  requests_.close();
}

AdvanceLimits Stepper::limits(int most_steps) const {
  AdvanceLimits limits;
  limits.most_steps = most_steps;
  limits.longest_step_s = longestStep(newest_state_, simulator_.scene().step.max_step_s);
  limits.interrupted = [this] { return stop_.load(); };
  return limits;
}

/// For more of them, but for no longer than one that waits for another topic's may; where every state counts until
/// nothing came for max_gap_s and nobody is there who could send it.
void Stepper::awaitStates() {
  if (!newest_state_) {
    if (!awaited_.isWaiting() && !player_.earliestStamp()) return inbox_.wait();
    if (inbox_.wait(AwaitedTopics::kLook_s)) return;
    awaited_.noteTime(steadySeconds());
    if (awaited_.isSilent() && !more_may_come_()) player_.stopWaiting();
    return;
  }
  const std::optional<std::int64_t> earliest = player_.earliestStamp();
  if (!earliest) return inbox_.wait();
  const std::optional<Receipt> receipt = receipts_.find(*earliest);
  const double left_s = pacing_.waitUntil(receipt ? receipt->received_s : newest_received_s_) - steadySeconds();
  if (left_s <= 0.0 || !inbox_.wait(left_s)) player_.stopWaiting();
}

/// Under every state one after the other, so that what waits is bounded by the inbox; else all there is.
void Stepper::takeReceived() {
  for (std::size_t left = newest_state_ ? inbox_.counts().waiting : 1; left > 0; --left) {
    std::optional<ReceivedState> state = inbox_.take();
    if (!state) return;
    if (state->after_restart) player_.restart();
    newest_received_s_ = state->received_s;
    if (player_.triggers(state->topic)) {
      receipts_.note(state->topic, {state->sample.stamp_ns, state->received_s, state->age_s});
    }
    push(std::move(*state));
  }
}

void Stepper::push(ReceivedState state) {
  joint_watch_.note(state.topic, state.sample, state.received_s);
  for (const std::string& line : joint_watch_.takeNews(state.received_s)) ROS_WARN_STREAM(line);
  health_.noteSilentJoints(joint_watch_.silentJoints());
  player_.push(state.topic, std::move(state.sample));
  awaited_.noteReceipt(state.topic, state.received_s);
}

/// Between two moments: goes on with what people have changed.
void Stepper::retune() {
  const std::optional<LiveNumbers> numbers = tuning_.take();
  if (!numbers) return;
  simulator_.retune(numbers->scene);
  const double max_lag_s = numbers->scene.step.max_lag_s;
  pacing_.setMaxLag(max_lag_s);
  player_.setMaxLag(max_lag_s);
  health_.setMaxLag(max_lag_s);
  outputs_.setRates(numbers->publish);
  tuning_.echo(*numbers, played_stamp_ns_, player_.resets());
}

/// Plays and publishes one moment; false when none is ready.
bool Stepper::playNext() {
  retune();
  const long steps_before = simulator_.stepCount();
  const double start_s = pace();
  const std::optional<PlayedSample> played = player_.playNext();
  if (played) {
    if (played->was_reset) tuning_.tell(0, player_.resets());
    const auto steps = static_cast<int>(simulator_.stepCount() - (played->was_reset ? 0 : steps_before));
    const double step_time_s = steps > 0 ? (steadySeconds() - start_s) / steps : 0.0;
    const bool is_moment = played->verdict == Verdict::kAccepted && !played->interrupted;
    if (is_moment) joint_watch_.notePlayed();
    const std::optional<Receipt> receipt = is_moment ? receipts_.take(played->stamp_ns) : std::nullopt;
    if (health_.note(*played, steps, pacing_.stepCost())) publish(*played, receipt, steps, step_time_s);
    if (is_moment && simulator_.stepCount() == 0) simulator_.lowerClosestApproach(start_);
    if (receipt) {
      pacing_.notePlayed(receipt->received_s);
      choosePolicy(*played, *receipt);
    }
  }
  health_.noteWork(std::nullopt);
  return played.has_value();
}

void Stepper::publish(const PlayedSample& played, const std::optional<Receipt>& receipt, int steps,
                      double step_time_s) {
  played_stamp_ns_ = played.stamp_ns;
  if (played.interrupted) return;
  ++published_;
  outputs_.publishWrenches(played);
  if (!played.instruments.empty()) {
    health_.noteWrenches(played.instruments.size(),
                         receipt ? std::optional(steadySeconds() - receipt->received_s) : std::nullopt);
  }
  outputs_.publishState(played, steps, step_time_s);
  health_.noteForceErrors(played.stamp_ns);
  health_.noteSnapshotsDropped(outputs_.snapshotsDropped());
}

/// Of another simulation.
void Stepper::passOver(std::size_t waiting) {
  for (; waiting > 0 && inbox_.take(); --waiting) player_.notePassedOver();
}

void Stepper::beginAnew() {
  receipts_ = ReceiptTimes(player_.topics().size());
  awaited_ = AwaitedTopics(player_, simulator_.scene().step.max_gap_s);
  start_ = Approach();
  played_stamp_ns_ = player_.time().value_or(0);
  chooser_.startAgain();
  health_.noteReset();
  outputs_.showReset();
  tuning_.tell(played_stamp_ns_, player_.resets());
}

Answer Stepper::reset() {
  passOver(inbox_.counts().waiting);
  player_.reset();
  beginAnew();
  return {true, "tissues are undeformed and at rest; instruments go to the next joint state without a way"};
}

Answer Stepper::pause() {
  const bool was_paused = std::exchange(paused_, true);
  health_.notePaused(true);
  return {true, (was_paused ? "was paused already, at " : "paused at ") + now() + "; joint states wait"};
}

Answer Stepper::resume() {
  if (!std::exchange(paused_, false)) return {true, "was not paused"};
  health_.notePaused(false);
  return {true, "goes on from " + now()};
}

Answer Stepper::stepOnce() {
  if (!paused_) return {false, "not paused, so it steps by itself; call ~pause first"};
  const std::int64_t before = published_;
  bool given_up = false;  // topics that nobody publishes on
  for (;;) {
    while (!stop_ && published_ == before && playNext()) {
    }
    if (published_ != before) return {true, "stepped to " + now()};
    if (stop_) return {false, "the node is ending"};
    if (inbox_.counts().waiting == 0 && player_.earliestStamp() && !more_may_come_() &&
        !std::exchange(given_up, true)) {
      player_.stopWaiting();
      continue;
    }
    if (inbox_.counts().waiting == 0) {
      return {false, player_.waiting() > 0 ? "what waits is to be stepped to once the other topics have come as far"
                                           : "no joint state waits to be stepped to"};
    }
    takeReceived();
  }
}

Answer Stepper::saveState(const std::string& file) {
  retune();  // numbers that were changed before it
  const std::string saved = saveStateFile(player_, file);
  return {true, "saved the state at " + now() + " to " + saved};
}

Answer Stepper::loadState(const std::string& file) {
  retune();  // numbers that were changed for it
  const std::size_t waiting = inbox_.counts().waiting;
  const std::string loaded = loadStateFile(player_, file);
  passOver(waiting);
  beginAnew();
  return {true, "goes on from the state at " + now() + " of " + loaded};
}

/// For people.
std::string Stepper::now() const {
  return player_.time() ? stampText(*player_.time()) + " s" : "the start, before any joint state";
}

void Stepper::choosePolicy(const PlayedSample& played, const Receipt& receipt) {
  if (played.was_reset) chooser_.startAgain();
  const std::optional<PolicyChoice> choice = chooser_.note(receipt.age_s, receipt.received_s);
  if (!choice) return;
  newest_state_ = choice->policy == StatePolicy::kNewestState;
  player_.setPolicy(choice->policy);
  if (!newest_state_) {
    player_.setLimits(limits(0));
    simulator_.setSolverDeadline(std::numeric_limits<double>::infinity());
  }
  health_.notePolicy(newest_state_);
  if (newest_state_) {
    ROS_INFO_STREAM("newest_state: steps to the newest joint state and merges older ones, lagging by at most "
                    << pacing_.maxLag() << " s (step.max_lag_s), because " << choice->reason
                    << "; step.joint_states: every_state in the scene overrides it");
  } else {
    ROS_INFO_STREAM("every_state: steps to every joint state, however long it takes, because "
                    << choice->reason << "; step.joint_states: newest_state in the scene overrides it");
  }
}

/// Sets what the interval that may begin now may cost.
/// @return the time.
double Stepper::pace() {
  const double now_s = steadySeconds();
  const std::optional<std::int64_t> next_ns = player_.nextStamp();
  const std::optional<Receipt> receipt = next_ns ? receipts_.find(*next_ns) : std::nullopt;
  const double received_s = receipt ? receipt->received_s : newest_received_s_;
  const double motion_s = 1e-9 * static_cast<double>(next_ns.value_or(played_stamp_ns_) - played_stamp_ns_);
  constexpr double kMost = 1e6;  // fits an int; a gap is cut to less
  const double steps =
      std::ceil(std::clamp(motion_s / longestStep(newest_state_, simulator_.scene().step.max_step_s), 1.0, kMost));
  pacing_.begin(now_s, received_s, static_cast<int>(steps));
  health_.noteWork(received_s);
  if (newest_state_) {
    player_.setLimits(limits(pacing_.mostSteps()));
    simulator_.setSolverDeadline(pacing_.deadline(now_s), pacing_.promptDeadline(now_s));
  }
  return now_s;
}

void Stepper::noteStep() {
  const double now_s = steadySeconds();
  pacing_.noteStep(now_s);
  if (simulator_.stepCount() == 1) noteStart();
  if (newest_state_) simulator_.setSolverDeadline(pacing_.deadline(now_s), pacing_.promptDeadline(now_s));
}

void Stepper::noteStart() {
  if (beganInContact(simulator_, start_)) health_.tellBegunInContact();
  start_ = Approach();
}

}  // namespace tissue_contact
