/// @file
/// Executable tissue_contact_replay: see ros/replay.h.
#include "tissue_contact/ros/replay.h"

int main(int argc, char** argv) { return tissue_contact::runReplay(argc, argv); }
