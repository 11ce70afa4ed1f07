/// @file
/// Room `contact`: how mesh shapes are prepared at start-up.
#pragma once

#include <functional>
#include <string>

namespace tissue_contact {

/// All members may be empty: no cache, nothing said.
struct MeshPreparation {
  std::string cache_directory;  ///< made when missing; a directory that cannot be used is said once
  std::function<void(const std::string& line)> say;  ///< progress of more than a second, and one line per mesh
  std::function<double()> clock;                     ///< seconds, for those lines alone
};

}  // namespace tissue_contact
