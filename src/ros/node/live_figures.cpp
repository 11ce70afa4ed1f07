#include "ros/node/live_figures.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numeric>
#include <sstream>

namespace tissue_contact {

std::int64_t LiveFigures::refused() const {
  return std::accumulate(by_verdict.begin() + 1, by_verdict.end(), std::int64_t{0});
}

double lagBound(const LiveFigures& figures, double max_lag_s) {
  constexpr double kPatience = 1.0;
  return figures.newest_state ? max_lag_s : std::max(max_lag_s, kPatience);
}

double longestStep(bool newest_state, double max_step_s) {
  constexpr double kJitter = 1.25;
  return newest_state ? kJitter * max_step_s : max_step_s;
}

LagVerdict judgeLag(double lag_s, double bound_s) {
  constexpr double kFar = 5.0;
  if (lag_s > kFar * bound_s) return LagVerdict::kFarOverBound;
  return lag_s > bound_s ? LagVerdict::kOverBound : LagVerdict::kWithinBound;
}

std::string keepUpAdvice(const LiveFigures& figures, double max_step_s, double max_lag_s, int nodes) {
  // Steps may be shorter than max_step_s where joint states come faster; those that were lengthened do not count.
  const double taken_per_s = figures.simulated_s > 0.0 ? static_cast<double>(figures.steps) / figures.simulated_s : 0.0;
  const double wanted_per_s = std::max(1.0 / max_step_s, taken_per_s);
  const double work = figures.step_cost_s * wanted_per_s;
  std::ostringstream text;
  text << std::setprecision(3) << "a step costs " << 1e3 * figures.step_cost_s << " ms and "
       << std::lround(wanted_per_s) << " steps per second of motion are asked for: " << work
       << " s of work per second. ";
  if (work < 1.0) {
    text << "That fits, so something else keeps the processor busy, or a recording is played faster. ";
  }
  if (figures.newest_state) {
    text << "Steps are taken longer, and solved less exactly, so that wrenches lag by no more than step.max_lag_s ("
         << max_lag_s << " s)";
  } else {
    text << "No joint state is skipped, so wrenches lag by " << figures.lag_s << " s now and " << figures.waiting
         << " joint states wait; play more slowly, or for a robot set step.joint_states: newest_state";
  }
  text << ". To keep up: a coarser mesh away from the instrument (" << nodes
       << " nodes now), a larger step.max_step_s (" << max_step_s
       << " s), fewer solver.iterations or a solver.time_budget_s of " << 0.5 / wanted_per_s << " s";
  return text.str();
}

bool KeepUpNews::take(double step_cost_s, int nodes) {
  constexpr int kMost = 5;
  constexpr double kGrowth = 3.0;  // less is what a busy machine makes of the same step
  const bool has_grown = step_cost_s >= kGrowth * step_cost_s_ || nodes >= kGrowth * nodes_;
  if (told_ >= kMost || (told_ > 0 && !has_grown)) return false;
  ++told_;
  step_cost_s_ = std::max(step_cost_s_, step_cost_s);
  nodes_ = std::max(nodes_, nodes);
  return true;
}

std::string countsLine(const LiveFigures& figures) {
  std::ostringstream text;
  text << "joint states: " << figures.received << " received, " << figures.accepted() << " accepted, " << figures.merged
       << " merged, " << figures.dropped << " dropped, " << figures.refused() << " refused";
  const char* separator = " (";
  for (int v = 1; v < kVerdictCount; ++v) {
    const std::int64_t count = figures.by_verdict[static_cast<std::size_t>(v)];
    if (count == 0) continue;
    text << separator << count << ' ' << verdictText(static_cast<Verdict>(v));
    separator = ", ";
  }
  if (figures.refused() > 0) text << ')';
  text << ", " << figures.waiting << " waiting; " << figures.wrenches << " wrenches published, " << figures.resets
       << " resets, largest lag " << std::setprecision(3) << figures.largest_lag_s << " s";
  return text.str();
}

}  // namespace tissue_contact
