/// @file
/// Room `ros`: see live_pacing.h.
#include "tissue_contact/ros/live_pacing.h"

#include <algorithm>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {
namespace {

constexpr double kShareOfSteps = 0.5;     ///< of the bound, for the steps of an interval by their usual cost
constexpr double kShareBySteps = 0.75;    ///< of the bound, for waiting and those steps together
constexpr double kShareOfDeadline = 0.9;  ///< of the bound, for a step that costs more; the rest is to publish it
/// Of the newest step in the running mean. Contact makes steps dearer at once, and that must be known before the bound is
/// missed; that they are cheap again may be learnt slowly.
constexpr double kWeightOfDearer = 1.0 / 4.0;
constexpr double kWeightOfCheaper = 1.0 / 16.0;

}  // namespace

LivePacing::LivePacing(double max_lag_s) : max_lag_s_(max_lag_s), for_steps_s_(kShareOfSteps * max_lag_s) {}

double LivePacing::waitUntil(double received_s) const { return received_s + JointStatePlayer::kWaitShare * max_lag_s_; }

int LivePacing::mostSteps() const {
  if (!cost_s_ || !(*cost_s_ > 0.0)) return 0;
  constexpr double kMost = 1e6;  // more than fit into any bound, and fit into an int
  return std::max(1, static_cast<int>(std::min(for_steps_s_ / *cost_s_, kMost)));
}

void LivePacing::begin(double now_s, double received_s, int steps) {
  step_began_s_ = now_s;
  received_s_ = received_s;
  for_steps_s_ = std::clamp(received_s + kShareBySteps * max_lag_s_ - now_s, 0.0, kShareOfSteps * max_lag_s_);
  const int most = mostSteps();
  steps_left_ = std::max(0, (most > 0 ? std::min(steps, most) : steps) - 1);
}

void LivePacing::noteStep(double now_s) {
  const double cost = std::max(0.0, now_s - step_began_s_);
  const double mean = cost_s_.value_or(cost);
  cost_s_ = mean + (cost > mean ? kWeightOfDearer : kWeightOfCheaper) * (cost - mean);
  step_began_s_ = now_s;
  steps_left_ = std::max(0, steps_left_ - 1);
}

double LivePacing::deadline(double now_s) const {
  const double left = received_s_ + kShareOfDeadline * max_lag_s_ - steps_left_ * stepCost();
  const double least = now_s + std::min(cost_s_.value_or(max_lag_s_), kShareOfSteps * max_lag_s_);
  return std::max(left, least);
}

}  // namespace tissue_contact
