/// @file
/// Room `ros`, private: offline replay: a bag and a scene in, a CSV file, a bag and plots out. No roscore.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace tissue_contact {

struct ReplayOptions {
  std::string scene_file;
  std::vector<std::string> settings;  ///< of the scene: "KEY=VALUE"
  std::string bag_file;
  std::string csv_file;                                         ///< empty: none
  std::string out_file;                                         ///< bag of what the node would publish; empty: none
  std::string plot_folder;                                      ///< for plots of `out_file`; empty: none
  double from_s = 0.0;                                          ///< of the recording are played: from this on,
  double duration_s = std::numeric_limits<double>::infinity();  ///< and so long
  std::string urdf_file;                                        ///< empty: no scene parameter holds a URDF
  std::string changes_topic;  ///< of Changes in the bag; empty: the only one there; "none"
  std::string timing_file;    ///< empty: wall times are not written
  std::string manifest_file;  ///< what the results were made from; empty: none
  long dump_step = 0;         ///< implicit step whose contact problem is written to `dump_file`, from 1; 0: none
  std::string dump_file;
  std::string batch_file;              ///< of arguments of many replays, "-": standard input; empty: this one
  std::vector<std::string> arguments;  ///< as they were given
  bool help = false;                   ///< show the usage and do nothing
};

/// What --help prints.
std::string replayUsage();

/// @param arguments without the program's name; `--key value` and `--key=value`.
/// @throws std::invalid_argument naming the argument that is unknown, given twice, missing or without a value.
ReplayOptions parseReplayOptions(const std::vector<std::string>& arguments);

/// Plays the joint states of the bag and writes the results; progress and a summary go to stderr. When it ends early the bag it
/// was writing is left beside its place, as far as it has come, with WholeFile::kPartialEnding.
/// @throws std::exception saying what is wrong: a scene, bag or URDF that cannot be read, a bag without the scene's
///   topics or without one acceptable joint state, a wrench that is not finite, a file that cannot be written; Interrupted.
void replay(const ReplayOptions& options);

/// main() of tissue_contact_replay.
/// @return exit code: 0, or 1 after one message on stderr.
int runReplay(int argc, char** argv);

}  // namespace tissue_contact
