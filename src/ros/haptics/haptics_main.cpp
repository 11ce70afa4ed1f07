/// @file
/// Executable tissue_contact_haptics: see ros/haptics/haptics.h.
#include "ros/haptics/haptics.h"

int main(int argc, char** argv) { return tissue_contact::runHaptics(argc, argv); }
