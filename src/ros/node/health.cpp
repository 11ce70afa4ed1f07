#include "ros/node/health.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "ros/conversions.h"
#include "ros/joint_watch.h"
#include "tissue_contact/ros/environment.h"

namespace tissue_contact {
namespace {

int nodesOf(const Simulator& simulator) {
  int nodes = 0;
  for (const Tissue& tissue : simulator.tissues()) nodes += tissue.nodeCount();
  return nodes;
}

std::vector<bool> triggering(const JointStatePlayer& player) {
  std::vector<bool> triggers;
  for (std::size_t t = 0; t < player.topics().size(); ++t) triggers.push_back(player.triggers(static_cast<int>(t)));
  return triggers;
}

}  // namespace

Health::Health(const Simulator& simulator, const JointStatePlayer& player, const JointStateInbox& inbox,
               std::vector<std::string> topics)
    : simulator_(simulator),
      player_(player),
      inbox_(inbox),
      nodes_(nodesOf(simulator)),
      max_lag_s_(simulator.scene().step.max_lag_s),
      topics_(topics),
      silence_(std::move(topics), triggering(player), longestSilence(simulator.scene().step.max_gap_s)) {}

bool Health::Throttle::pass() {
  constexpr std::chrono::seconds kPeriod(5);
  const Clock::time_point now = Clock::now();
  if (!began_ || now - *began_ >= kPeriod) {
    began_ = now;
    passed_ = 0;
  }
  return passed_++ < most_;
}

void Health::noteWork(std::optional<double> received_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  working_on_s_ = received_s;
  held_by_player_ = player_.waiting();
}

bool Health::note(const PlayedSample& played, int steps, double step_cost_s) {
  warn(played, steps);
  const bool accepted = played.verdict == Verdict::kAccepted;
  const bool finite = accepted && isFinite(simulator_);
  if (accepted) nodes_ = nodesOf(simulator_);
  const std::string not_converged = accepted && steps > 0 ? notConvergedText(played) : std::string();
  const std::string ahead = accepted ? aheadText(player_, simulator_.scene().step.max_gap_s) : std::string();
  std::unique_lock<std::mutex> lock(mutex_);
  for (int v = 0; v < kVerdictCount; ++v) {
    figures_.by_verdict[static_cast<std::size_t>(v)] = player_.count(static_cast<Verdict>(v));
  }
  figures_.merged = player_.merged();
  figures_.gaps = player_.gaps();
  held_by_player_ = player_.waiting();
  figures_.step_cost_s = step_cost_s;
  if (!accepted) return false;
  if (played.was_reset) {
    figures_.broken = false;
    ++figures_.resets;  // not those that were asked for, which the player counts too
  }
  played_stamp_ns_ = played.stamp_ns;
  figures_.ahead = ahead;
  if (!not_converged.empty()) figures_.last_not_converged = not_converged;
  const bool is_newly_broken = steps > 0 && noteSteps(played, steps, finite);
  lock.unlock();  // a log that blocks must not hold up those who ask for the figures
  if (is_newly_broken) tellBroken(played, finite);
  return finite;
}

void Health::warn(const PlayedSample& played, int steps) {
  if (played.verdict != Verdict::kAccepted) {
    if (refusals_[static_cast<std::size_t>(played.verdict)].pass()) {
      const bool name_publishers = played.verdict == Verdict::kTwoClocks && publishers_;
      ROS_WARN_STREAM("joint state ignored (" << verdictText(played.verdict) << "): " << played.detail
                                              << (name_publishers ? "; sent by " + publishers_(played.topic) : ""));
    }
    return;
  }
  const std::string& topic = player_.topics()[static_cast<std::size_t>(played.topic)];
  if (played.was_reset && resets_.pass()) {
    ROS_WARN_STREAM("time went backwards on " << topic << " to " << toTime(played.stamp_ns)
                                              << " s: the scene was reset to its start");
  }
  if (played.was_resumed && resumptions_.pass()) {
    ROS_WARN_STREAM("a stamp far off was followed on " << topic << ", which now goes on where it was, at "
                                                       << toTime(played.stamp_ns) << " s: so does the simulation");
  }
  if (!played.placed.empty() && placed_.pass()) ROS_WARN_STREAM(toTime(played.stamp_ns) << " s: " << played.placed);
  if (played.was_gap && gaps_.pass()) {
    ROS_WARN_STREAM("no joint state for more than max_gap_s before " << topic << " at " << toTime(played.stamp_ns)
                                                                     << " s: simulated as "
                                                                     << simulator_.scene().step.max_gap_s << " s");
  }
  if (played.was_reset) {
    law_alarm_ = LawAlarm();
    told_of_cells_ = false;
  }
  if (steps > 0) warnOfResult(played);  // else the report is that of an interval before, and told
}

void Health::warnOfResult(const PlayedSample& played) {
  if (simulator_.report().jumped && jumps_.pass()) {
    ROS_WARN_STREAM("an instrument moved too far before " << toTime(played.stamp_ns)
                                                          << " s to be swept: it was placed at its new position");
  }
  if (simulator_.report().implausible_load.found && implausible_loads_.pass()) {
    ROS_WARN_STREAM(toTime(played.stamp_ns) << " s: " << implausibleLoadText(simulator_));
  }
  if (law_alarm_.leaves(simulator_.report().law_error.relative) && laws_left_.pass()) {
    ROS_WARN_STREAM(toTime(played.stamp_ns) << " s: " << lawErrorText(simulator_));
  }
  if (simulator_.report().coarse_cells.tissue >= 0 && !std::exchange(told_of_cells_, true)) {
    ROS_WARN_STREAM(toTime(played.stamp_ns) << " s: " << coarseCellsText(simulator_));
  }
}

/// What is left of an interval that missed its tolerance; empty where none did, and mostly where many do: the residuals are computed
/// before the wrench goes out, in just the steps that are late already.
std::string Health::notConvergedText(const PlayedSample& played) {
  const StepReport& report = simulator_.report();
  if (report.stop == StopReason::kTolerance || !not_converged_.pass()) return {};
  const Residuals& residuals = simulator_.residuals();
  std::ostringstream text;
  text << toTime(played.stamp_ns) << " s: momentum " << residuals.momentum << ", all nodes together "
       << residuals.net_defect_n_s << " N s, penetration " << residuals.penetration_m << " m, cone "
       << residuals.cone_violation_n << " N after " << report.iterations << " iterations";
  return text.str();
}

/// What an interval with steps in it did to the figures. The lock is held.
/// @return whether an answer was not finite for the first time since the last reset.
bool Health::noteSteps(const PlayedSample& played, int steps, bool finite) {
  const StepReport& report = simulator_.report();
  figures_.steps += steps;
  figures_.simulated_s += report.advanced_s;
  real_time_factor_.note(steadySeconds(), report.advanced_s);
  constexpr double kRoundOff = 1e-9;  // of stamps, as a share of a step: such a step is no longer one
  if (report.advanced_s >
      (1.0 + kRoundOff) * steps * longestStep(figures_.newest_state, simulator_.scene().step.max_step_s))
    ++figures_.lengthened;
  if (report.jumped) ++figures_.jumps;
  if (report.pinched_contacts > 0) ++figures_.pinched;
  figures_.law_error = report.law_error.relative;
  if (std::abs(report.law_error.relative) > std::abs(figures_.largest_law_error)) {
    figures_.largest_law_error = report.law_error.relative;
    figures_.largest_law_strain = report.law_error.strain;
  }
  noteCells(report.coarse_cells);
  if (report.implausible_load.found) {
    ++figures_.implausible;
    std::ostringstream text;
    text << toTime(played.stamp_ns) << " s: " << implausibleLoadText(simulator_);
    figures_.last_implausible = text.str();
  }
  if (report.stop != StopReason::kTolerance) {
    ++figures_.not_converged;
    if (report.stop == StopReason::kTimeBudget) ++figures_.out_of_time;
  }
  if (!report.discarded && finite) return false;
  ++figures_.not_finite;
  return !std::exchange(figures_.broken, true);
}

/// The lock is held.
void Health::noteCells(const CoarseCells& cells) {
  figures_.coarse_cells = cells.factor;
  if (cells.tissue < 0) return;
  ++figures_.coarse;
  figures_.coarsest_cells = std::max(figures_.coarsest_cells, cells.factor);
  figures_.last_coarse = coarseCellsText(simulator_);
}

void Health::noteForceErrors(std::int64_t stamp_ns) {
  constexpr std::chrono::nanoseconds kPeriod(100'000'000);
  const Clock::time_point now = Clock::now();
  const bool is_soon_after = looked_at_force_errors_ && now - *looked_at_force_errors_ < kPeriod &&
                             std::abs(stamp_ns - looked_at_stamp_ns_) < kPeriod.count();
  if (is_soon_after) return;
  looked_at_force_errors_ = now;
  looked_at_stamp_ns_ = stamp_ns;
  if (!isFinite(simulator_.residuals())) return;
  const std::vector<ForceErrorEstimate>& errors = simulator_.forceErrors();
  if (errors.empty()) return;
  const auto is_less = [](const ForceErrorEstimate& a, const ForceErrorEstimate& b) {
    return a.total_n() < b.total_n();
  };
  const auto largest = std::max_element(errors.begin(), errors.end(), is_less);
  const auto instrument = static_cast<std::size_t>(largest - errors.begin());
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.inaccurate = simulator_.instruments()[instrument].name();
  figures_.force_error_n = largest->total_n();
  figures_.inaccurate_force_n = simulator_.wrench(static_cast<int>(instrument)).force.norm();
  figures_.largest_force_error_n = std::max(figures_.largest_force_error_n, figures_.force_error_n);
}

void Health::tellBroken(const PlayedSample& played, bool finite) {
  ROS_ERROR_STREAM("a step of the interval ending at "
                   << toTime(played.stamp_ns) << " s had no finite answer; "
                   << (finite ? "the tissues were stopped where they were and its contact forces, so also the wrench "
                                "if it was the last step, are zero"
                              : "nothing is published for it")
                   << ". Look for very stiff or very light tissue, or lower step.max_step_s");
}

void Health::noteWrenches(std::size_t count, std::optional<double> lag_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.wrenches += static_cast<std::int64_t>(count);
  if (!lag_s) return;
  figures_.lag_s = *lag_s;
  figures_.largest_lag_s = std::max(figures_.largest_lag_s, *lag_s);
  worst_lag_s_ = std::max(worst_lag_s_, *lag_s);
}

void Health::notePaused(bool paused) {
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.paused = paused;
}

void Health::noteFailure() {
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.failed = true;
}

void Health::noteReset() {
  law_alarm_ = LawAlarm();
  told_of_cells_ = false;
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.broken = false;
  figures_.ahead.clear();
}

void Health::tellBegunInContact() {
  if (!contacts_at_first_.pass()) return;
  ROS_WARN_STREAM(
      "an instrument touches tissue at its first joint state, and what it did to it before is missing: it is "
      "taken as undeformed there; begin, or reset, before it touches");
}

void Health::noteSnapshotsDropped(std::int64_t dropped) {
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.snapshots_dropped = dropped;
}

void Health::noteSilentJoints(const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.silent_joints = text;
  constexpr double kSaid_s = 2.0;  // of a topic that is silent as a whole, TopicSilence tells
  silent_joints_until_s_ = steadySeconds() + kSaid_s;
}

void Health::notePolicy(bool newest_state) {
  const std::lock_guard<std::mutex> lock(mutex_);
  figures_.newest_state = newest_state;
}

LiveFigures Health::figures() const {
  const JointStateInbox::Counts inbox = inbox_.counts();
  const double now_s = steadySeconds();
  const std::lock_guard<std::mutex> lock(mutex_);
  LiveFigures figures = figures_;
  if (now_s > silent_joints_until_s_) figures.silent_joints.clear();
  figures.received = inbox.received;
  figures.dropped = inbox.dropped;
  figures.held = held_by_player_;
  figures.waiting = static_cast<std::int64_t>(inbox.waiting) + figures.held;
  figures.real_time_factor = real_time_factor_.value(now_s);
  // A wrench that is due and has not gone out is late already.
  if (working_on_s_) figures.lag_s = std::max(figures.lag_s, now_s - *working_on_s_);
  if (!figures.newest_state && inbox.waiting > 0)
    figures.lag_s = std::max(figures.lag_s, now_s - inbox.oldest_received_s);
  if (inbox.waiting > 0)
    figures.behind_s = std::max(0.0, 1e-9 * static_cast<double>(inbox.newest_stamp_ns - played_stamp_ns_));
  return figures;
}

void Health::addTo(Status& status) const {
  const LiveFigures figures = this->figures();
  const auto count = [](std::int64_t value) { return static_cast<std::uint64_t>(value); };
  status.policy = figures.newest_state ? Status::POLICY_NEWEST_STATE : Status::POLICY_EVERY_STATE;
  status.lag = figures.lag_s;
  status.resets = count(figures.resets);
  status.real_time_factor = figures.real_time_factor;
  status.joint_states_received = count(figures.received);
  status.joint_states_dropped = count(figures.dropped);
  status.joint_states_waiting = count(figures.waiting);
  status.lengthened_intervals = count(figures.lengthened);
}

}  // namespace tissue_contact
