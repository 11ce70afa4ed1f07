/// @file
/// Room `ros`, private: the node tissue_contact_haptics: wrenches in, commands to a haptic device out.
#pragma once

namespace tissue_contact {

/// Runs until it is asked to stop; the last that it publishes are zeros.
/// @return exit code: 0, or 1 after one fatal message when it cannot start.
int runHaptics(int argc, char** argv);

}  // namespace tissue_contact
