/// @file
/// Room `ros`, private: saved states in files. No ROS inside.
#pragma once

#include <string>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

/// Saves to a file, whole or not at all.
/// @return its absolute path and size, for people.
/// @throws std::exception naming the file and what to do: an existing one is replaced only where it is a saved state, since any node
///   of the ROS graph may name one.
std::string saveStateFile(JointStatePlayer& player, const std::string& file);

/// @return the same. @throws std::exception naming the file and what does not fit; nothing has changed then.
std::string loadStateFile(JointStatePlayer& player, const std::string& file);

}  // namespace tissue_contact
