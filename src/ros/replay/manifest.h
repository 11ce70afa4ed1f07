/// @file
/// Room `ros/replay`, private: what a replay was made from and what came out, as YAML beside its results: hashes of every file, versions,
/// arguments, counts. Whoever has it can tell whether a result is still that of its inputs, and repeat it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ros/replay/replay.h"
#include "tissue_contact/core/whole_file.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

struct ManifestContent {
  struct Result {
    std::string role;
    std::string place;    ///< where it will be
    std::string content;  ///< where its bytes are now, all of them
  };
  std::vector<NamedFile> inputs;
  std::vector<Result> results;
  std::vector<std::pair<std::string, long>> counts;
  std::string gmsh;  ///< version of what filled a mesh; empty: none was filled
};

/// @throws std::exception naming a file that cannot be read any more.
void writeManifest(std::ostream& out, const ReplayOptions& options, const ManifestContent& content);

}  // namespace tissue_contact
