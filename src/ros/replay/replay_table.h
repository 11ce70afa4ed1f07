/// @file
/// Room `ros`, private: the CSV files of an offline replay.
#pragma once

#include <cstdint>
#include <string>

#include "tissue_contact/core/whole_file.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Wrenches, contacts and residuals: the same bytes whenever the same bag is replayed over the same scene. Stamps are
/// exact to the nanosecond.
class ReplayTable : public WholeFile {
 public:
  /// Writes the header line.
  explicit ReplayTable(const std::string& file);

  /// One line per instrument of an accepted sample: stamp, tip pose in the world frame, wrench in the tip frame,
  /// contacts of this instrument per state, residuals of the last step over all contacts, 0 or 1 for `discarded` and
  /// `jumped` of the interval that ended here, what its loads were like (see StepReport, ImplausibleLoad), and
  /// how long was simulated since the start or a reset.
  /// @param steps implicit steps of that interval; 0: there was none, so nothing was discarded and nothing jumped.
  void add(const Simulator& simulator, const PlayedSample& played, long steps);

 private:
  double simulated_s_ = 0.0;  ///< since the start or a reset
};

/// Wall times, which differ from run to run.
class TimingTable : public WholeFile {
 public:
  /// Writes the header line.
  explicit TimingTable(const std::string& file);

  /// One line per simulated interval: stamp of its end, mean wall time per implicit step, number of steps (> 0).
  void add(std::int64_t stamp_ns, double elapsed_s, long steps);
};

}  // namespace tissue_contact
