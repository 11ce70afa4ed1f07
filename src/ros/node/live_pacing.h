/// @file
/// Room `ros`, private: how many steps, and how long, the newest joint state may take so that its wrench is not late. No ROS and
/// no clock inside.
#pragma once

#include <optional>

namespace tissue_contact {

/// Keeps the lag of a wrench behind the receipt of its joint state within a bound when steps cost more than there is
/// time for: first fewer and longer steps, then less time for the solver. Neither happens while the machine keeps up; then
/// only the odd step that would make the next state wait is cut short.
///
/// A quarter of the bound a state may wait for another topic's. Half of the bound, and no more than ends at three quarters
/// after the receipt, is for the steps, by what steps cost of late; the rest is for a state that waits for the step before
/// it, for steps that cost more than usual, and for the machine's own delays. Times are seconds on one clock
/// that never goes back. Not thread-safe.
class LivePacing {
 public:
  /// @param max_lag_s > 0.
  explicit LivePacing(double max_lag_s);

  /// From now on.
  void setMaxLag(double max_lag_s) { max_lag_s_ = max_lag_s; }
  double maxLag() const { return max_lag_s_; }

  /// Until when a state received then may wait for another topic's.
  double waitUntil(double received_s) const;

  /// A moment was played; the first of its states was received then. One moment of several topics counts once, and
  /// what was refused not at all: neither takes time of its own.
  void notePlayed(double received_s);

  /// Steps that the interval that has begun may be cut into; 0 (no limit) until a step was seen.
  int mostSteps() const;

  /// An interval begins, to a state received at `received_s`, in `steps` steps or so.
  void begin(double now_s, double received_s, int steps);

  /// A step of the interval ended.
  void noteStep(double now_s);

  /// When the solver should stop iterating on the step that begins now: what the bound leaves after the usual cost of
  /// the steps that follow, and never less than a usual step (or half the bound, if that is less).
  double deadline(double now_s) const;

  /// When its wrench should leave although the solver could do better, so that the next state need not wait: four
  /// fifths of the time between states after its receipt, but not before a step of mean cost is done. Infinity where the
  /// mean step needs more than that: there the wait is unavoidable and deadline() bounds it.
  double promptDeadline(double now_s) const;

  /// Usual cost of a step, wall time, s; 0 until one was seen.
  double stepCost() const { return cost_s_.value_or(0.0); }

 private:
  double max_lag_s_;
  std::optional<double> cost_s_;       ///< usual: soon knows that steps have become dearer
  std::optional<double> mean_cost_s_;  ///< over some sixty steps
  std::optional<double> last_received_s_;
  std::optional<double> apart_s_;  ///< mean time between moments, none counted for more than the bound
  double step_began_s_ = 0.0;
  double received_s_ = 0.0;
  double for_steps_s_;  ///< of the interval
  int steps_ = 1;       ///< of the interval
  int steps_left_ = 0;  ///< after the one that runs
};

}  // namespace tissue_contact
