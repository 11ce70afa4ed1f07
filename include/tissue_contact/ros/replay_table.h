/// @file
/// Room `ros`: the CSV file of an offline replay.
#pragma once

#include <fstream>
#include <string>

#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Writes to `<file>.part` and renames it when complete, so that `file` is never half a result. Numbers have as many
/// digits as a double needs to be read back to the same bits; stamps are exact to the nanosecond.
class ReplayTable {
 public:
  /// Opens the part file and writes the header line. @throws std::runtime_error when it cannot be written.
  explicit ReplayTable(std::string file);
  /// Removes the part file unless it was committed.
  ~ReplayTable();
  ReplayTable(const ReplayTable&) = delete;
  ReplayTable& operator=(const ReplayTable&) = delete;

  /// One line per instrument of an accepted sample: stamp, tip pose in the world frame, wrench in the tip frame,
  /// contacts of this instrument per state, residuals of the last step over all contacts, 0 or 1 for `discarded` and
  /// `jumped` of the interval that ended here (see StepReport), wall time per step.
  void add(const Simulator& simulator, const PlayedSample& played, double step_time_s);

  /// @throws std::runtime_error when the file could not be written completely.
  void commit();

 private:
  void addInstrument(const Simulator& simulator, int instrument);

  std::string file_;
  std::string part_;
  std::ofstream stream_;
  bool committed_ = false;
};

}  // namespace tissue_contact
