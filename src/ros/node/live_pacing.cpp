#include "ros/node/live_pacing.h"

#include <algorithm>
#include <limits>

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
constexpr double kWeightInMean = 1.0 / 64.0;
/// Of the time between states, for the steps of one; the rest is to publish its wrench and to make up for what waited.
constexpr double kShareOfTimeApart = 0.8;

/// Running mean.
void note(double value, double weight, std::optional<double>& mean) {
  mean = mean ? *mean + weight * (value - *mean) : value;
}

}  // namespace

LivePacing::LivePacing(double max_lag_s) : max_lag_s_(max_lag_s), for_steps_s_(kShareOfSteps * max_lag_s) {}

double LivePacing::waitUntil(double received_s) const { return received_s + JointStatePlayer::kWaitShare * max_lag_s_; }

void LivePacing::notePlayed(double received_s) {
  if (last_received_s_) note(std::clamp(received_s - *last_received_s_, 0.0, max_lag_s_), kWeightInMean, apart_s_);
  last_received_s_ = std::max(received_s, last_received_s_.value_or(received_s));
}

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
  steps_ = std::max(1, most > 0 ? std::min(steps, most) : steps);
  steps_left_ = steps_ - 1;
}

void LivePacing::noteStep(double now_s) {
  const double cost = std::max(0.0, now_s - step_began_s_);
  note(cost, cost > cost_s_.value_or(cost) ? kWeightOfDearer : kWeightOfCheaper, cost_s_);
  note(cost, kWeightInMean, mean_cost_s_);
  step_began_s_ = now_s;
  steps_left_ = std::max(0, steps_left_ - 1);
}

double LivePacing::deadline(double now_s) const {
  const double left = received_s_ + kShareOfDeadline * max_lag_s_ - steps_left_ * stepCost();
  const double least = now_s + std::min(cost_s_.value_or(max_lag_s_), kShareOfSteps * max_lag_s_);
  return std::max(left, least);
}

double LivePacing::promptDeadline(double now_s) const {
  const double mean_cost = mean_cost_s_.value_or(0.0);
  const double most = kShareOfTimeApart * apart_s_.value_or(0.0);
  if (!apart_s_ || !mean_cost_s_ || steps_ * mean_cost > most) return std::numeric_limits<double>::infinity();
  return std::max(received_s_ + most - steps_left_ * mean_cost, now_s + mean_cost);
}

}  // namespace tissue_contact
