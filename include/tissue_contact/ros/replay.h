/// @file
/// Room `ros`: offline replay: a bag and a scene in, a CSV file out. No roscore.
#pragma once

#include "tissue_contact/ros/replay_options.h"

namespace tissue_contact {

/// Plays every joint state of the bag and writes the CSV file; progress and a summary go to stderr.
/// @throws std::exception saying what is wrong: a scene, bag or URDF that cannot be read, a bag without the scene's
///   topics or without one acceptable joint state, a wrench that is not finite, a file that cannot be written.
void replay(const ReplayOptions& options);

/// main() of tissue_contact_replay. @return exit code: 0, or 1 after one message on stderr.
int runReplay(int argc, char** argv);

}  // namespace tissue_contact
