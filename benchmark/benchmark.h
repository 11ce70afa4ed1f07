/// @file
/// Room `benchmark`: `tissue_contact_benchmark`: speed against error of the shipped scenes, or the error of a user's own.
/// Command line in; tables, CSV files, pictures and exit code out.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "benchmark/own_scene.h"
#include "benchmark/scenes.h"

namespace tissue_contact {

struct BenchmarkOptions {
  std::string out_directory = "benchmark";
  std::string only;  ///< name of a scene; empty: all
  SceneOptions scenes;
  bool plot = true;
  OwnSceneOptions own;  ///< scene_file not empty: this is wanted instead
  bool help = false;
};

/// @param arguments without the program's name; `--key value` and `--key=value`.
/// @throws std::invalid_argument naming the argument that is wrong and what is allowed.
BenchmarkOptions parseBenchmarkOptions(const std::vector<std::string>& arguments);

/// @param out tables. @param messages errors, and a progress bar if `show_bar` (a terminal).
/// @return exit code: 0 done, 1 something failed or there was nothing to measure, 2 the command line is wrong.
int runBenchmark(const std::vector<std::string>& arguments, std::ostream& out, std::ostream& messages, bool show_bar);

}  // namespace tissue_contact
