/// @file
/// Room `benchmark`: the stored truth of a scene: forces over time, extrapolated in mesh and step (benchmark/truth). File in;
/// Run out.
#pragma once

#include <string>

#include "benchmark/run.h"

namespace tissue_contact {

struct TruthTable {
  Run run;                   ///< the last instrument's force in tip axes, N; no torque
  double uncertainty = 0.0;  ///< relative, RMS over the run
  std::string how;           ///< in words
};

/// Reads lines "# key: value" (`uncertainty` and `how` are required), then the columns time_s, force_x_n, force_y_n,
/// force_z_n, times ascending.
/// @throws std::invalid_argument naming file and line.
TruthTable readTruthTable(const std::string& file);

/// The truth at the times of a run, none of which may be missing in the table; nothing on instruments before the last.
/// @throws std::invalid_argument naming the time.
Run truthAt(const TruthTable& truth, const Run& like);

}  // namespace tissue_contact
