/// @file
/// Room `ros`, private: the figures of a live run, and what they say. No ROS and no clock inside.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

/// Counts since start-up. received = dropped + waiting + accepted + merged + refused, once no state is on its way between
/// the threads.
struct LiveFigures {
  std::int64_t received = 0;
  std::int64_t dropped = 0;  ///< the queue of those received was full
  std::int64_t waiting = 0;  ///< received and not yet played; also for another topic
  std::int64_t held = 0;     ///< of those, for another topic or a clock
  std::int64_t merged = 0;   ///< into the motion to a newer one
  std::array<std::int64_t, kVerdictCount> by_verdict{};
  std::int64_t resets = 0;  ///< because time went backwards
  std::int64_t gaps = 0;
  std::int64_t jumps = 0;          ///< intervals in which an instrument moved too far for sub-stepping
  std::int64_t not_finite = 0;     ///< intervals whose result was not finite
  std::int64_t not_converged = 0;  ///< intervals whose last step missed the tolerance
  std::int64_t out_of_time = 0;    ///< of those, intervals that stopped for want of time
  std::int64_t lengthened = 0;     ///< intervals whose steps were longer than step.max_step_s
  std::int64_t steps = 0;
  std::int64_t wrenches = 0;
  std::int64_t snapshots_dropped = 0;  ///< meshes, contacts, status, markers not published: nobody took them in time
  std::string last_not_converged = "never";
  std::string ahead;          ///< of a topic that only updates, and what to do about it; empty: none is (aheadText())
  std::string silent_joints;  ///< of which none comes any longer, while others do on their topic; empty: all come
  std::int64_t implausible = 0;  ///< intervals that ended with loads that no tissue bears
  std::string last_implausible = "never";
  double law_error = 0.0;           ///< of the last interval, likely and relative
  double largest_law_error = 0.0;   ///< by size
  double largest_law_strain = 0.0;  ///< that goes with it
  std::string inaccurate = "none";  ///< instrument whose force has the largest likely error, lately
  double force_error_n = 0.0;       ///< of that force
  double inaccurate_force_n = 0.0;  ///< its size
  double largest_force_error_n = 0.0;
  double coarse_cells = 1.0;          ///< factor by which refined cells are longer than asked for, now
  double coarsest_cells = 1.0;        ///< the largest of it
  std::int64_t coarse = 0;            ///< intervals that ended with such cells
  std::string last_coarse = "never";  ///< what is to be done about them
  std::int64_t pinched = 0;           ///< intervals whose last step left out contacts without room
  bool broken = false;                ///< not finite since the last reset

  bool failed = false;         ///< the stepping thread has ended by itself
  bool paused = false;         ///< by ~pause
  bool newest_state = false;   ///< policy: else every state
  double lag_s = 0.0;          ///< of the last wrench behind the receipt of its state; of a step that runs, so far
  double largest_lag_s = 0.0;  ///< of any wrench
  double behind_s = 0.0;       ///< message time received and not yet played
  double step_cost_s = 0.0;    ///< usual wall time of a step
  double simulated_s = 0.0;    ///< message time simulated
  double real_time_factor = 0.0;

  std::int64_t accepted() const { return by_verdict[static_cast<std::size_t>(Verdict::kAccepted)]; }  ///< stepped to
  std::int64_t refused() const;
  /// What deserves a warning when there is more of it.
  std::int64_t troubles() const { return refused() + dropped + gaps + jumps + not_finite; }
};

/// Of a lag, by the bound for it.
enum class LagVerdict { kWithinBound, kOverBound, kFarOverBound };

/// How late wrenches may be, s: step.max_lag_s where the newest state counts; a second where every state does, since
/// nobody waits for the answer then, but a lag that grows shows a machine that does not keep up.
double lagBound(const LiveFigures& figures, double max_lag_s);
LagVerdict judgeLag(double lag_s, double bound_s);

/// How long a step may be that is not lengthened, s: step.max_step_s; where the newest state counts a quarter more, since
/// the stamps of a driver that runs at 1 / max_step_s jitter, and cutting such intervals in two would double the work.
double longestStep(bool newest_state, double max_step_s);

/// What a user can change, with the figures measured, when the machine does not keep up.
/// @param max_step_s, max_lag_s of the scene.
/// @param nodes of all tissues.
std::string keepUpAdvice(const LiveFigures& figures, double max_step_s, double max_lag_s, int nodes);

/// When keepUpAdvice() is news: at first, and when steps cost, or nodes are, several times what they were when it was told last, such as after
/// the first contact. A few times at the most.
class KeepUpNews {
 public:
  /// Of a machine that does not keep up. @return whether it is to be told now.
  bool take(double step_cost_s, int nodes);

 private:
  int told_ = 0;
  double step_cost_s_ = 0.0;  ///< told last
  int nodes_ = 0;
};

/// "joint states: 100 received, 90 accepted, ...; 90 wrenches; largest lag 0.012 s".
std::string countsLine(const LiveFigures& figures);

}  // namespace tissue_contact
