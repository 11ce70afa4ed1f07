#include "ros/node/diagnostic_figures.h"

#include <cstddef>
#include <string>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

void addFigures(const LiveFigures& figures, double worst_lag_s, diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.add("policy", figures.newest_state ? "newest_state" : "every_state");
  status.add("lag_s", worst_lag_s);
  status.add("largest lag_s", figures.largest_lag_s);
  status.add("real_time_factor", figures.real_time_factor);
  status.add("step cost_s", figures.step_cost_s);
  status.add("joint states: received", figures.received);
  for (int v = 0; v < kVerdictCount; ++v) {
    status.add(std::string("joint states: ") + verdictText(static_cast<Verdict>(v)),
               figures.by_verdict[static_cast<std::size_t>(v)]);
  }
  status.add("joint states: merged", figures.merged);
  status.add("joint states: dropped", figures.dropped);
  status.add("joint states: waiting", figures.waiting);
  status.add("joint states: behind_s", figures.behind_s);
  status.add("wrenches published", figures.wrenches);
  status.add("steps", figures.steps);
  status.add("intervals with lengthened steps", figures.lengthened);
  status.add("resets", figures.resets);
  status.add("gaps", figures.gaps);
  status.add("jumps", figures.jumps);
  status.add("intervals without a finite answer", figures.not_finite);
  status.add("intervals not converged", figures.not_converged);
  status.add("intervals out of time", figures.out_of_time);
  status.add("last not converged", figures.last_not_converged);
  status.add("intervals with forces that no tissue bears", figures.implausible);
  status.add("last of them", figures.last_implausible);
  status.add("law error, likely", figures.law_error);
  status.add("largest law error, likely", figures.largest_law_error);
  status.add("strain under the tool at that", figures.largest_law_strain);
  status.add("likely force error_n", figures.force_error_n);
  status.add("likely force error: its force_n", figures.inaccurate_force_n);
  status.add("likely force error: instrument", figures.inaccurate);
  status.add("largest likely force error_n", figures.largest_force_error_n);
  status.add("refined cells, times longer than asked for", figures.coarse_cells);
  status.add("largest of that", figures.coarsest_cells);
  status.add("intervals with such cells", figures.coarse);
  status.add("intervals with pinched contacts", figures.pinched);
  status.add("snapshots dropped", figures.snapshots_dropped);
}

}  // namespace tissue_contact
