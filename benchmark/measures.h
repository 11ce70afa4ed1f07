/// @file
/// Room `benchmark`: how wrong a run is, how fast it was, and which of many runs are worth having. Runs in; numbers out.
#pragma once

#include <vector>

#include "benchmark/run.h"

namespace tissue_contact {

/// Of a wrench w = (force, torque / lever), with the reference run's lever (0: of the force alone), over the samples that
/// both runs have.
struct WrenchError {
  double relative = 0.0;       ///< RMS of |w - w_ref| over RMS of |w_ref|; NaN when w_ref is 0 throughout
  double newtons = 0.0;        ///< RMS of |force - force_ref|, N
  double newton_metres = 0.0;  ///< RMS of |torque - torque_ref|, N m
  double reference_n = 0.0;    ///< RMS of |force_ref|, N
};

/// @param instrument -1: all of them. @throws std::invalid_argument when the runs were sampled at different times.
WrenchError wrenchError(const Run& run, const Run& reference, int instrument = -1);

/// Of one implicit step, s. Times that are not finite (a peer that went astray) are left out.
struct StepTimes {
  double median = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};
StepTimes stepTimes(std::vector<double> step_s);

/// Indices of the points that no other point beats, by ascending time: the next one is slower and has less error. Points
/// that are not finite are left out.
std::vector<std::size_t> paretoFront(const std::vector<double>& times, const std::vector<double>& errors);

/// Whether (time, error) is on the front: no point is faster by more than `noise` (a share of its time: what wall times
/// vary by) without more error.
bool onFront(double time, double error, const std::vector<double>& times, const std::vector<double>& errors,
             double noise);

/// What is left of the error of the finest of two meshes or steps, from the difference of the two, for an error that goes
/// as size^order: difference / (ratio^order - 1). @param ratio of the sizes, > 1.
double richardsonError(double difference, double ratio, double order);

}  // namespace tissue_contact
