/// @file
/// Room `ros/replay`, private: the likely errors of the force on one instrument over a recording. Forces with their estimates in; a line
/// for the log out.
#pragma once

#include <string>

#include "tissue_contact/simulation/force_error.h"

namespace tissue_contact {

class ForceErrorSummary {
 public:
  void add(double force_n, const ForceErrorEstimate& error);
  /// "likely wrong by 3.4 % (...": RMS of the errors and of their parts over RMS of the force, and what to do about the largest part
  /// where they are a tenth or more; and where the force mostly moves tissue that swings, that more may be wrong. Empty: no force.
  std::string text() const;

 private:
  double force_ = 0.0, total_ = 0.0, mesh_ = 0.0, step_ = 0.0, solver_ = 0.0, inertia_ = 0.0;  ///< sums of squares, N^2
  bool knows_mesh_ = true;
};

}  // namespace tissue_contact
