/// @file
/// Room `ros`, private: the package's Python scripts, for what C++ has no library for. A name and arguments in.
#pragma once

#include <string>
#include <vector>

namespace tissue_contact {

/// Runs a script that lies beside this program and waits for it; what it says goes to stdout and stderr.
/// @param standard_input descriptor of a file for it, which it reads from where that stands; -1: that of this program.
/// @throws std::runtime_error naming the script when it is not there or fails, which has said why.
void runScript(const std::string& name, std::vector<std::string> arguments, int standard_input = -1);

}  // namespace tissue_contact
