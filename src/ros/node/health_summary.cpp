/// @file
/// Room `ros`, private: what Health tells in /diagnostics and, a few times at most, in the log: the diagnostics thread's part.
#include <ros/console.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "ros/node/diagnostic_figures.h"
#include "ros/node/health.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/ros/environment.h"

namespace tissue_contact {

/// The largest since the last call: of wrenches that went out, and of one that is still due.
double Health::worstLag(const LiveFigures& figures) {
  const std::lock_guard<std::mutex> lock(mutex_);
  double worst = std::exchange(worst_lag_s_, 0.0);
  if (working_on_s_ || figures.waiting > 0) worst = std::max(worst, figures.lag_s);
  return worst;
}

void Health::fill(std::int64_t missing, diagnostic_updater::DiagnosticStatusWrapper& status) {
  const LiveFigures now = figures();
  const double worst_lag_s = worstLag(now);
  tellSilence();
  summarize(now, worst_lag_s, status);
  addFigures(now, worst_lag_s, status);
  status.add("joint states: missing by header.seq", missing);
  told_ = now;
}

void Health::tellSilence() {
  for (const std::string& line : silence_.look(inbox_.heard(player_.topics().size()), steadySeconds()))
    ROS_WARN_STREAM(line);
}

/// Under every_state nothing is played while a topic may still have something to say of that moment: for ever, where stamps go on by
/// answers to wrenches. Empty: something was played since the last look, or nothing waits for a topic.
std::string Health::heldText(const LiveFigures& now) {
  const bool is_held = !now.newest_state && !now.paused && !now.failed && now.held > 0 && now.held == now.waiting &&
                       told_.held > 0 && now.accepted() == told_.accepted();
  if (!is_held) {
    told_of_hold_ = false;
    return "";
  }
  const std::vector<std::optional<double>> heard = inbox_.heard(topics_.size());
  std::vector<std::string> silent;
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    constexpr double kUsual_s = 1.0;
    if (!heard[t] || steadySeconds() - *heard[t] > kUsual_s)
      silent.push_back(topics_[t] + (heard[t] ? "" : " (never heard)"));
  }
  std::string text = std::to_string(now.held) + " joint states wait for another topic; silent: " + listOf(silent);
  if (!std::exchange(told_of_hold_, true)) {
    ROS_WARN_STREAM(
        text << ": under every_state a moment waits for all topics until stamps have gone on by step.max_gap_s; "
                "publish there too, take that instrument out of the scene, or set step.joint_states: newest_state");
  }
  return text;
}

void Health::summarize(const LiveFigures& now, double worst_lag_s,
                       diagnostic_updater::DiagnosticStatusWrapper& status) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  const double bound_s = lagBound(now, max_lag_s_);
  const LagVerdict lag = judgeLag(worst_lag_s, bound_s);
  const auto two_clocks = static_cast<std::size_t>(Verdict::kTwoClocks);
  const bool is_strained = now.newest_state && now.lengthened > told_.lengthened;
  const bool is_implausible = now.implausible > told_.implausible;
  const bool is_troubled = now.troubles() > told_.troubles();
  const std::string unbearable = "forces that no tissue bears: " + now.last_implausible;
  if (now.failed) {
    status.summary(Level::ERROR, "has stopped: see the log");
  } else if (now.broken) {
    status.summary(Level::ERROR, "a step had no finite answer");
  } else if (now.by_verdict[two_clocks] > told_.by_verdict[two_clocks] + 1) {  // one may be an outlier
    status.summary(Level::ERROR, "two clocks on one topic: joint states of one of them are refused");
  } else if (now.paused) {
    status.summary(Level::OK, "paused by ~pause: " + std::to_string(now.waiting) + " joint states wait for ~resume");
  } else if (lag != LagVerdict::kWithinBound) {
    status.summaryf(lag == LagVerdict::kFarOverBound ? Level::ERROR : Level::WARN,
                    "wrenches late by up to %.3g s, more than %.3g s", worst_lag_s, bound_s);
    if (is_implausible) status.mergeSummary(Level::WARN, unbearable);
  } else if (is_implausible) {
    status.summary(Level::WARN, unbearable);
  } else if (now.coarse > told_.coarse) {
    status.summary(Level::WARN, now.last_coarse);
  } else if (is_strained) {
    status.summary(Level::WARN, "steps lengthened, since the machine does not keep up with max_step_s");
  } else {
    status.summary(Level::OK, now.accepted() > 0 ? "running" : "no joint state yet");
  }
  const std::string troubles =
      is_troubled && status.level != Level::ERROR ? "joint states refused or dropped, or motion cut short" : "";
  constexpr double kResetTold_s = 5.0;  // whoever looks a little later is to see why forces began anew
  if (now.resets > told_.resets) reset_told_until_s_ = steadySeconds() + kResetTold_s;
  const std::string reset =
      steadySeconds() < reset_told_until_s_ ? "time went backwards: the scene was reset to its start" : "";
  for (const std::string& also : {reset, troubles, now.ahead, silence_.summary(), now.silent_joints, heldText(now)}) {
    if (!now.failed && !now.paused && !also.empty()) status.mergeSummary(Level::WARN, also);
  }
  const auto waits = [](const LiveFigures& then) {
    return !then.newest_state && then.held > 0 && then.held == then.waiting;
  };
  const bool waits_for_topic = waits(now) || waits(told_);  // not for want of time; or did, and what was held is late
  if (!(now.step_cost_s > 0.0)) return;                     // in the first step
  if (now.paused || waits_for_topic || (lag == LagVerdict::kWithinBound && !is_strained)) return;
  if (!keep_up_news_.take(now.step_cost_s, nodes_)) return;
  ROS_WARN_STREAM("does not keep up: " << keepUpAdvice(now, simulator_.scene().step.max_step_s, max_lag_s_, nodes_));
}

}  // namespace tissue_contact
