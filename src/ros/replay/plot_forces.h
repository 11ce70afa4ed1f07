/// @file
/// Room `ros/replay`, private: pictures of what a replay recorded, by scripts/plot_forces.py. A bag in, pictures in a folder out.
#pragma once

#include <string>

namespace tissue_contact {

/// Says on stdout what it wrote.
/// @throws std::runtime_error when the script is not beside this program or fails, which has said why.
void plotForces(const std::string& bag, const std::string& scene, const std::string& folder);

}  // namespace tissue_contact
