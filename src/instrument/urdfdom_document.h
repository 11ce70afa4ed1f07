/// @file
/// Room `instrument` (private): URDF text in, urdfdom's model out, with urdfdom's complaints in the exception.
#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <string>

namespace tissue_contact {

/// Runs urdfdom. It logs its complaints through console_bridge and returns null; here they become the message instead
/// of lines on stderr. Calls from several threads wait for each other, because console_bridge has one global handler.
/// @throws std::invalid_argument "<source>: <why>" (with the line where tags do not match). Never returns null.
urdf::ModelInterfaceSharedPtr parseWithUrdfdom(const std::string& xml, const std::string& source);

}  // namespace tissue_contact
