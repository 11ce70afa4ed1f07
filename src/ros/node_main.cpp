/// @file
/// Executable tissue_contact_node: see ros/node.h.
#include "tissue_contact/ros/node.h"

int main(int argc, char** argv) { return tissue_contact::runNode(argc, argv); }
