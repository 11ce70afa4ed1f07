/// @file
/// Room `benchmark`: what dominates the error of a user's own scene, and which setting to change. Measured errors in;
/// words out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "benchmark/run.h"

namespace tissue_contact {

/// One way of being wrong: what changing it once did to the wrench, and what is left to change.
struct ErrorSource {
  std::string name;       ///< "solver", "step", "mesh"
  double change = 0.0;    ///< relative wrench difference that was measured
  double estimate = 0.0;  ///< of the whole error that comes from it
  std::string remedy;     ///< the scene key and its new value; empty: none was found
  double cost = 0.0;      ///< wall time with the remedy over that without
};

/// Below this no source is worth an advice: models of tissue are not known to a per cent.
constexpr double kSmallError = 0.01;

struct ErrorVerdict {
  std::string summary;  ///< one sentence
  int dominating = -1;  ///< index into the sources; -1: none of them matters
};

/// @param sources at least one; estimates that are not finite count as not measured.
ErrorVerdict judgeErrors(const std::vector<ErrorSource>& sources);

/// The scene with `factor` times as many cells in every generated block and sheet; none when there is no such tissue, or
/// its meshes would have more than `most_nodes` nodes.
std::optional<Scene> refinedScene(const Scene& scene, double factor, double most_nodes);

/// "name: cells: [a, b, c]" of every generated mesh.
std::string cellsText(const Scene& scene);

}  // namespace tissue_contact
