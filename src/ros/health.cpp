/// @file
/// Room `ros`: see health.h.
#include "tissue_contact/ros/health.h"

#include <ros/console.h>

#include <sstream>

#include "tissue_contact/ros/conversions.h"

namespace tissue_contact {

bool Health::Throttle::pass() {
  constexpr std::chrono::seconds kPeriod(5);
  const Clock::time_point now = Clock::now();
  if (last_ && now - *last_ < kPeriod) return false;
  last_ = now;
  return true;
}

bool Health::note(const PlayedSample& played, bool stepped) {
  warn(played);
  if (played.verdict != Verdict::kAccepted) return false;
  if (played.was_reset) broken_ = false;
  const bool finite = isFinite(simulator_);
  if (stepped) noteStep(played, finite);
  return finite;
}

void Health::warn(const PlayedSample& played) {
  if (played.verdict != Verdict::kAccepted) {
    if (refusals_[static_cast<std::size_t>(played.verdict)].pass()) {
      ROS_WARN_STREAM("joint state ignored (" << verdictText(played.verdict) << "): " << played.detail);
    }
    return;
  }
  const std::string& topic = player_.topics()[static_cast<std::size_t>(played.topic)];
  if (played.was_reset) {
    ROS_WARN_STREAM("time went backwards on " << topic << " to " << toTime(played.stamp_ns)
                                              << " s: the scene was reset to its start");
  }
  if (played.was_gap && gaps_.pass()) {
    ROS_WARN_STREAM("no joint state for more than max_gap_s before " << topic << " at " << toTime(played.stamp_ns)
                                                                     << " s: simulated as "
                                                                     << simulator_.scene().step.max_gap_s << " s");
  }
}

void Health::noteStep(const PlayedSample& played, bool finite) {
  const StepReport& report = simulator_.report();
  if (report.jumped) {
    ++jump_count_;
    if (jumps_.pass()) {
      ROS_WARN_STREAM("an instrument moved too far before " << toTime(played.stamp_ns)
                                                            << " s to be swept: it was placed at its new position");
    }
  }
  if (report.stop != StopReason::kTolerance) {
    ++not_converged_count_;
    std::ostringstream text;
    text << toTime(played.stamp_ns) << " s: momentum " << report.residuals.momentum << ", penetration "
         << report.residuals.penetration_m << " m, cone " << report.residuals.cone_violation_n << " N after "
         << report.iterations << " iterations";
    last_not_converged_ = text.str();
  }
  if (!report.discarded && finite) return;
  ++not_finite_count_;
  if (!broken_) {
    ROS_ERROR_STREAM("a step of the interval ending at "
                     << toTime(played.stamp_ns) << " s had no finite answer; "
                     << (finite ? "the tissues were stopped where they were and its contact forces, so also the wrench "
                                  "if it was the last step, are zero"
                                : "nothing is published for it")
                     << ". Look for very stiff or very light tissue, or lower step.max_step_s");
  }
  broken_ = true;
}

std::int64_t Health::troubles() const {
  std::int64_t sum = player_.gaps() + jump_count_ + not_finite_count_;
  for (int v = 1; v < kVerdictCount; ++v) sum += player_.count(static_cast<Verdict>(v));
  return sum;
}

void Health::fill(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  const std::int64_t sum = troubles();
  const bool any_new = sum > troubles_told_;
  troubles_told_ = sum;
  if (broken_) {
    status.summary(Level::ERROR, "a step had no finite answer");
  } else if (any_new) {
    status.summary(Level::WARN, "joint states refused, or motion cut short");
  } else {
    status.summary(Level::OK, player_.count(Verdict::kAccepted) > 0 ? "running" : "no joint state yet");
  }
  for (int v = 0; v < kVerdictCount; ++v) {
    const auto verdict = static_cast<Verdict>(v);
    status.add(std::string("joint states: ") + verdictText(verdict), player_.count(verdict));
  }
  status.add("resets", player_.resets());
  status.add("gaps", player_.gaps());
  status.add("jumps", jump_count_);
  status.add("intervals without a finite answer", not_finite_count_);
  status.add("intervals not converged", not_converged_count_);
  status.add("last not converged", last_not_converged_);
}

}  // namespace tissue_contact
