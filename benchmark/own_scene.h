/// @file
/// Room `benchmark`: the wrench error of a user's own scene on a user's own recording.
#pragma once

#include <ostream>
#include <string>

#include "benchmark/recording.h"

namespace tissue_contact {

struct OwnSceneOptions {
  std::string scene_file;
  std::string bag_file;
  std::string urdf_file;  ///< empty: no scene parameter holds a URDF
  TimeWindow window;
};

/// Runs the scene as it is, solved to convergence, with half the step and with finer generated meshes; prints the error
/// of each, per instrument, what dominates and what to change.
/// @param bar for progress; null: none. @return whether there was contact, so that errors could be told.
/// @throws std::exception for files that cannot be used.
bool reportOwnScene(const OwnSceneOptions& options, std::ostream& out, std::ostream* bar);

}  // namespace tissue_contact
