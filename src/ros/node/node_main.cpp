/// @file
/// Executable tissue_contact_node: see ros/node/node.h.
#include "ros/node/node.h"

int main(int argc, char** argv) { return tissue_contact::runNode(argc, argv); }
