/// @file
/// Room `benchmark`: results as a CSV file and as a summary for people.
#pragma once

#include <cstddef>
#include <limits>
#include <ostream>
#include <string>

#include "benchmark/sweep.h"

namespace tissue_contact {

/// One line per run, one column per number; empty where there is none. Times in ms, errors relative.
void writeCsv(const SceneResult& result, std::ostream& out);

/// Truth and its own error, the Pareto front at the shipped mesh and step, whether the shipped settings lie on it, the
/// peer, growth over meshes.
void printSummary(const SceneResult& result, std::ostream& out);

/// Whether a wall time may be called smaller than another: medians of repeated runs differ by this share on a machine
/// that does other things as well.
constexpr double kTimeNoise = 0.1;

/// What the Pareto front says about the shipped settings.
struct FrontVerdict {
  bool on_front = false;
  bool found_better = false;  ///< false although not on the front: its numbers are not finite
  std::size_t better = 0;     ///< index into the rows: the fastest with no more error; meaningful if found_better
};
FrontVerdict judgeShipped(const SceneResult& result);

/// Against the peer: our fastest run with no more error, over wall time per simulated second.
struct PeerVerdict {
  bool found = false;
  std::size_t ours = 0;
  double times_faster = 0.0;
};
/// @param same_mesh by the error against the converged run of the same mesh and step, among our runs there; else by the
///   total error, among all our runs.
PeerVerdict judgePeer(const SceneResult& result, const BenchmarkRow& peer, bool same_mesh);

}  // namespace tissue_contact
