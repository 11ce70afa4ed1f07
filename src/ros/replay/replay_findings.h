/// @file
/// Room `ros/replay`, private: what went on in the intervals of a recording. Played joint states in; counts, a warning at the first
/// of each kind and a summary for the log out.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "ros/replay/force_error_summary.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/law_error.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

class ReplayFindings {
 public:
  /// @param simulator, log must outlive this; `simulator` is looked at when something is noted.
  /// @param prefix of each line in the log.
  ReplayFindings(const Simulator& simulator, std::ostream& log, std::string prefix);

  /// After each joint state taken.
  /// @param steps that it took.
  void note(const PlayedSample& played, long steps);
  /// After each accepted one with a finite answer.
  void noteForceErrors(const PlayedSample& played);

  /// Why the first joint state that was not accepted was not; empty: all were.
  const std::string& firstRefusal() const { return first_refusal_; }
  /// For the manifest, each with its name.
  std::vector<std::pair<std::string, long>> counts() const;
  /// The same in a sentence: "3 jumps, 0 intervals not converged, ...".
  std::string countsText() const;
  /// Lines on how far compliant joints gave way, on likely errors of forces, on a law beyond its range, on coarse cells and on contacts that are not solved to the end, where there is
  /// something to tell.
  void summarize() const;

 private:
  void noteLaw(const PlayedSample& played);
  void noteCells(const PlayedSample& played);
  void warn(const PlayedSample& played, const std::string& text);
  void summarizeForceErrors() const;
  void summarizeLaw() const;
  void summarizeCells() const;
  void summarizeUnsolved() const;
  void summarizeJoints() const;

  const Simulator& simulator_;
  std::ostream& log_;
  std::string prefix_;
  std::string first_refusal_;
  long jumps_ = 0;
  long discarded_ = 0;
  long not_converged_ = 0;
  /// Intervals, and of these those whose last step ended with the last iteration allowed.
  struct Solved {
    long all = 0;
    long not_converged = 0;

    void add(const StepReport& report) {
      ++all;
      not_converged += static_cast<long>(report.stop == StopReason::kIterations);
    }
    bool atLeast(double share) const;
  };
  Solved touching_;  ///< with a contact that carries force
  Solved sticking_;  ///< in which static friction held something
  long implausible_ = 0;
  long pinched_ = 0;
  std::vector<ForceErrorSummary> force_errors_;  ///< per instrument
  std::vector<VectorX> gave_way_;                ///< per instrument: most of each joint (Simulator::jointDeflections)
  LawAlarm law_alarm_;
  long law_alarms_ = 0;  ///< how often the law left its range
  LawError law_error_;   ///< largest
  long coarse_ = 0;      ///< intervals with cells longer than asked for
  CoarseCells coarsest_cells_;
};

}  // namespace tissue_contact
