/// @file
/// Room `ros`, private: offline replay: a bag and a scene in, a CSV file out. No roscore.
#pragma once

#include <string>
#include <vector>

namespace tissue_contact {

struct ReplayOptions {
  std::string scene_file;
  std::string bag_file;
  std::string csv_file;
  std::string urdf_file;  ///< empty: no scene parameter holds a URDF
  std::string
      changes_topic;  ///< of Changes messages in the bag; empty: the only topic that has some; "none": not played back
  std::string timing_file;  ///< empty: wall times are not written
  long dump_step = 0;       ///< implicit step whose contact problem is written to `dump_file`, from 1; 0: none
  std::string dump_file;
  bool help = false;  ///< show the usage and do nothing
};

/// What --help prints.
std::string replayUsage();

/// @param arguments without the program's name; `--key value` and `--key=value`.
/// @throws std::invalid_argument naming the argument that is unknown, given twice, missing or without a value.
ReplayOptions parseReplayOptions(const std::vector<std::string>& arguments);

/// Plays every joint state of the bag and writes the CSV file; progress and a summary go to stderr.
/// @throws std::exception saying what is wrong: a scene, bag or URDF that cannot be read, a bag without the scene's
///   topics or without one acceptable joint state, a wrench that is not finite, a file that cannot be written.
void replay(const ReplayOptions& options);

/// main() of tissue_contact_replay.
/// @return exit code: 0, or 1 after one message on stderr.
int runReplay(int argc, char** argv);

}  // namespace tissue_contact
