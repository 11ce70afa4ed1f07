/// @file
/// Room `mesh`: how meshes are prepared at start-up (surfaces filled, tool shapes sampled), and where progress of that is told.
#pragma once

#include <functional>
#include <string>

namespace tissue_contact {

/// All members may be empty: no cache, nothing said.
struct MeshPreparation {
  std::string cache_directory;  ///< made when missing; a directory that cannot be used is said once
  /// Progress of more than a second, one line per mesh, and where large tissues are built.
  std::function<void(const std::string& line)> say;
  std::function<double()> clock;  ///< seconds, for those lines alone
};

}  // namespace tissue_contact
